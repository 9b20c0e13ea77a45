#pragma once

#include <span>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// A motion as arrays: positions and rotations of named joints, frame by frame.
struct ClipArrays {
  std::vector<std::string> names;     ///< Of the joints, each once.
  std::vector<int> parents;           ///< Indices into names; -1: the root.
  std::span<const double> positions;  ///< frames x joints x 3
  std::span<const double> rotations;  ///< frames x joints x 4
  bool scalar_first = true;           ///< Rotations are wxyz, else xyzw.
  bool local = false;                 ///< Seen from the parent, else from the world.
  std::size_t frames = 0;
  FrameRate rate;
  std::string name;  ///< Of the clip, in messages.
  /// By how much of the longest offset a joint may leave its own, and have it fixed.
  double fixed_offset = 1e-4;
};

/// The clip of these poses. Joints come in depth-first order, siblings as they were given. A joint
/// below the root keeps its distance to its parent (as a fixed offset, the mean) where it never
/// differs by more than `fixed_offset` of the longest; else it has a translation in each frame.
/// Errors (kUsage): a tree that is none, names that are empty or given twice, rotations that are not
/// of unit length within 1e-3.
[[nodiscard]] Result<Clip> clip_from_arrays(const ClipArrays& arrays);

}  // namespace retarget
