#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "batch/clip_variants.h"
#include "retarget/error.h"

namespace retarget {

/// A motion file of a batch.
struct BatchInput {
  std::string path;  ///< As it is opened.
  /// Below the folder that was given, parts divided by `/`; says where outputs go. Bytes of the
  /// file system, not necessarily valid UTF-8.
  std::string relative;
  std::uint64_t bytes = 0;       ///< 0 where the file cannot be looked at,
  std::int64_t modified_ns = 0;  ///< nanoseconds since 1970, of its last change.
  /// What is taken of the file, where it is not the file as it is; see clip_variants.h.
  ClipVariant variant = {};
  std::string signature = {};  ///< signature_bytes(), where duplicates are looked for.
};

/// Where a batch looks for motion files.
struct InputSearch {
  /// Files; folders, which are searched as a whole; patterns with `*`, `?` and `[...]`; `@FILE` for
  /// a list.
  std::vector<std::string> names;
  /// Files of names of files and folders, one a line (or each ended by a zero byte), `-` for
  /// standard input; blank lines and lines that begin with `#` are skipped.
  std::vector<std::string> lists;
  /// Files that are named one by one keep the path below this folder; empty: their name alone.
  std::string base;
  /// Shell patterns of paths below a folder, or of file names, that are left out.
  std::vector<std::string> exclude;
  /// A folder of outputs, in which nothing is an input; may be empty.
  std::string output_folder;
  bool of_robots = false;  ///< Motions of robots are looked for, not of humans.
};

struct FoundInputs {
  std::vector<BatchInput> inputs;  ///< By relative path, then path; every pair of them once.
  std::vector<std::string> notes;  ///< What was skipped and why, one line each.
};

/// Finds the motion files: in folders all whose name ends in .bvh, .fbx, .glb, .gltf,
/// .vrm, .vrma, .mvnx, .npz, .pt or .npy in any letter
/// case, else those that are named. Of robots: .csv (but for .contacts.csv, which a run writes beside
/// motions), .npz, .pkl, .pickle, .joblib, .motion, .pt, and folders of SONIC's. A folder that cannot be read is an input itself, whose reading fails.
///
/// Symbolic links are followed, but not into a folder that they lie in. Pipes and devices in
/// folders, and the `._NAME` files of macOS archives, are skipped. A file of a list that is not
/// there stays an input, whose reading fails; every other name must exist (kInput), as must one
/// input (kInput). Files below no `base` that was given, and a folder to be searched that is the
/// output folder, are kUsage errors.
[[nodiscard]] Result<FoundInputs> find_inputs(const InputSearch& search);

/// Whether a file's name ends like a motion's.
[[nodiscard]] bool has_motion_ending(const std::string& name);

/// The relative path without such an ending: where outputs of an input go, but for their ending.
[[nodiscard]] std::string output_stem(const std::string& relative);

/// Two inputs whose outputs would be the same file are a kUsage error that names them.
[[nodiscard]] Result<void> check_distinct_outputs(std::span<const BatchInput> inputs);

}  // namespace retarget
