#pragma once

#include <string>
#include <vector>

#include "human/skeleton/candidate.h"
#include "retarget/error.h"
#include "retarget/human.h"

namespace retarget {

/// A joint whose name may mean a bone.
struct NamedJoint {
  int joint;
  double weight;  ///< Confidence in the name, at most 1.
};

/// One bone of a limb, and its candidate joints.
struct LimbSlot {
  Bone bone;
  bool required;
  std::vector<NamedJoint> choices;
};

/// An assignment of joints to the slots of a limb.
struct LimbChoice {
  std::vector<int> joints;  ///< One per slot, or -1.
  double weight = 0.0;      ///< Sum of the names' weights.
  std::vector<std::string> notes;
};

/// Returns the best assignment of joints to slots, in line from the body outwards. For equal merit,
/// the upper joints win. If joints on separate branches fit a required bone equally well, this is
/// an error; for an optional bone, the joint closest to their centre is taken, with a note.
[[nodiscard]] Result<LimbChoice> choose_limb(const BodySource& source,
                                             const std::vector<LimbSlot>& slots);

/// Error: two joints fit a bone equally well.
[[nodiscard]] Failure ambiguous_bone(const BodySource& source, Bone bone, int a, int b);

/// Note for users: any of several joints could be the bone.
[[nodiscard]] std::string note_of_choice(const BodySource& source, Bone bone,
                                         const std::vector<int>& joints, int chosen);

/// Returns the joint closest to the centre of several candidates; for equal distances, the first.
[[nodiscard]] int middle_joint(const BodySource& source, const std::vector<int>& joints);

}  // namespace retarget
