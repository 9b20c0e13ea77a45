#include "solve/targets/target_stream.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace retarget {

TargetStream::TargetStream(int frame_count, HumanPoseSource human, const TargetBuilder& targets,
                           bool ahead)
    : frame_count_(frame_count),
      human_(std::move(human)),
      targets_(targets),
      ring_(static_cast<std::size_t>(kChunkFrames * kChunks) * targets.target_count()) {
  if (!ahead || frame_count <= kChunkFrames) return;
  try {
    maker_ = std::thread([this] { make_chunks(); });
  } catch (const std::system_error&) {
    // If no thread is available, next() builds the targets.
  }
}

TargetStream::~TargetStream() {
  if (!maker_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  maker_.join();
}

std::span<const Pose> TargetStream::next() {
  const int frame = frame_++;
  if (frame % kChunkFrames == 0) {
    if (maker_.joinable()) {
      std::unique_lock lock(mutex_);
      released_ = frame;
      changed_.notify_all();
      changed_.wait(lock, [&] { return made_ > frame; });
    } else {
      make_frames(frame, std::min(frame + kChunkFrames, frame_count_));
    }
  }
  return slot_of(frame);
}

void TargetStream::make_chunks() {
  for (int begin = 0; begin < frame_count_; begin += kChunkFrames) {
    const int end = std::min(begin + kChunkFrames, frame_count_);
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return stop_ || end - released_ <= kChunkFrames * kChunks; });
      if (stop_) return;
    }
    make_frames(begin, end);
    {
      const std::lock_guard lock(mutex_);
      made_ = end;
    }
    changed_.notify_all();
  }
}

void TargetStream::make_frames(int begin, int end) {
  for (int frame = begin; frame < end; ++frame) {
    human_(frame, world_from_bone_);
    targets_.build(world_from_bone_, slot_of(frame));
  }
}

std::span<Pose> TargetStream::slot_of(int frame) {
  const auto count = static_cast<std::size_t>(targets_.target_count());
  const auto slot = static_cast<std::size_t>(frame % (kChunkFrames * kChunks));
  return std::span<Pose>(ring_).subspan(slot * count, count);
}

}  // namespace retarget
