#pragma once

#include <Eigen/Core>
#include <vector>

#include "retarget/contact_plan.h"
#include "retarget/human_poser.h"

namespace retarget {

/// A human sits on something above the floor.
struct SeatRest {
  FrameRange frames;
  double height = 0.0;                               ///< Of the seat; world, metres.
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();  ///< World, metres.
};

/// Finds the seats of a human as scene_from_motion.h describes them, in the order of time.
[[nodiscard]] std::vector<SeatRest> find_seats(const HumanClipInfo& human,
                                               const HumanPoseSource& poses,
                                               const ContactPlan& contacts);

}  // namespace retarget
