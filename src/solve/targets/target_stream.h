#pragma once

#include <condition_variable>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "human/skeleton/human_clip.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "solve/targets/targets.h"

namespace retarget {

/// Provides the targets of a clip's frames in order.
///
/// With a second thread, targets are built ahead of the solver, by a few hundred frames at most, so
/// that memory does not grow with the clip. The targets do not depend on the thread that builds
/// them.
class TargetStream {
 public:
  /// @param targets  must outlive the stream.
  /// @param ahead    build on a separate thread; if none is available, next() builds them.
  TargetStream(int frame_count, HumanPoseSource human, const TargetBuilder& targets, bool ahead);
  ~TargetStream();
  TargetStream(const TargetStream&) = delete;
  TargetStream& operator=(const TargetStream&) = delete;

  /// Targets of the next frame, valid until the next call.
  /// @pre fewer than frame_count previous calls.
  [[nodiscard]] std::span<const Pose> next();

 private:
  static constexpr int kChunkFrames = 32;
  static constexpr int kChunks = 8;

  void make_chunks();
  void make_frames(int begin, int end);
  std::span<Pose> slot_of(int frame);

  const int frame_count_;
  const HumanPoseSource human_;
  const TargetBuilder& targets_;
  HumanPose world_from_bone_;
  std::vector<Pose> ring_;  // Ring buffer of frames, indexed by frame number modulo its length.
  int frame_ = 0;           // Frame that next() returns.

  std::thread maker_;
  std::mutex mutex_;
  std::condition_variable changed_;
  int made_ = 0;      // Frames below this number have been written to the ring buffer.
  int released_ = 0;  // Frames below this number may be overwritten.
  bool stop_ = false;
};

}  // namespace retarget
