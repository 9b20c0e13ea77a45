#include "batch/pack_motions.h"

#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "batch/data_set.h"
#include "batch/find_inputs.h"
#include "batch/manifest.h"
#include "batch/resume.h"
#include "retarget/concatenate_npz.h"
#include "retarget/file.h"
#include "retarget/motion_io.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPackedEnding = ".npz";

bool is_packed_format(MotionFormat format) {
  return format_ending(format) == kPackedEnding;
}

Failure pack_format_failure() {
  return usage_failure(
      RETARGET_OPTION(
          "pack") " requires exactly one of the formats npz-mjlab, npz-beyondmimic and "
                  "npz-holosoma",
      "choose it with " RETARGET_OPTION("format"));
}

// Whether a clip is done in formats that cannot be packed. It may be too short for one that can.
bool is_of_other_formats(const ManifestEntry& entry) {
  const auto is_packed = [](const auto& file) { return file.file.ends_with(kPackedEnding); };
  return entry.done && std::ranges::none_of(entry.outputs, is_packed) &&
         std::ranges::none_of(entry.not_written, is_packed);
}

// A clip to be packed.
struct PackedClip {
  std::string name;                    // Relative path without extension.
  const FileRecord* record = nullptr;  // Its own NPZ.
  std::string path;
};

// The clips of one packed file.
class MotionPack {
 public:
  MotionPack(std::vector<PackedClip> clips, Observer& observer)
      : clips_(std::move(clips)), observer_(observer) {
    std::ranges::sort(clips_, {}, &PackedClip::name);
  }

  // Checks all clips first, so that no file is begun that cannot be completed.
  Result<void> measure() {
    for (const PackedClip& clip : clips_) {
      RETARGET_TRY(go_on("reading", clip.name));
      RETARGET_TRY(check_record(clip));
      RETARGET_TRY(all_.add(clip.name, clip.path));
    }
    return {};
  }

  Result<void> write(const std::string& path) {
    return all_.write(path, [this](const std::string& array, const std::string& clip) {
      return go_on(array + " of", clip);
    });
  }

  [[nodiscard]] std::string contents() const {
    return count_text(clips_.size(), "clip") + ", " + count_text(all_.frame_count(), "frame");
  }

 private:
  // Reports progress and checks for interruption.
  Result<void> go_on(std::string_view what, const std::string& clip) {
    if (observer_.is_stopped()) {
      Error stopped = interrupted_failure().value();
      stopped.message = "interrupted; the clips are done, but not packed";
      stopped.hint = "the same command with " RETARGET_OPTION(
          "resume") ", or with " RETARGET_OPTION("merge") ", packs them";
      return failure(std::move(stopped));
    }
    observer_.status(fmt::format("packing: {} {}", what, clip));
    return {};
  }

  static Result<void> check_record(const PackedClip& clip) {
    const RecordState state = look_at(*clip.record, clip.path, FileUse::kOutput);
    if (state == RecordState::kSame) return {};
    if (state == RecordState::kUnsure &&
        has_recorded_content(*clip.record, clip.path, FileUse::kOutput)) {
      return {};
    }
    std::error_code ignored;
    const bool there = fs::exists(clip.path, ignored);
    return input_failure(clip.path,
                         there ? "the file has changed since the batch wrote it"
                               : "the file that the batch wrote no longer exists",
                         "repeat the batch with " RETARGET_OPTION("resume") " to restore it");
  }

  std::vector<PackedClip> clips_;
  NpzConcatenation all_;
  Observer& observer_;
};

// The NPZ among the outputs of a clip; null if it has none.
Result<const FileRecord*> packed_output(const ManifestEntry& entry, const SaveOptions& save) {
  std::vector<const FileRecord*> found;
  for (const FileRecord& output : entry.outputs) {
    if (output.file.ends_with(kPackedEnding)) found.push_back(&output);
  }
  const auto format = std::ranges::find_if(save.formats, is_packed_format);
  if (found.size() > 1 && format != save.formats.end()) {
    std::erase_if(found, [&](const FileRecord* output) {
      return !output->file.ends_with(format_long_ending(*format));
    });
  }
  if (found.size() > 1) {
    return usage_failure("\"" + entry.relative + "\" has NPZ files of several formats",
                         "choose the format to pack with " RETARGET_OPTION("format"));
  }
  return found.empty() ? nullptr : found.front();
}

// The folder of all outputs of a robot.
std::string place_of(const std::string& folder, const ManifestEntry& entry,
                     const FileRecord& output) {
  const std::string apart = entry.robot + "/";
  const bool is_apart = output.file.starts_with(apart + output_stem(entry.relative) + ".");
  return is_apart ? folder + "/" + entry.robot : folder;
}

Result<void> check_no_motion_there(const std::string& folder, const std::string& path,
                                   const std::vector<ManifestEntry>& entries) {
  for (const ManifestEntry& entry : entries) {
    for (const FileRecord& output : entry.outputs) {
      if (folder + "/" + output.file != path) continue;
      return usage_failure("\"" + path + "\" is the motion of \"" + entry.relative + "\"",
                           "give " RETARGET_OPTION("pack") " another name");
    }
  }
  return {};
}

Result<void> write_pack(const std::string& path, std::vector<PackedClip> clips,
                        Observer& observer) {
  if (clips.empty()) {
    std::error_code ignored;
    const bool earlier = fs::exists(path, ignored);
    observer.warn({{0, 0,
                    earlier ? "no motion passed: the file from an earlier call remains unchanged"
                            : "no motion passed: the file is not written"}},
                  path);
    return {};
  }
  MotionPack pack(std::move(clips), observer);
  Result<void> result = pack.measure();
  if (result) result = pack.write(path);
  observer.end_progress();
  if (result) observer.line("wrote", path + ": " + pack.contents());
  return result;
}

}  // namespace

Result<void> check_pack_name(const std::string& name) {
  const bool named = name.size() > kPackedEnding.size() && name.ends_with(kPackedEnding);
  if (named && is_plain_name(name)) return {};
  return usage_failure(
      RETARGET_OPTION("pack") " requires the name of a .npz file in the output folder, found \"" +
          name + "\"",
      RETARGET_OPTION("pack") " motions.npz");
}

Result<void> check_pack_format(const SaveOptions& options) {
  if (std::ranges::count_if(options.formats, is_packed_format) == 1) return {};
  return pack_format_failure();
}

Result<void> pack_motions(const std::string& folder, const BatchRequest& request,
                          const BatchSelection* selection, Observer& observer) {
  const auto interrupts = observer.hold_interrupts();
  RETARGET_TRY_ASSIGN(auto manifest, read_manifest(folder + "/manifest.jsonl"));
  const std::vector<ManifestEntry> entries = latest_entries(std::move(manifest.entries));
  std::map<std::string, std::vector<PackedClip>> packs;  // By folder.
  for (const ManifestEntry& entry : entries) {
    if (!entry.done || (selection != nullptr && !selection->contains(entry))) continue;
    RETARGET_TRY_ASSIGN(const FileRecord* output, packed_output(entry, request.run.options.save));
    if (output == nullptr) continue;
    auto& clips = packs[place_of(folder, entry, *output)];
    if (!has_passed(entry)) continue;
    clips.push_back({output_stem(entry.relative), output, folder + "/" + output->file});
  }
  if (packs.empty() && std::ranges::any_of(entries, is_of_other_formats)) {
    return pack_format_failure();
  }
  if (packs.empty()) packs[folder];
  for (auto& [place, clips] : packs) {
    const std::string path = place + "/" + request.pack;
    RETARGET_TRY(check_no_motion_there(folder, path, entries));
    RETARGET_TRY(write_pack(path, std::move(clips), observer));
  }
  return {};
}

}  // namespace retarget
