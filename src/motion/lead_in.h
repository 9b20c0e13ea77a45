#pragma once

#include "retarget/clip.h"

namespace retarget {

/// Frames in front of a clip that are none of its motion: a T-pose, a frame of zeros, or several of
/// them, each held still and then left by a jump that nobody makes. 0 where the motion begins with
/// the first frame.
///
/// A jump is a step whose second difference, the mean over the joints, is above 0.1 times the
/// spread of the body (the root mean square distance of its joints from their middle) and above
/// five times the 95th percentile of those in the two seconds that follow; from a frame in which no
/// joint is turned also a step of 0.1 times the spread and five times the next one. Held is what
/// stays within 0.05 spreads of its first frame. What moves before the jump, is held for more than
/// 20 s, or is held for more than 0.25 s in a pose that the motion comes back to within 2 s, is
/// motion and stays.
[[nodiscard]] int count_lead_in_frames(const Clip& clip);

}  // namespace retarget
