#pragma once

#include <string>
#include <vector>

#include "retarget/robot.h"
#include "retarget/text.h"
#include "robot/anatomy/shapes.h"

namespace retarget {

/// Rounds to a number of decimals. Never returns negative zero.
[[nodiscard]] double rounded(double value, int decimals);

/// Formats text as a JSON string with quotes.
[[nodiscard]] std::string json_text(const std::string& text);

/// Returns for each joint the name of the body that format_model() adds for it; empty for most
/// joints. Readers that do not compile a model expect one joint per body, at the body's origin.
/// Therefore a joint with an anchor, and all but the last of several joints, have a separate body.
[[nodiscard]] std::vector<std::string> joint_frames(const Robot& robot);

/// Formats a robot as MJCF without meshes: tree, joints, ranges and inertias at full precision, and
/// the given shapes as geoms. Every joint has a type, an axis and a range, but no offset. Bodies
/// and joints must have names.
[[nodiscard]] std::string format_model(const Robot& robot, const std::string& name,
                                       const std::vector<RoughShape>& shapes);

}  // namespace retarget
