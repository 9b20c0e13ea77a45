#pragma once

#include <condition_variable>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "human/human_clip.h"
#include "pipeline/targets.h"
#include "retarget/human.h"
#include "retarget/pose.h"

namespace retarget {

/// The targets of a clip's frames, one frame after the other.
///
/// With a second thread they are made ahead of the solver, some hundred frames at most, so that
/// memory does not grow with the clip. What is made does not depend on who makes it.
class TargetStream {
 public:
  /// @param targets  outlives the stream.
  /// @param ahead    on a thread of its own; where none can be had, in next().
  TargetStream(int frame_count, HumanPoseSource human, const TargetBuilder& targets, bool ahead);
  ~TargetStream();
  TargetStream(const TargetStream&) = delete;
  TargetStream& operator=(const TargetStream&) = delete;

  /// Targets of the next frame, valid until the next call.
  /// @pre fewer than frame_count calls before.
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
  std::vector<Pose> ring_;  // of frames, by number modulo its length
  int frame_ = 0;           // next() gives it

  std::thread maker_;
  std::mutex mutex_;
  std::condition_variable changed_;
  int made_ = 0;      // frames below are in the ring, or were
  int released_ = 0;  // frames below may be overwritten
  bool stop_ = false;
};

}  // namespace retarget
