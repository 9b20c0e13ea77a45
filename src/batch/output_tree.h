#pragma once

#include <filesystem>
#include <list>
#include <set>
#include <string>
#include <vector>

#include "batch/batch_runner.h"
#include "batch/find_inputs.h"
#include "batch/manifest.h"
#include "batch/resume.h"
#include "retarget/batch.h"
#include "retarget/error.h"

namespace retarget {

/// The files of a clip, including sidecars, certificate and contacts.
/// @param folder  prefix of the names: empty, or a folder with a final slash.
[[nodiscard]] Result<std::vector<std::string>> outputs_of(const BatchInput& input,
                                                          const BatchRequest& request,
                                                          const std::string& folder);

/// Checks that all output files are distinct, that none has the path of an output folder, and that
/// none has the name of a file of the batch itself. Errors: kUsage.
[[nodiscard]] Result<void> check_outputs_of(const std::vector<BatchInput>& inputs,
                                            const BatchRequest& request);

/// Checks that no existing file that would be overwritten is also read, for example through a link
/// into the clips' folder. Errors: kUsage.
/// @param output  folder of the batch without a trailing slash.
[[nodiscard]] Result<void> check_outputs_spared(const std::vector<BatchInput>& inputs,
                                                const BatchRequest& request,
                                                const std::string& output,
                                                const std::list<BatchRobot>& robots);

/// Checks that a new batch would replace no file, also not through a link. With --redo, checks only
/// links. Errors: kUsage.
/// @param whole  the batch is not a part. Parts share the files of the batch itself, which a part
///               checks only if the folder has no manifest.
[[nodiscard]] Result<void> check_outputs_new(const std::vector<BatchInput>& inputs,
                                             const BatchRequest& request, const std::string& output,
                                             const std::list<BatchRobot>& robots, bool whole);

/// Files, relative to the output folder, of discarded manifest entries that the tasks do not write
/// again.
[[nodiscard]] std::vector<std::string> files_of_discarded(
    const std::string& folder, const std::vector<ManifestEntry>& discarded,
    const std::vector<BatchTask>& tasks, const BatchRequest& request);

/// The output folders of these clips, including the folder of the batch.
[[nodiscard]] std::set<std::filesystem::path> output_folders(const std::string& folder,
                                                             const std::vector<BatchTask>& tasks);
/// Output folders of the entries of one or several robots.
[[nodiscard]] std::set<std::filesystem::path> output_folders(
    const std::string& folder, const std::vector<ManifestEntry>& entries);

/// Removes unfinished outputs of a killed run. No other process may be writing there. Skips folders
/// that symbolic links place outside of the output folder.
void remove_unfinished(const std::string& output_folder,
                       const std::set<std::filesystem::path>& folders);

/// Files, relative to the output folder, that earlier options created for clips that are done
/// again, and that the current options neither replace nor list, such as files of another --format.
/// @param certify  BatchRequest::certify.
[[nodiscard]] std::vector<std::string> files_of_earlier_options(const std::string& folder,
                                                                const std::vector<BatchTask>& tasks,
                                                                const FinishedClips& finished,
                                                                bool certify);

/// Excludes other batches from an output folder during its lifetime.
///
/// It is a system lock on a file in the folder, which the system releases when the process ends in
/// any way. A killed run therefore never blocks the next one.
class FolderLock {
 public:
  /// Compatible lock holders.
  enum class Kind {
    kAlone,   ///< None.
    kShared,  ///< Other kShared locks: the shards of one batch.
  };

  /// Takes the lock.
  /// @param folder  must exist.
  /// @param name    name of the lock file in the folder.
  /// Errors (kRun): another process has the lock (the message names it); the folder is not
  /// writable.
  [[nodiscard]] static Result<FolderLock> take(const std::string& folder, const std::string& name,
                                               Kind kind);
  ~FolderLock();
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&& other) noexcept;
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// False if the file system does not support locks; nothing then excludes a second batch.
  [[nodiscard]] bool is_held() const { return held_; }

 private:
  FolderLock() = default;
  void release();

  std::string path_;
  int descriptor_ = -1;
  bool held_ = false;
};

}  // namespace retarget
