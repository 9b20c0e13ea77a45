#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "retarget/error.h"
#include "retarget/file.h"
#include "retarget/hash.h"
#include "retarget/motion_io.h"
#include "retarget/normalize_start.h"
#include "retarget/robot.h"

namespace retarget {

/// Writes a robot CSV while its frames are being solved. A second thread formats and writes frames
/// as they arrive, which saves time and memory at the end. Output to standard output or a pipe
/// waits until all frames are complete.
class CsvSink {
 public:
  struct Options {
    RobotCsvOptions csv;
    bool normalize_start = false;
  };

  /// @param path  empty: nothing is written, only the hash is computed.
  [[nodiscard]] static Result<std::unique_ptr<CsvSink>> open(const std::string& path,
                                                             std::shared_ptr<const Robot> robot,
                                                             const Options& options);
  ~CsvSink();
  CsvSink(const CsvSink&) = delete;
  CsvSink& operator=(const CsvSink&) = delete;

  /// Adds the next frame.
  void add(std::span<const double> qpos);

  /// Writes the remaining frames. Returns the hash of the whole text.
  [[nodiscard]] Result<std::string> flush();
  /// Moves the file to its final path; call after flush. Without commit, no file remains.
  [[nodiscard]] Result<void> commit();

 private:
  CsvSink(std::optional<OutputFile> file, ContentHasher hasher, std::shared_ptr<const Robot> robot,
          const Options& options);

  void hand_over();
  void write_chunks();
  void write_frames(std::vector<double>& frames);
  void write_text();

  std::optional<OutputFile> file_;
  const std::shared_ptr<const Robot> robot_;
  const Options options_;
  const RobotCsvFormatter formatter_;
  std::vector<double> filling_;  // Consecutive frames from add().

  // Used by the writing thread, or by the caller's thread if there is none.
  std::optional<StartNormalizer> normalizer_;
  std::string text_;
  ContentHasher hasher_;
  int frames_ = 0;  // Written frames.
  Result<void> written_;

  std::thread writer_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<double> waiting_;  // Frames for the writer; empty when it has taken them.
  bool done_ = false;
};

}  // namespace retarget
