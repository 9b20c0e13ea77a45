#pragma once

#include <string>
#include <vector>

#include "human/candidate.h"
#include "retarget/error.h"
#include "retarget/human.h"

namespace retarget {

/// A joint whose name may mean a bone.
struct NamedJoint {
  int joint;
  double weight;  ///< How well the name means it, at most 1.
};

/// One bone of a limb: what may stand for it.
struct LimbSlot {
  Bone bone;
  bool required;
  std::vector<NamedJoint> choices;
};

/// A way to fill the slots of a limb.
struct LimbChoice {
  std::vector<int> joints;  ///< One each, or -1.
  double weight = 0.0;      ///< Sum of the names' weights.
  std::vector<std::string> notes;
};

/// The best way to fill the slots of a limb with joints in line, from the body outwards. Of equal
/// merit the upper joints are taken. Joints side by side that fit a required bone equally well are
/// an error; of those that fit an optional bone the one in their middle is taken, with a note.
[[nodiscard]] Result<LimbChoice> choose_limb(const BodySource& source,
                                             const std::vector<LimbSlot>& slots);

/// The error that two joints fit a bone equally well.
[[nodiscard]] Failure ambiguous_bone(const BodySource& source, Bone bone, int a, int b);

/// Tells people that a bone could be any of several joints.
[[nodiscard]] std::string note_of_choice(const BodySource& source, Bone bone,
                                         const std::vector<int>& joints, int chosen);

/// Of joints that stand for one thing the one nearest to their middle; of two, the first.
[[nodiscard]] int middle_joint(const BodySource& source, const std::vector<int>& joints);

}  // namespace retarget
