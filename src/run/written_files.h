#pragma once

#include <sys/types.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "retarget/error.h"
#include "retarget/options.h"

namespace retarget {

/// Files by what they are and not by what they are called: links of both kinds, `a/../b` and
/// redirected standard streams are seen through.
class KnownFiles {
 public:
  /// Empty names are skipped.
  /// @param stream  what `-` stands for: STDIN_FILENO, STDOUT_FILENO.
  void add(const std::string& path, int stream);
  /// The name under which the same file was added; null: it was not.
  [[nodiscard]] const std::string* find(const std::string& path, int stream) const;

 private:
  std::map<std::pair<dev_t, ino_t>, std::string> by_identity_;
  std::map<std::string, std::string> by_path_;  // of what does not exist yet
};

/// Holds what a command is about to write against what it reads.
class WrittenFiles {
 public:
  /// @param inputs  `-` is standard input; empty names are skipped.
  explicit WrittenFiles(const std::vector<std::string>& inputs);

  /// Usage errors: the file is an input. Empty: no output.
  [[nodiscard]] Result<void> check_spared(const std::string& output) const;
  /// Usage errors: the file is an input or another output, the folder is not there.
  [[nodiscard]] Result<void> take(const std::string& output);

 private:
  KnownFiles inputs_;
  KnownFiles outputs_;
};

/// The check of every command that writes: take() of all outputs.
[[nodiscard]] Result<void> check_written(const std::vector<std::string>& outputs,
                                         const std::vector<std::string>& inputs);

/// Every file that a run reads: those that its options name, and that its robot and the data folder
/// consist of.
[[nodiscard]] std::vector<std::string> files_of(const Run& run, const std::string& data_folder);

/// Checks the files that a motion goes to, before anything is read: folders are there, no file is
/// also an input, no file is written twice.
/// @param others  files that are written besides; empty names are skipped.
[[nodiscard]] Result<void> check_outputs(const Run& run, bool sidecar,
                                         const std::vector<std::string>& inputs,
                                         const std::vector<std::string>& others);

}  // namespace retarget
