#pragma once

#include "human/human_clip.h"
#include "motion/contact_phases.h"

namespace retarget {

/// Length of the left leg, hip to knee to ankle, median over the frames, metres; of the right one
/// where the left is incomplete; 0 for a body without legs and a clip without frames.
[[nodiscard]] double leg_length(const HumanClip& human);

/// When the feet of a human stand: find_contact_phases on LeftFoot and LeftToe, RightFoot and
/// RightToe, with the length of the human's own leg. Feet that are missing have no contacts, nor
/// has a body without a whole leg.
[[nodiscard]] FootContacts find_foot_contacts(const HumanClip& human,
                                              const ContactOptions& options = {});

}  // namespace retarget
