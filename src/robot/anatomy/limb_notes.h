#pragma once

#include <optional>
#include <vector>

#include "retarget/robot.h"
#include "robot/anatomy/limbs.h"

namespace retarget {

/// A candidate for a limb's knee or elbow.
struct MiddleJoint {
  const std::vector<int>& chain;  ///< All joints of the limb, from the trunk outwards.
  int index = 0;                  ///< Index into the chain.
  int before = 0;                 ///< Number of joints that move the segment before it.
  bool is_leg = false;
};

/// Returns the plausibility of a knee or elbow from the other parts of the limb: a factor of at
/// most 1 on its geometric score. The factor is lower for a hip or shoulder of one joint, which
/// cannot aim the limb; for a small joint range; and for a segment with almost no mass.
[[nodiscard]] double plausibility(const Robot& robot, const MiddleJoint& middle);

/// Classifies a joint by its name and its body's name: +1 a knee or elbow, -1 another part of the
/// limb, 0 unknown.
[[nodiscard]] int middle_vote_of_names(const Robot& robot, int joint, bool is_leg);

/// Limbs that the names of a joint and its body mention.
struct LimbNames {
  bool leg = false, arm = false;
};
[[nodiscard]] LimbNames limb_named_by(const Robot& robot, int joint);

/// Observations in the zero configuration.
struct ZeroPose {
  double lean = 0.0;       ///< Lean of the line from hips to shoulders, degrees.
  std::optional<int> toe;  ///< Joint excluded at the end of the left leg, if any.
};

/// Adds unusual decisions to RobotAnatomy::notes.
void note_limbs(const Robot& robot, const ZeroPose& zero, RobotAnatomy& found);

/// Adds ambiguous knees and elbows to RobotAnatomy::doubts: another joint fits nearly as well, or
/// one segment is shorter than 0.4 of the other.
void doubt_limbs(const Robot& robot, RobotAnatomy& found);

}  // namespace retarget
