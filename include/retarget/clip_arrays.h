#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"

namespace RETARGET_API retarget {

/// A motion given as arrays: positions and rotations of named joints, by frame.
struct ClipArrays {
  std::vector<std::string> names;     ///< Unique joint names.
  std::vector<int> parents;           ///< Indices into names; -1 for the root.
  std::span<const double> positions;  ///< Size frames x joints x 3.
  std::span<const double> rotations;  ///< Size frames x joints x 4.
  bool scalar_first = true;           ///< Rotations are wxyz if true, xyzw if false.
  bool local = false;                 ///< Poses are relative to the parent if true, to the world if
                                      ///< false.
  std::size_t frames = 0;
  FrameRate rate;
  std::string name;  ///< Name of the clip, for messages.
  /// Largest deviation of a fixed joint offset from its mean, relative to the longest offset.
  double fixed_offset = 1e-4;
};

/// Creates a clip from arrays. Joints are in depth-first order; siblings keep their order. A joint
/// below the root gets a fixed offset (the mean) if its translation never deviates from it by more
/// than `fixed_offset` of the longest offset; otherwise it gets a translation in each frame.
///
/// Errors (kUsage): an invalid tree, empty or repeated names, rotations whose norm differs from 1
/// by more than 1e-3.
[[nodiscard]] Result<Clip> clip_from_arrays(const ClipArrays& arrays);

/// A motion given as joint positions alone, by frame.
struct JointPositions {
  std::vector<std::string> names;     ///< Unique joint names; empty: the joint order is recognised.
  std::span<const double> positions;  ///< Size frames x joints x 3; any unit, any up axis.
  std::size_t frames = 0;
  std::size_t joints = 0;
  FrameRate rate;
  std::string name;  ///< Name of the clip, for messages.
};

/// Creates a clip from joint positions; rotations are computed from limb directions and bending
/// planes (docs/positions.md). The clip's origin() has warnings about findings and assumptions.
///
/// Errors (kUsage): no frames or joints, or more than an int counts. Errors (kInput): an unknown or
/// ambiguous joint order, joints that do not form a human, duplicate names.
[[nodiscard]] Result<Clip> clip_from_positions(const JointPositions& motion);

}  // namespace retarget
