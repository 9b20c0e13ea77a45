#pragma once

#include "human/human_clip.h"
#include "motion/contact_phases.h"

namespace retarget {

/// The contacts in which the foot is on its sole: those parts of each phase in which the direction
/// that is up when the foot stands is at most 41 degrees from the vertical (as the fit has it for
/// heels on the floor), and which last `shortest` yet. Where nobody stands, as in crawling, heights
/// of feet that lie on the instep pass for those of standing ones, and feet on their edge are as
/// high as some; a robot's sole need not be on the floor there.
[[nodiscard]] FootContacts stances_of(const HumanClip& human, FootContacts contacts,
                                      const ContactOptions& options = {});

}  // namespace retarget
