#pragma once

#include "retarget/clip.h"

namespace retarget {

/// Number of frames at the beginning of a clip that are not part of its motion: a T-pose, a frame
/// of zeros, or several of them, each held still and then left by a jump that no human makes. 0 if
/// the motion begins with the first frame.
///
/// A jump is a step with a large second difference (mean over the joints): larger than 0.1 times
/// the spread of the body (the root mean square distance of its joints from their mean) and larger
/// than five times the 95th percentile of the second differences in the next two seconds. After a
/// frame in which all rotations are zero, a step of more than 0.1 spreads and more than five times
/// the next step is also a jump. A pose is held while it stays within 0.05 spreads of its first
/// frame. Frames belong to the motion if they move before the jump, are held for more than 20 s, or
/// are held for more than 0.25 s in a pose to which the motion returns within 2 s.
[[nodiscard]] int count_lead_in_frames(const Clip& clip);

}  // namespace retarget
