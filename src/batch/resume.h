#pragma once

#include <map>
#include <string>
#include <vector>

#include "batch/manifest.h"
#include "retarget/error.h"

namespace retarget {

/// What a file is now: size, time and hash.
/// @param name  FileRecord::file.
[[nodiscard]] Result<FileRecord> record_file(const std::string& path, std::string name);

/// Whether something still is as a manifest has it.
enum class RecordState {
  kSame,     ///< Size and time of change are the recorded ones.
  kChanged,  ///< It is gone or has another size.
  kUnsure,   ///< Same size, other time: only its content tells.
};

/// Compares without reading the file.
[[nodiscard]] RecordState look_at(const FileRecord& record, const std::string& path);

/// Compares size and content.
[[nodiscard]] bool has_recorded_content(const FileRecord& record, const std::string& path);

/// The clips that earlier runs finished, looked up by clip, robot and options.
class FinishedClips {
 public:
  FinishedClips() = default;
  /// @param output_folder  that the outputs of the entries are in.
  FinishedClips(std::vector<ManifestEntry> entries, std::string output_folder);

  /// An entry that says that the clip is done with these options and is the same of its file, input and outputs being as they
  /// were as far as can be seen without reading them; the state is kSame or kUnsure. Nothing: it
  /// is to be done.
  struct Candidate {
    const ManifestEntry* entry = nullptr;
    RecordState state = RecordState::kChanged;
  };
  [[nodiscard]] Candidate find(const std::string& relative, const std::string& robot,
                               const std::string& options_hash, const std::string& input_path,
                               const ClipVariant& variant = {}) const;
  /// The signature that an earlier run found in a clip whose file is as it was; empty: there is none.
  [[nodiscard]] std::string signature_of(const std::string& relative,
                                         const std::string& options_hash,
                                         const std::string& input_path,
                                         const ClipVariant& variant) const;

  /// The files, below the output folder, that earlier runs are said to have made of a clip.
  /// @param verified  those alone that are what was recorded, by size and content, and lie in that
  ///                  folder when links are followed: no others may be removed.
  [[nodiscard]] std::vector<std::string> outputs_of(const std::string& relative,
                                                    const std::string& robot, bool verified) const;

  /// When an entry of the clip was finished last, failed ones included; empty: there is none.
  [[nodiscard]] std::string last_finished(const std::string& relative,
                                          const std::string& robot) const;

  /// Whether input and outputs of an entry have the recorded contents; files whose size and time
  /// are the recorded ones are trusted.
  [[nodiscard]] bool still_holds(const ManifestEntry& entry, const std::string& input_path) const;

 private:
  [[nodiscard]] RecordState state_of(const ManifestEntry& entry,
                                     const std::string& input_path) const;

  std::multimap<std::pair<std::string, std::string>, ManifestEntry> entries_;
  std::map<std::pair<std::string, std::string>, std::vector<FileRecord>> outputs_;
  std::map<std::pair<std::string, std::string>, std::string> last_finished_;
  std::multimap<std::string, ManifestEntry> with_signature_;  // by clip
  std::string output_folder_;
};

}  // namespace retarget
