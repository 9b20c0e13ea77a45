#pragma once

#include <string>

#include "retarget/clip.h"

namespace retarget {

/// Smooths the joints of a clip made from joint positions alone (ClipOrigin::unknown_rotations) if
/// half of them have noise above 0.3 % of the body's size per frame. Then recomputes the rotations,
/// because noisy positions make them spin about nearly straight limbs. Other clips stay identical.
/// @return a sentence with numbers; empty if nothing changed
std::string clean_positions(Clip& clip);

}  // namespace retarget
