#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// A body in ProtoMotions' arrays: a tracking layout's, or a point that is fixed to one.
struct ProtoBody {
  std::string name;
  std::string carrier;                              ///< Whose rotation it has.
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< In the carrier's frame, metres.
};

/// The bodies of a robot's motions in ProtoMotions' order: those of the model that it comes with,
/// which has a head and hands of its own for the G1; for other robots the root and all bodies that
/// a joint moves, depth first.
[[nodiscard]] std::vector<ProtoBody> proto_bodies(const Robot& robot);

/// Which of the bodies is a foot. @param side  `left` or `right`. Empty: the robot's feet are not
/// known.
[[nodiscard]] std::optional<std::size_t> proto_foot(const Robot& robot,
                                                    const std::vector<ProtoBody>& bodies,
                                                    std::string_view side);

}  // namespace retarget
