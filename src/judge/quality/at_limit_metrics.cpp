#include "judge/quality/at_limit_metrics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "retarget/motion.h"
#include "retarget/text.h"
#include "robot/anatomy/robot_hands.h"

namespace retarget {
namespace {

// One end of a joint's range.
struct JointLimit {
  int joint = 0;  // Index into the robot's joints.
  bool upper = false;
  double bound = 0.0;
  double reach = 0.0;  // Distance that counts as at the limit, rad or m.

  [[nodiscard]] bool reached(double position) const {
    return (upper ? bound - position : position - bound) <= reach;
  }
};

// Head and neck joints affect no other limb.
bool is_of_the_head(const std::string& joint) {
  const std::string name = lower_case(joint);
  return name.find("head") != std::string::npos || name.find("neck") != std::string::npos;
}

// A fist presses finger joints against their limits, and a resting thumb may as well.
std::set<int> joints_of_hands(const Robot& robot) {
  std::set<int> joints;
  for (const auto& hand : find_hands(robot)) {
    if (!hand) continue;
    for (const HandJoint& joint : hand->joints) joints.insert(joint.joint);
  }
  return joints;
}

// Ignores a limit at which the joint is in the zero configuration, as in straight knees and open
// hands. Ignores joints without a range, which are fixed.
std::vector<JointLimit> limits_that_count(const Robot& robot, const LimitSet& limits) {
  constexpr double kNear = 0.01;       // rad
  constexpr double kNearShare = 0.01;  // Fraction of the range.
  const std::vector<double> zero = robot.zero_configuration();
  const std::set<int> fingers = joints_of_hands(robot);
  std::vector<JointLimit> found;
  for (const int j : robot.output_joints()) {
    if (fingers.contains(j)) continue;
    const RobotJoint& joint = robot.joints()[j];
    const double range = limits.upper[j] - limits.lower[j];
    const double near = joint.type == RobotJoint::Type::kHinge ? kNear : HUGE_VAL;
    const double reach = std::min(near, kNearShare * range);
    if (!(range > 0.0) || !std::isfinite(reach) || is_of_the_head(joint.name)) continue;
    for (const bool upper : {false, true}) {
      const JointLimit limit{j, upper, upper ? limits.upper[j] : limits.lower[j], reach};
      if (!limit.reached(zero[joint.qpos_address])) found.push_back(limit);
    }
  }
  return found;
}

// Time that a joint spends at a limit.
struct Stay {
  int frames = 0;
  int begin = 0, end = 0;  // Longest contiguous range of frames.
};

Stay stay_at(const JointLimit& limit, const RobotClip& clip, const Posture& posture,
             std::vector<char>& any) {
  const int at = clip.robot().joints()[limit.joint].qpos_address;
  Stay stay;
  int begin = 0;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    if (!posture.is_upright(frame) || !limit.reached(clip.qpos(frame)[at])) {
      begin = frame + 1;
      continue;
    }
    any[frame] = 1;
    ++stay.frames;
    if (frame + 1 - begin > stay.end - stay.begin) {
      stay.begin = begin;
      stay.end = frame + 1;
    }
  }
  return stay;
}

}  // namespace

void measure_at_limits(const ReportBuilder& draft, const LimitSet& limits, const Posture& posture) {
  constexpr std::size_t kNamed = 3;
  const RobotClip& clip = draft.clip;
  const auto frames = std::ranges::count(posture.upright, 1);
  if (frames == 0) return;
  std::vector<char> any(clip.frame_count(), 0);
  std::vector<std::pair<Stay, JointLimit>> stays;
  std::set<int> counted;  // Joint indices.
  std::int64_t joint_frames = 0;
  for (const JointLimit& limit : limits_that_count(clip.robot(), limits)) {
    const Stay stay = stay_at(limit, clip, posture, any);
    if (std::isfinite(limit.bound)) counted.insert(limit.joint);
    joint_frames += stay.frames;
    if (stay.frames > 0) stays.emplace_back(stay, limit);
  }
  std::ranges::stable_sort(stays, std::greater(), [](const auto& s) { return s.first.frames; });
  const auto share = [frames](int of_them) {
    return percent(of_them, static_cast<double>(frames));
  };
  if (!stays.empty()) {
    draft.report.fault_totals.push_back({"joint_at_limit_pct", static_cast<int>(stays.size())});
  }
  for (std::size_t i = 0; i < std::min(kNamed, stays.size()); ++i) {
    const auto& [stay, limit] = stays[i];
    const std::string& name = clip.robot().joints()[limit.joint].name;
    draft.report.faults.push_back({"joint_at_limit_pct", name, stay.begin, stay.end, stay.begin,
                                   share(stay.frames), "% of frames"});
    if (i == 0) draft.report.at_limit = {name, limit.upper, share(stay.frames)};
  }
  draft.set("at_limit_pct",
            percent(static_cast<double>(std::ranges::count(any, 1)), static_cast<double>(frames)));
  draft.set("joint_frames_at_limit_pct",
            percent(static_cast<double>(joint_frames),
                    static_cast<double>(counted.size()) * static_cast<double>(frames)));
  draft.set("joint_at_limit_pct", stays.empty() ? 0.0 : share(stays.front().first.frames));
}

}  // namespace retarget
