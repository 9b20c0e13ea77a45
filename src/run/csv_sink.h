#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "base/file.h"
#include "provenance/hash.h"
#include "retarget/error.h"
#include "retarget/motion_io.h"
#include "retarget/robot.h"
#include "robot/normalize_start.h"

namespace retarget {

/// Writes a robot CSV while its frames are being solved: a second thread formats and writes what
/// is there, so that neither time nor memory is spent at the end. What others would see at once
/// (standard output, a pipe) is held back until all frames are there.
class CsvSink {
 public:
  struct Options {
    RobotCsvOptions csv;
    bool normalize_start = false;
  };

  /// @param path  empty: nothing is written, the hash alone is made.
  [[nodiscard]] static Result<std::unique_ptr<CsvSink>> open(const std::string& path,
                                                             std::shared_ptr<const Robot> robot,
                                                             const Options& options);
  ~CsvSink();
  CsvSink(const CsvSink&) = delete;
  CsvSink& operator=(const CsvSink&) = delete;

  /// Takes the next frame.
  void add(std::span<const double> qpos);

  /// Writes what is left; gives the hash of the whole text.
  [[nodiscard]] Result<std::string> flush();
  /// Puts the file in its place, after flush. Without it nothing remains.
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
  std::vector<double> filling_;  // frames that add() took, one after the other

  // of the writing thread, or of the caller's where there is none
  std::optional<StartNormalizer> normalizer_;
  std::string text_;
  ContentHasher hasher_;
  int frames_ = 0;  // written
  Result<void> written_;

  std::thread writer_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<double> waiting_;  // frames for the writer; empty: it took them
  bool done_ = false;
};

}  // namespace retarget
