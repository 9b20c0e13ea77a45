#include "batch/pack_motions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "batch/data_set.h"
#include "batch/find_inputs.h"
#include "batch/manifest.h"
#include "batch/resume.h"
#include "formats/containers/npz.h"
#include "formats/containers/npz_writer.h"
#include "retarget/file.h"
#include "retarget/motion_io.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPackedEnding = ".npz";
constexpr const char* kUnlikeHint =
    "a packed file contains clips of one robot, format and rate; use separate folders for others";

bool is_packed_format(MotionFormat format) {
  return format_ending(format) == kPackedEnding;
}

// A clip to be packed.
struct PackedClip {
  std::string name;                    // Relative path without extension.
  const FileRecord* record = nullptr;  // Its own NPZ.
  std::string path;
  std::int64_t frames = 0;
};

struct PackedArray {
  std::string name;
  bool along_time = false;
  NpyArray array;        // Has elements only if they are equal in all clips.
  ZipChecksum elements;  // Of all clips, if the array is concatenated.
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
    for (PackedClip& clip : clips_) {
      RETARGET_TRY(go_on("reading", clip));
      RETARGET_TRY(check_record(clip));
      RETARGET_TRY_ASSIGN(const FileContent content, read_file(clip.path));
      RETARGET_TRY_ASSIGN(const NpzFile npz, NpzFile::open(content.view(), clip.path));
      if (arrays_.empty()) RETARGET_TRY(begin_arrays(npz));
      RETARGET_TRY(add(npz, clip));
    }
    return {};
  }

  Result<void> write(const std::string& path) {
    RETARGET_TRY_ASSIGN(OutputFile file, OutputFile::create(path));
    NpzStream npz([&file](std::string_view bytes) { return file.write(bytes); });
    for (const PackedArray& packed : arrays_) {
      if (packed.along_time) {
        RETARGET_TRY(in_file(write_clips(packed, npz), path));
      } else {
        RETARGET_TRY(npz.add(packed.name, packed.array));
      }
    }
    RETARGET_TRY(write_clip_table(npz));
    RETARGET_TRY(npz.finish());
    return file.commit();
  }

  [[nodiscard]] std::string contents() const {
    return count_text(clips_.size(), "clip") + ", " + count_text(frames_, "frame");
  }

 private:
  // Reports progress and checks for interruption.
  Result<void> go_on(std::string_view what, const PackedClip& clip) {
    if (observer_.is_stopped()) {
      Error stopped = interrupted_failure().value();
      stopped.message = "interrupted; the clips are done, but not packed";
      stopped.hint = "the same command with " RETARGET_OPTION(
          "resume") ", or with " RETARGET_OPTION("merge") ", packs them";
      return failure(std::move(stopped));
    }
    observer_.status(fmt::format("packing: {} {}", what, clip.name));
    return {};
  }

  static Result<void> check_record(const PackedClip& clip) {
    const RecordState state = look_at(*clip.record, clip.path);
    if (state == RecordState::kSame) return {};
    if (state == RecordState::kUnsure && has_recorded_content(*clip.record, clip.path)) return {};
    std::error_code ignored;
    const bool there = fs::exists(clip.path, ignored);
    return input_failure(clip.path,
                         there ? "the file has changed since the batch wrote it"
                               : "the file that the batch wrote no longer exists",
                         "repeat the batch with " RETARGET_OPTION("resume") " to restore it");
  }

  // Takes the arrays of the first clip as the reference.
  Result<void> begin_arrays(const NpzFile& npz) {
    for (const std::string& name : npz.names()) {
      RETARGET_TRY_ASSIGN(NpyArray array, npz.read(name));
      PackedArray packed;
      packed.name = name;
      packed.along_time = array.is_number() && array.shape.size() > 1;
      if (packed.along_time) {
        array.data.clear();
        array.shape.front() = 0;
      }
      packed.array = std::move(array);
      arrays_.push_back(std::move(packed));
    }
    return {};
  }

  Result<void> add(const NpzFile& npz, PackedClip& clip) {
    const std::string& first = clips_.front().path;
    const bool same_names = std::ranges::equal(npz.names(), arrays_, {}, {}, &PackedArray::name);
    if (!same_names) {
      return npz.file_failure(
          fmt::format("its arrays differ from those of {}: {}", first, list_names(npz.names(), 12)),
          kUnlikeHint);
    }
    std::optional<std::size_t> frames;
    for (PackedArray& packed : arrays_) {
      RETARGET_TRY_ASSIGN(const NpyArray array, npz.read(packed.name));
      if (!is_like(array, packed)) {
        return npz.array_failure(
            packed.name,
            fmt::format("it differs from {}{}", first, difference(array, packed.array)),
            kUnlikeHint);
      }
      if (!packed.along_time) continue;
      if (frames.value_or(array.shape.front()) != array.shape.front()) {
        return npz.array_failure(packed.name, "its number of frames differs from the other arrays");
      }
      frames = array.shape.front();
      packed.array.shape.front() += *frames;
      packed.elements.add(array.data);
    }
    clip.frames = static_cast<std::int64_t>(frames.value_or(0));
    frames_ += clip.frames;
    return {};
  }

  static bool is_like(const NpyArray& array, const PackedArray& packed) {
    if (array.kind != packed.array.kind || array.item_size != packed.array.item_size) return false;
    if (!packed.along_time) {
      return array.shape == packed.array.shape && array.data == packed.array.data;
    }
    return array.shape.size() == packed.array.shape.size() &&
           std::equal(array.shape.begin() + 1, array.shape.end(), packed.array.shape.begin() + 1);
  }

  // Describes the difference of two arrays with one number, such as rates.
  static std::string difference(const NpyArray& array, const NpyArray& first) {
    const auto is_one = [](const NpyArray& one) {
      return one.is_number() && one.element_count() == 1 && !one.data.empty();
    };
    if (!is_one(array) || !is_one(first)) return {};
    return fmt::format(": {}, and {} there", number_text(array.numbers().front(), 3),
                       number_text(first.numbers().front(), 3));
  }

  Result<void> write_clips(const PackedArray& packed, NpzStream& npz) {
    RETARGET_TRY(npz.begin(packed.name, packed.array, packed.elements));
    for (const PackedClip& clip : clips_) {
      RETARGET_TRY(go_on(packed.name + " of", clip));
      RETARGET_TRY_ASSIGN(const FileContent content, read_file(clip.path));
      RETARGET_TRY_ASSIGN(const NpzFile one, NpzFile::open(content.view(), clip.path));
      RETARGET_TRY_ASSIGN(const NpyArray array, one.read(packed.name));
      RETARGET_TRY(npz.write(array.data));
    }
    return npz.end();
  }

  Result<void> write_clip_table(NpzStream& npz) const {
    std::vector<std::string> names;
    std::vector<std::int64_t> starts, lengths;
    std::int64_t start = 0;
    for (const PackedClip& clip : clips_) {
      names.push_back(clip.name);
      starts.push_back(start);
      lengths.push_back(clip.frames);
      start += clip.frames;
    }
    RETARGET_TRY(npz.add("clip_names", text_array(names)));
    RETARGET_TRY(npz.add("clip_starts", int64_array(starts, {starts.size()})));
    return npz.add("clip_lengths", int64_array(lengths, {lengths.size()}));
  }

  static Result<void> in_file(Result<void> result, const std::string& path) {
    if (result || !result.error().location.file.empty()) return result;
    if (result.error().kind == ErrorKind::kRun) result.error().location.file = path;
    return result;
  }

  std::vector<PackedClip> clips_;
  std::vector<PackedArray> arrays_;
  std::int64_t frames_ = 0;
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
  return usage_failure(
      RETARGET_OPTION(
          "pack") " requires exactly one of the formats npz-mjlab, npz-beyondmimic and "
                  "npz-holosoma",
      "choose it with " RETARGET_OPTION("format"));
}

Result<void> pack_motions(const std::string& folder, const BatchRequest& request,
                          Observer& observer) {
  const auto interrupts = observer.hold_interrupts();
  RETARGET_TRY_ASSIGN(auto manifest, read_manifest(folder + "/manifest.jsonl"));
  const std::vector<ManifestEntry> entries = latest_entries(std::move(manifest.entries));
  std::map<std::string, std::vector<PackedClip>> packs;  // By folder.
  for (const ManifestEntry& entry : entries) {
    if (!entry.done) continue;
    RETARGET_TRY_ASSIGN(const FileRecord* output, packed_output(entry, request.run.options.save));
    if (output == nullptr) continue;
    auto& clips = packs[place_of(folder, entry, *output)];
    if (!has_passed(entry)) continue;
    clips.push_back({output_stem(entry.relative), output, folder + "/" + output->file});
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
