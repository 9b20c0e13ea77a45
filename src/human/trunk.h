#pragma once

#include "human/candidate.h"

namespace retarget {

/// Completes a map whose limbs, and head where there is one, are set: Hips where the legs meet,
/// Spine2 where the arms meet, Spine and Spine1 between them, Neck before the head. Bones that are
/// set already stay, except Hips.
void complete_trunk(const BodySource& source, BoneMap& map);

/// Notes for people: bones that the source lacks, spine joints that are folded into others.
void add_trunk_notes(const BodySource& source, BoneMap& map);

}  // namespace retarget
