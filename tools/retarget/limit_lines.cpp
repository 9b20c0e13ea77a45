#include "limit_lines.h"

#include <cmath>
#include <numbers>
#include <string>

#include "retarget/human.h"

namespace retarget::cli {
namespace {

constexpr std::size_t kMostLines = 5;

std::string push_text(const LimitPush& push) {
  const double degrees = push.shortfall * 180.0 / std::numbers::pi;
  return "task " + std::string(bone_name(push.bone)) +
         (push.rotation ? " rotation, " + number_text(degrees, 1) + " degrees short"
                        : " position, " + number_text(100.0 * push.shortfall, 1) + " cm short");
}

std::string wider_text(const JointAtLimit& found, const RobotJoint& joint, const LimitSet& limits) {
  if (std::isinf(found.wider_by)) return "limit set " + found.wider_set + " has no limit there";
  const std::string unit = joint.type == RobotJoint::Type::kHinge ? " rad" : " m";
  return "limit set " + limits.name + " is " + number_text(found.wider_by, 2) + unit +
         " tighter than " + found.wider_set;
}

}  // namespace

void print_joints_at_limits(std::span<const JointAtLimit> joints, const Robot& robot,
                            const LimitSet& limits, Console& console) {
  std::size_t lines = 0;
  for (const JointAtLimit& found : joints) {
    // where a joint merely rests at a limit, as fingers do, nothing is missed
    if (!found.push || lines++ == kMostLines) continue;
    const RobotJoint& joint = robot.joints()[static_cast<std::size_t>(found.joint)];
    std::string text = joint.name + " at its " + (found.at_upper ? "upper" : "lower") +
                       " limit in " + number_text(100.0 * found.share, 0) + " % of frames";
    text += "; " + push_text(*found.push);
    if (!found.wider_set.empty()) text += "; " + wider_text(found, joint, limits);
    console.line("", text);
  }
}

}  // namespace retarget::cli
