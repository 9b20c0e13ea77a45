#include "pipeline/limit_lines.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "base/number_text.h"
#include "human/bones.h"

namespace retarget {
namespace {

constexpr std::size_t kMostLines = 5;

std::string push_text(const LimitPush& push) {
  const double degrees = push.shortfall * 180.0 / std::numbers::pi;
  return "task " + std::string(kBoneNames[static_cast<std::size_t>(push.bone)]) +
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

std::vector<std::string> limit_lines(std::span<const JointAtLimit> joints, const Robot& robot,
                                     const LimitSet& limits) {
  std::vector<std::string> lines;
  for (const JointAtLimit& found : joints) {
    // where a joint merely rests at a limit, as fingers do, nothing is missed
    if (!found.push || lines.size() == kMostLines) continue;
    const RobotJoint& joint = robot.joints()[static_cast<std::size_t>(found.joint)];
    std::string text = joint.name + " at its " + (found.at_upper ? "upper" : "lower") +
                       " limit in " + number_text(100.0 * found.share, 0) + " % of frames";
    text += "; " + push_text(*found.push);
    if (!found.wider_set.empty()) text += "; " + wider_text(found, joint, limits);
    lines.push_back(std::move(text));
  }
  return lines;
}

}  // namespace retarget
