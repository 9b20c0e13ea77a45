#include "batch/resume.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include "retarget/file.h"
#include "retarget/file_endings.h"
#include "retarget/fingerprint.h"
#include "retarget/hash.h"
#include "retarget/os.h"
#include "retarget/try.h"

namespace retarget {
namespace {

FileFacts facts_in(const os::FileStatus& status) {
  return {status.bytes, status.modified_ns};
}

// Total size and latest modification of several files.
FileFacts facts_of_all(const std::vector<std::filesystem::path>& files) {
  FileFacts all;
  for (const auto& file : files) {
    const auto status = os::status_of(file.generic_string());
    if (!status) continue;
    const FileFacts one = facts_in(*status);
    all.bytes += one.bytes;
    all.modified_ns = std::max(all.modified_ns, one.modified_ns);
  }
  return all;
}

// The sidecar that decides how an input is read; empty if there is none.
std::string sidecar_of_input(const std::string& path, FileUse use) {
  if (use != FileUse::kInput || !is_robot_ending(ending_of(path))) return {};
  const std::string sidecar = path + ".json";
  return is_file(sidecar) ? sidecar : std::string();
}

Result<std::string> hash_of(const std::string& path, FileUse use) {
  RETARGET_TRY_ASSIGN(std::string hash, motion_hash(path));
  const std::string sidecar = sidecar_of_input(path, use);
  if (sidecar.empty()) return hash;
  RETARGET_TRY_ASSIGN(const std::string of_sidecar, hash_file(sidecar));
  return hash_bytes(hash + " " + of_sidecar);
}

}  // namespace

std::optional<FileFacts> facts_of(const std::string& path, FileUse use) {
  const auto status = os::status_of(path);
  if (!status) return std::nullopt;
  if (status->kind == os::EntryKind::kRegular) {
    std::vector<std::filesystem::path> files = companion_files(path);
    files.emplace_back(path);
    if (auto sidecar = sidecar_of_input(path, use); !sidecar.empty()) {
      files.emplace_back(std::move(sidecar));
    }
    return facts_of_all(files);
  }
  if (status->kind != os::EntryKind::kFolder || !is_sonic_folder(path)) return std::nullopt;
  return facts_of_all(files_in_folder(path));
}

Result<FileRecord> record_file(const std::string& path, std::string name, FileUse use) {
  const auto status = os::status_of(path);
  if (!status) {
    return input_failure(path, "cannot read the file: " + std::generic_category().message(errno));
  }
  const auto facts = facts_of(path, use);
  if (!facts && status->kind == os::EntryKind::kFolder)
    return input_failure(path, "this folder cannot be read");
  if (!facts) return input_failure(path, "cannot read the file: not a file");
  RETARGET_TRY_ASSIGN(auto hash, hash_of(path, use));
  return FileRecord{std::move(name), facts->bytes, facts->modified_ns, std::move(hash)};
}

RecordState look_at(const FileRecord& record, const std::string& path, FileUse use) {
  const auto facts = facts_of(path, use);
  if (!facts || facts->bytes != record.bytes) return RecordState::kChanged;
  return facts->modified_ns == record.modified_ns ? RecordState::kSame : RecordState::kUnsure;
}

bool has_recorded_content(const FileRecord& record, const std::string& path, FileUse use) {
  if (look_at(record, path, use) == RecordState::kChanged) return false;
  const auto hash = hash_of(path, use);
  return hash && *hash == record.hash;
}

FinishedClips::FinishedClips(std::vector<ManifestEntry> entries, std::string output_folder)
    : output_folder_(std::move(output_folder)) {
  // A clip that failed last must be done again, regardless of earlier results.
  std::set<std::pair<std::string, std::string>> failed;
  for (const ManifestEntry& entry : latest_entries(entries)) {
    if (!entry.done) failed.emplace(entry.relative, entry.robot);
    last_finished_[{entry.relative, entry.robot}] = entry.finished;
  }
  for (const ManifestEntry& entry : entries) {
    if (!entry.signature.empty()) with_signature_.emplace(entry.relative, entry);
  }
  for (ManifestEntry& entry : entries) {
    if (!entry.done || entry.outputs.empty()) continue;
    std::pair key(entry.relative, entry.robot);
    std::vector<FileRecord>& made = outputs_[key];
    made.insert(made.end(), entry.outputs.begin(), entry.outputs.end());
    if (failed.contains(key)) continue;
    entries_.emplace(std::move(key), std::move(entry));
  }
}

RecordState FinishedClips::state_of(const ManifestEntry& entry,
                                    const std::string& input_path) const {
  RecordState state = look_at(entry.input, input_path, FileUse::kInput);
  for (const FileRecord& output : entry.outputs) {
    if (state == RecordState::kChanged) break;
    const RecordState found = look_at(output, output_folder_ + "/" + output.file, FileUse::kOutput);
    if (found != RecordState::kSame) state = found;
  }
  return state;
}

FinishedClips::Candidate FinishedClips::find(const std::string& relative, const std::string& robot,
                                             const std::string& options_hash,
                                             const std::string& input_path,
                                             const ClipVariant& variant) const {
  Candidate best;
  const auto [begin, end] = entries_.equal_range({relative, robot});
  for (auto at = begin; at != end; ++at) {
    if (at->second.options_hash != options_hash || at->second.variant != variant) continue;
    const RecordState state = state_of(at->second, input_path);
    if (state == RecordState::kSame) return {&at->second, state};
    if (state == RecordState::kUnsure) best = {&at->second, state};
  }
  return best;
}

std::string FinishedClips::signature_of(const std::string& relative,
                                        const std::string& options_hash,
                                        const std::string& input_path,
                                        const ClipVariant& variant) const {
  const auto [begin, end] = with_signature_.equal_range(relative);
  for (auto at = begin; at != end; ++at) {
    const ManifestEntry& entry = at->second;
    if (entry.options_hash != options_hash || entry.variant != variant) continue;
    if (look_at(entry.input, input_path, FileUse::kInput) == RecordState::kSame) {
      return entry.signature;
    }
  }
  return {};
}

std::string FinishedClips::last_finished(const std::string& relative,
                                         const std::string& robot) const {
  const auto found = last_finished_.find({relative, robot});
  return found == last_finished_.end() ? std::string() : found->second;
}

std::vector<std::string> FinishedClips::outputs_of(const std::string& relative,
                                                   const std::string& robot, bool verified) const {
  const auto found = outputs_.find({relative, robot});
  if (found == outputs_.end()) return {};
  std::set<std::string> names;
  for (const FileRecord& output : found->second) {
    if (names.contains(output.file) || (verified && !lies_in(output_folder_, output.file)))
      continue;
    const std::string path = output_folder_ + "/" + output.file;
    if (verified && !has_recorded_content(output, path, FileUse::kOutput)) continue;
    names.insert(output.file);
  }
  return {names.begin(), names.end()};
}

bool FinishedClips::still_holds(const ManifestEntry& entry, const std::string& input_path) const {
  const auto holds = [](const FileRecord& record, const std::string& path, FileUse use) {
    return look_at(record, path, use) == RecordState::kSame ||
           has_recorded_content(record, path, use);
  };
  return holds(entry.input, input_path, FileUse::kInput) &&
         std::ranges::all_of(entry.outputs, [&](const FileRecord& output) {
           return holds(output, output_folder_ + "/" + output.file, FileUse::kOutput);
         });
}

}  // namespace retarget
