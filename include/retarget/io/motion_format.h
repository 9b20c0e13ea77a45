#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/base/result.h"

namespace retarget {

/// Files that hold a robot's motion; docs/formats.md describes each.
enum class MotionFormat : unsigned char {
  kCsv,             ///< Unitree's layout: root, quaternion, joints; SI.
  kCsvSoma,         ///< SOMA and BONES-SEED: header, frame number, centimetres, degrees, Euler.
  kNpzMjlab,        ///< Tracking arrays in MuJoCo's order of joints and bodies.
  kNpzBeyondMimic,  ///< Tracking arrays in Isaac Lab's order.
  kPklGmr,          ///< GMR's dictionary.
  kPklPbhc,         ///< PBHC's and ASAP's dictionary of dictionaries.
};

/// As on the command line: `csv`, `csv-soma`, `npz-mjlab`, ...
[[nodiscard]] std::string_view format_name(MotionFormat format);
[[nodiscard]] std::vector<std::string> format_names();
/// Errors (kUsage): an unknown name suggests the nearest one and lists all.
[[nodiscard]] Result<MotionFormat> format_from_name(std::string_view name);

/// `.csv`, `.npz` or `.pkl`.
[[nodiscard]] std::string_view format_ending(MotionFormat format);
/// What tells files of one motion in several formats apart: `.csv`, `.soma.csv`, `.mjlab.npz`, ...
[[nodiscard]] std::string_view format_long_ending(MotionFormat format);

}  // namespace retarget
