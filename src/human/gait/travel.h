#pragma once

#include "human/gait/contact_plan.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/report.h"

namespace retarget {

/// Travel of a body relative to its source, as a function of its speed over the ground. Between the
/// two speeds the factor changes smoothly.
struct TravelRule {
  double slow = 1.0, fast = 1.0;              ///< Factors at low and at high speed.
  double slow_speed = 0.0, fast_speed = 0.0;  ///< Up to and from these speeds, m/s.

  [[nodiscard]] double factor(double speed) const;
};

/// Scales the horizontal path of a human.
///
/// Let P be the path of the hips over the ground and s the factor of a frame. The whole body moves
/// by o = integral of (s - 1) dP, so the path keeps its directions and its times; heights and
/// rotations do not change. A foot moves by the mean of o over its stance while it stands, so feet
/// that stand still keep standing still. In its swing the foot moves smoothly from the displacement
/// of one stance to that of the next; during a swing of more than a second, it follows the body.
/// The legs take the difference by two-bone inverse kinematics.
///
/// The speed is that of the hips, averaged over 1.5 s, which removes the sway of steps. Where
/// knees, elbows, hands, seat or back rest on the floor, and half a second around it, the factor is
/// 1: these parts would slide.
///
/// Factors and stances depend on the whole clip starting at `first`, so a part of a motion equals
/// that part of the whole motion, moved so that its first frame does not change. A clip whose
/// factors are all 1 does not change.
/// @param first  earlier frames are not part of the motion and do not change.
/// @return the factors of the part
[[nodiscard]] TravelReport scale_travel(Clip& clip, int first, FrameRange part,
                                        const Calibration& calibration, const TravelRule& rule,
                                        const ContactOptions& contacts = {});

}  // namespace retarget
