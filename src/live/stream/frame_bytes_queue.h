#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace retarget {

/// A queue of encoded frames, oldest first, bounded in count and size. The strings keep their
/// memory, so that the queue does not allocate once it has warmed up.
class FrameBytesQueue {
 public:
  struct Bounds {
    std::size_t frames = 1;  ///< At least 1.
    std::size_t bytes = 1;
  };

  explicit FrameBytesQueue(Bounds bounds) : bounds_(bounds), frames_(bounds.frames) {}

  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] std::size_t size() const { return count_; }
  /// Whether a frame of this size fits; an empty queue accepts any size.
  [[nodiscard]] bool has_room(std::size_t size) const {
    return count_ == 0 || (count_ < bounds_.frames && bytes_ + size <= bounds_.bytes);
  }
  /// @pre has_room
  void push(std::string_view frame) {
    // An emptied queue restarts at the same strings to reuse their memory.
    if (count_ == 0) first_ = 0;
    frames_[(first_ + count_) % bounds_.frames].assign(frame);
    ++count_;
    bytes_ += frame.size();
  }
  /// Swaps out the oldest frame; the queue reuses the memory of the string passed in. @pre not
  /// empty
  void take(std::string& frame) {
    frame.swap(frames_[first_]);
    bytes_ -= frame.size();
    drop_first();
  }
  /// @pre not empty
  void drop_oldest() {
    bytes_ -= frames_[first_].size();
    drop_first();
  }
  void clear() { first_ = count_ = bytes_ = 0; }

 private:
  void drop_first() {
    first_ = (first_ + 1) % bounds_.frames;
    --count_;
  }

  Bounds bounds_;
  std::vector<std::string> frames_;  // Ring buffer.
  std::size_t first_ = 0, count_ = 0, bytes_ = 0;
};

}  // namespace retarget
