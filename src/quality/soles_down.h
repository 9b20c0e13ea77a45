#pragma once

#include "retarget/human/human_clip.h"
#include "retarget/motion/contact_phases.h"

namespace retarget {

/// The contacts in which the foot is on its sole: those parts of each phase in which the direction
/// that is up when the foot stands is at most 41 degrees from the vertical (as the fit has it for
/// heels on the floor), and which last `shortest` yet. Where nobody stands, heights of lying feet
/// pass for those of standing ones; a robot's sole has no business on the floor there.
[[nodiscard]] FootContacts contacts_of_soles(const HumanClip& human, FootContacts contacts,
                                             const ContactOptions& options = {});

}  // namespace retarget
