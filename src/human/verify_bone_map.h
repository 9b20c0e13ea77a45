#pragma once

#include <string>
#include <vector>

#include "human/candidate.h"

namespace retarget {

/// What verification says of a map.
struct Verdict {
  std::vector<std::string> faults;  ///< Why the map cannot be right; empty: it may.
  std::vector<std::string> doubts;  ///< What is odd, for people.
  double confidence = 1.0;          ///< Factor for the map's confidence.
};

/// Holds a map against the tree, the lengths and the poses: bones distinct and in line, left and
/// right of equal lengths, thigh and shin in proportion, head over torso over hips over feet.
/// Bones that are missing are not judged.
[[nodiscard]] Verdict verify_bone_map(const BodySource& source, const BoneMap& map);

/// Limbs that a map lacks or has in part: `left arm`, `legs` and so on, also `hips` and `torso`;
/// empty: whole. Clavicles, hands, toes, neck and head are no limbs.
[[nodiscard]] std::vector<std::string> missing_parts(const BoneMap& map);

}  // namespace retarget
