#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/options.h"

namespace retarget {

/// Whether a name matches a shell pattern: `*` any text, `?` one character, `[a-z]` one of these;
/// `*` also matches `/`.
[[nodiscard]] bool matches_pattern(const std::string& pattern, const std::string& name);

/// Paths that match a shell pattern, in any order; `*` matches neither `/` nor a dot at the start
/// of a name.
[[nodiscard]] std::vector<std::string> files_of_pattern(const std::string& pattern);

/// Estimates the memory in bytes that a clip needs while it is retargeted and measured.
/// @param file   motion file; its extension determines the kind.
/// @param bytes  size of the file.
[[nodiscard]] std::uint64_t memory_of_clip(std::string_view file, std::uint64_t bytes);

/// Memory of a process beyond the estimates of its clips: the tool itself and estimation errors.
inline constexpr std::uint64_t kMemoryOfProcess = std::uint64_t{1} << 30U;

/// The content of a clip relative to its file: the whole file, a part, the mirror image of either,
/// or one of these in a changed scene.
struct ClipVariant {
  /// BatchInput::relative of the whole file; empty: the clip is the whole file.
  std::string source = {};
  /// `1.5:3` in seconds or `f45:f90` in frames; empty: the whole file.
  std::string part = {};
  /// BatchInput::relative of the clip that is mirrored; empty: not mirrored.
  std::string mirror_of = {};

  /// BatchInput::relative of the clip whose scene is changed; empty: not changed.
  std::string varied_of = {};
  /// The changes of the scene (input_variants.h), such as `terrain-scale=z=1.07`.
  std::string changes = {};

  [[nodiscard]] bool is_mirrored() const { return !mirror_of.empty(); }
  [[nodiscard]] bool is_varied() const { return !varied_of.empty(); }
  /// Whether the batch made the clip from another one, and BatchInput::relative of that.
  [[nodiscard]] bool is_derived() const { return is_mirrored() || is_varied(); }
  [[nodiscard]] const std::string& original() const {
    return is_mirrored() ? mirror_of : varied_of;
  }
  friend bool operator==(const ClipVariant&, const ClipVariant&) = default;
};

/// Formats both ends of a part; each is seconds, `f` and a frame, or empty.
[[nodiscard]] std::string part_text(const std::string& start, const std::string& end);

/// Converts a part to options. Frames exclude the end, seconds include it.
/// @pre the text is part_text() of valid ends
[[nodiscard]] PartOptions part_options(const std::string& part);

/// The path of a clip that is made from another one: `a/walk.bvh` with `_v1` becomes
/// `a/walk_v1.bvh`.
[[nodiscard]] std::string suffixed_name(const std::string& relative, const std::string& suffix);

/// The path of a clip's mirror image: `a/walk.bvh` becomes `a/walk_mirrored.bvh`.
[[nodiscard]] std::string mirrored_name(const std::string& relative);

/// A motion file of a batch.
struct BatchInput {
  std::string path;  ///< Path used to open the file.
  /// Path below the given folder, with `/` as separator; determines the output path. Raw bytes of
  /// the file system, not necessarily valid UTF-8.
  std::string relative;
  std::uint64_t bytes = 0;       ///< 0 if the file is not accessible.
  std::int64_t modified_ns = 0;  ///< Last modification, nanoseconds since 1970.
  /// The part of the file that is used, if not the whole file.
  ClipVariant variant = {};
  std::string signature = {};  ///< signature_bytes(), if duplicates are searched.
};

/// Locations in which a batch searches for motion files.
struct InputSearch {
  /// Files; folders, searched recursively; patterns with `*`, `?` and `[...]`; `@FILE` for a list.
  std::vector<std::string> names;
  /// Files with one file or folder name per line (or zero-terminated names); `-` is standard input.
  /// Blank lines and lines that begin with `#` are skipped.
  std::vector<std::string> lists;
  /// Single files keep their path below this folder; empty: only their name.
  std::string base;
  /// Shell patterns of excluded paths below a folder, or of file names.
  std::vector<std::string> exclude;
  /// Output folder, in which no file is an input; may be empty.
  std::string output_folder;
  bool of_robots = false;  ///< Search for robot motions instead of human motions.
};

struct FoundInputs {
  std::vector<BatchInput> inputs;  ///< Sorted by relative path, then path, without duplicates.
  std::vector<std::string> notes;  ///< Skipped files with reasons, one line each.
  std::vector<std::string> unused_patterns;  ///< Patterns of InputSearch::exclude without a match.
};

/// Finds the motion files: single files, and in folders every file whose name has the extension of
/// a human format (Format::endings), in any letter case, and pickles with a human motion. A note
/// counts the other files. For robot motions: the extensions of robot
/// formats, except .contacts.csv and summary.csv, which batches write, and SONIC folders.
///
/// A folder or a pickle that cannot be read becomes an input that fails later, so that its clips
/// are not missed silently. Symbolic links are followed, except into a folder that contains the link. Pipes and
/// devices in folders, and `._NAME` files of macOS archives, are skipped. A missing file of a list
/// becomes an input that fails later; every other name must exist, and there must be at least one
/// input (kInput). kUsage errors: a file outside of a given `base`, and a search folder that is the
/// output folder.
[[nodiscard]] Result<FoundInputs> find_inputs(const InputSearch& search);

/// Whether a file name has the extension of a motion file.
[[nodiscard]] bool has_motion_ending(const std::string& name);

/// The relative path without this extension; outputs of the input append their own extension.
[[nodiscard]] std::string output_stem(const std::string& relative);

/// kUsage error that names two inputs with the same output file.
[[nodiscard]] Result<void> check_distinct_outputs(std::span<const BatchInput> inputs);

}  // namespace retarget
