#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "live/stream/frame_bytes_queue.h"
#include "live/stream/socket.h"

namespace retarget {

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

}  // namespace retarget
