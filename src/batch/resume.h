#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "batch/manifest.h"
#include "retarget/error.h"

namespace retarget {

/// File attributes that are known without reading the content.
struct FileFacts {
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0;  ///< Last modification, nanoseconds since 1970.
};

/// How a batch uses a file. The sidecar next to a robot motion says how to read it, so that it
/// belongs to an input. A sidecar that a batch writes next to its motion is an output of its own.
enum class FileUse : unsigned char { kInput, kOutput };

/// Total size and latest modification of a file, its companion_files() and the sidecar of an input,
/// or of the files of a folder that is a motion (SONIC). Returns nothing for anything else.
[[nodiscard]] std::optional<FileFacts> facts_of(const std::string& path, FileUse use);

/// Records the current size, modification time and hash of a file with the files of facts_of().
/// @param name  FileRecord::file.
[[nodiscard]] Result<FileRecord> record_file(const std::string& path, std::string name,
                                             FileUse use);

/// Whether a file still matches its record.
enum class RecordState {
  kSame,     ///< Same size and modification time.
  kChanged,  ///< Missing, or of another size.
  kUnsure,   ///< Same size but other time; only the content decides.
};

/// Compares without reading the file.
[[nodiscard]] RecordState look_at(const FileRecord& record, const std::string& path, FileUse use);

/// Compares size and content.
[[nodiscard]] bool has_recorded_content(const FileRecord& record, const std::string& path,
                                        FileUse use);

/// Clips finished by earlier runs, by clip, robot and options.
class FinishedClips {
 public:
  FinishedClips() = default;
  /// @param output_folder  folder that contains the outputs of the entries.
  FinishedClips(std::vector<ManifestEntry> entries, std::string output_folder);

  /// An entry of a clip finished with these options and the same part of its file, whose input and
  /// outputs are unchanged as far as can be seen without reading them. The state is kSame or
  /// kUnsure. Without an entry, the clip must be done.
  struct Candidate {
    const ManifestEntry* entry = nullptr;
    RecordState state = RecordState::kChanged;
  };
  [[nodiscard]] Candidate find(const std::string& relative, const std::string& robot,
                               const std::string& options_hash, const std::string& input_path,
                               const ClipVariant& variant = {}) const;
  /// The signature that an earlier run computed for a clip whose file is unchanged; empty if there
  /// is none.
  [[nodiscard]] std::string signature_of(const std::string& relative,
                                         const std::string& options_hash,
                                         const std::string& input_path,
                                         const ClipVariant& variant) const;

  /// The files, relative to the output folder, that earlier runs recorded as outputs of a clip.
  /// @param verified  only files that match their record in size and content and lie in that folder
  ///                  with symbolic links resolved; only these may be removed.
  [[nodiscard]] std::vector<std::string> outputs_of(const std::string& relative,
                                                    const std::string& robot, bool verified) const;

  /// Completion time of the clip's latest entry, including failed ones; empty if there is none.
  [[nodiscard]] std::string last_finished(const std::string& relative,
                                          const std::string& robot) const;

  /// Whether input and outputs of an entry have the recorded contents. Files with recorded size and
  /// modification time are not read.
  [[nodiscard]] bool still_holds(const ManifestEntry& entry, const std::string& input_path) const;

 private:
  [[nodiscard]] RecordState state_of(const ManifestEntry& entry,
                                     const std::string& input_path) const;

  std::multimap<std::pair<std::string, std::string>, ManifestEntry> entries_;
  std::map<std::pair<std::string, std::string>, std::vector<FileRecord>> outputs_;
  std::map<std::pair<std::string, std::string>, std::string> last_finished_;
  std::multimap<std::string, ManifestEntry> with_signature_;  // By clip.
  std::string output_folder_;
};

}  // namespace retarget
