#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "live/stream/frame_output.h"
#include "live/stream/socket.h"
#include "live/stream/stream_address.h"
#include "retarget/error.h"

namespace retarget {

/// A queue of encoded frames, oldest first, bounded in count and size. The strings keep their
/// memory, so that the queue does not allocate once it has warmed up.
class FrameBytesQueue {
 public:
  struct Bounds {
    std::size_t frames = 1;  ///< Number of frames, at least 1.
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

/// Whether the descriptor is a regular file, not a pipe, a terminal or a device.
[[nodiscard]] bool is_regular_file(const Descriptor& file);

/// Writes to a file, a pipe or a terminal on its own thread, so that a slow disk or an idle reader
/// does not delay the caller. Pieces are written completely and in order. A piece that is cut short
/// by a full disk is removed from the file.
class WriterThread {
 public:
  WriterThread(Descriptor to, FrameBytesQueue::Bounds bounds);
  /// Does not wait for a blocked write; finish() does.
  ~WriterThread();
  WriterThread(const WriterThread&) = delete;
  WriterThread& operator=(const WriterThread&) = delete;

  /// Queues a piece.
  /// @return whether there was room and the file is writable.
  [[nodiscard]] bool put(std::string_view piece);
  /// Like put, but waits for room until stopped or the file is not writable.
  [[nodiscard]] bool put_in_time(std::string_view piece, const std::function<bool()>& is_stopped);

  struct Progress {
    std::int64_t written = 0;  ///< Number of pieces.
    int error = 0;             ///< errno of a failed write; nothing is written after it.
    bool is_idle = true;       ///< Nothing is queued.
  };
  [[nodiscard]] Progress progress() const;

  /// Writes the queued pieces. Gives up after half a second without progress (five for a disk) and
  /// on a reader that needs more than three seconds; if is_patient, only after is_stopped.
  /// @return whether everything was written.
  bool finish(bool is_patient, const std::function<bool()>& is_stopped);

 private:
  struct State;
  std::shared_ptr<State> state_;  // Shared with the thread, which may outlive this object.
};

/// Opens a file, a pipe or standard output for writing. Errors: not writable; the pipe has no
/// reader.
[[nodiscard]] Result<Descriptor> open_for_writing(const StreamAddress& to);

/// Writes robot frames to a file or standard output on its own thread.
class WriterOutput final : public FrameOutput {
 public:
  WriterOutput(const StreamAddress& to, Descriptor file, const FrameOutputContext& context,
               std::unique_ptr<RobotFrameWriter> writer);

  void take(const RobotFrame& frame) override;
  void finish() override;
  [[nodiscard]] const OutputStatistics& statistics() const override {
    return account_.statistics();
  }

 private:
  [[nodiscard]] bool put(std::string_view piece);
  void check_progress();
  void end(int error);

  std::unique_ptr<RobotFrameWriter> writer_;
  bool is_file_;  // A regular file.
  WriterThread thread_;
  OutputAccount account_;
  bool waits_;
  std::function<bool()> is_stopped_;
  std::string bytes_;
  std::int64_t queued_ = 0;   // Frames queued so far, written ones included.
  std::int64_t headers_ = 0;  // Pieces before the frames.
};

}  // namespace retarget
