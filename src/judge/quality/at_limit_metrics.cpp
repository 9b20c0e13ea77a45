#include "judge/quality/body_metrics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
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
  double reach = 0.0;  // Largest distance at which a joint is at the limit, rad or m.

  [[nodiscard]] bool reached(double position) const {
    return (upper ? bound - position : position - bound) <= reach;
  }
};

// Joints of head and neck are excluded, because they move no limb.
bool is_of_the_head(const std::string& joint) {
  const std::string name = lower_case(joint);
  return name.find("head") != std::string::npos || name.find("neck") != std::string::npos;
}

// Joints of hands are excluded, because the fingers of a fist and a relaxed thumb may be at their
// limits.
std::set<int> joints_of_hands(const Robot& robot) {
  std::set<int> joints;
  for (const auto& hand : find_hands(robot)) {
    if (!hand) continue;
    for (const HandJoint& joint : hand->joints) joints.insert(joint.joint);
  }
  return joints;
}

// The limits that the metrics use. Excludes limits that the joint reaches in the zero
// configuration, such as those of straight knees, and joints without a range, which are fixed.
std::vector<JointLimit> counted_limits(const Robot& robot, const LimitSet& limits) {
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

// Upright frames in which a joint is at a limit.
struct Stay {
  int frames = 0;          // Number of frames in which the human's pose does not demand it.
  int demanded = 0;        // Number of frames in which it does.
  int begin = 0, end = 0;  // Longest run of the former.
  int run = 0;             // First frame of the current run.

  void leave(int frame) { run = frame + 1; }
  void add(int frame) {
    ++frames;
    if (frame + 1 - run <= end - begin) return;
    begin = run;
    end = frame + 1;
  }
};

struct LimitStay {
  JointLimit limit;
  Stay stay;
};

// @return the number of upright frames in which any joint is at a limit.
int count_stays(const RobotClip& clip, const Posture& posture, JointDemand* demand,
                std::vector<LimitStay>& stays) {
  int any = 0;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const bool is_upright = posture.is_upright(frame);
    const auto qpos = clip.qpos(frame);
    bool found = false;
    for (auto& [limit, stay] : stays) {
      const bool stays_here =
          is_upright && limit.reached(qpos[clip.robot().joints()[limit.joint].qpos_address]);
      const bool is_demanded =
          stays_here && demand != nullptr && demand->reaches(frame, limit.joint, limit.upper);
      found = found || stays_here;
      if (is_demanded) ++stay.demanded;
      if (stays_here && !is_demanded) {
        stay.add(frame);
      } else {
        stay.leave(frame);
      }
    }
    if (found) ++any;
  }
  return any;
}

// Reports the joints at a limit that the human's pose does not demand, most frames first.
void report_stays(const ReportBuilder& draft, std::vector<LimitStay> stays, double frames) {
  constexpr std::size_t kNamed = 3;
  std::erase_if(stays, [](const LimitStay& each) { return each.stay.frames == 0; });
  std::ranges::stable_sort(stays, std::greater(),
                           [](const LimitStay& each) { return each.stay.frames; });
  if (!stays.empty()) {
    draft.report.fault_totals.push_back({"joint_at_limit_pct", static_cast<int>(stays.size())});
  }
  for (std::size_t i = 0; i < std::min(kNamed, stays.size()); ++i) {
    const auto& [limit, stay] = stays[i];
    const std::string& name = draft.clip.robot().joints()[limit.joint].name;
    const double share = percent(stay.frames, frames);
    draft.report.faults.push_back(
        {"joint_at_limit_pct", name, stay.begin, stay.end, stay.begin, share, "% of frames"});
    if (i == 0) draft.report.at_limit = {name, limit.upper, share};
  }
  draft.set("joint_at_limit_pct", stays.empty() ? 0.0 : percent(stays.front().stay.frames, frames));
}

// Reports the joint at a limit that the human's pose demands in the most frames.
void report_demanded(const ReportBuilder& draft, const std::vector<LimitStay>& stays,
                     double frames) {
  const auto most =
      std::ranges::max_element(stays, {}, [](const LimitStay& each) { return each.stay.demanded; });
  const int demanded = most == stays.end() ? 0 : most->stay.demanded;
  draft.set("joint_beyond_range_pct", percent(demanded, frames));
  if (demanded == 0) return;
  draft.report.beyond_range = {draft.clip.robot().joints()[most->limit.joint].name,
                               most->limit.upper, percent(demanded, frames)};
}

}  // namespace

void measure_at_limits(const ReportBuilder& draft, const LimitSet& limits, const Posture& posture,
                       JointDemand* demand) {
  const RobotClip& clip = draft.clip;
  const auto frames = static_cast<double>(std::ranges::count(posture.upright, 1));
  if (frames == 0.0) return;
  std::vector<LimitStay> stays;
  std::set<int> counted;  // Joint indices.
  for (const JointLimit& limit : counted_limits(clip.robot(), limits)) {
    if (std::isfinite(limit.bound)) counted.insert(limit.joint);
    stays.push_back({limit, {}});
  }
  const int any = count_stays(clip, posture, demand, stays);
  std::int64_t joint_frames = 0;
  for (const auto& [limit, stay] : stays) joint_frames += stay.frames + stay.demanded;
  draft.set("at_limit_pct", percent(any, frames));
  draft.set("joint_frames_at_limit_pct", percent(static_cast<double>(joint_frames),
                                                 static_cast<double>(counted.size()) * frames));
  report_stays(draft, stays, frames);
  if (demand != nullptr) report_demanded(draft, stays, frames);
}

}  // namespace retarget
