#include "judge/quality/trunk_lean.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "base/math/so3.h"
#include "base/math/statistics.h"
#include "judge/quality/fault_list.h"
#include "retarget/pose.h"
#include "retarget/robot.h"
#include "robot/model/kinematic_tree.h"

namespace retarget {
namespace {

// Angle from the vertical, degrees.
double lean_of(const Eigen::Vector3d& up) {
  return kDegreesPerRadian * angle_between(up, Eigen::Vector3d::UnitZ());
}

// @param pose_of  returns world_from_body by index among the kept bodies
template <typename PoseOf>
TrunkLines lines_of(const TrunkBodies& trunk, const PoseOf& pose_of) {
  const auto at = [&](std::size_t i) -> Eigen::Vector3d {
    return pose_of(trunk.bodies[i]) * trunk.body_from_joint[i];
  };
  return {0.5 * (at(2) + at(3) - at(0) - at(1)), at(2) - at(3)};
}

std::optional<Eigen::Matrix3d> standing_trunk(const Robot& robot, const BodyTracks& tracks,
                                              const TrunkBodies& trunk) {
  const TreeState posed(robot.tree(), robot.zero_configuration());
  return trunk_frame(
      lines_of(trunk, [&](int body) { return posed.world_from_body(tracks.kept_bodies[body]); }));
}

// By frame, degrees; as in TrunkLean.
struct Leans {
  std::vector<double> human, robot, human_line, robot_line, between;
};

}  // namespace

bool has_trunk(const HumanClipInfo& human) {
  return human.has(Bone::kHips) &&
         std::ranges::all_of(kTrunkBones, [&](Bone bone) { return human.has(bone); });
}

std::optional<Eigen::Matrix3d> standing_trunk(const HumanClip& human) {
  if (!has_trunk(human)) return std::nullopt;
  return trunk_frame(standing_trunk_lines(human, poses_of(human)));
}

void measure_trunk_lean(const ReportBuilder& draft, const BodyTracks& tracks,
                        const TrunkBodies& trunk, const HumanClip& human,
                        const Eigen::Quaterniond& robot_from_human, const Posture& posture,
                        int frames) {
  constexpr double kFarOff = 15.0;  // degrees
  const auto human_standing = standing_trunk(human);
  const auto robot_standing = standing_trunk(draft.clip.robot(), tracks, trunk);
  if (!human_standing || !robot_standing) return;
  FaultList faults("trunk_lean_error_deg", "deg");
  Leans leans;
  std::vector<double> errors;
  for (int frame = 0; frame < frames; ++frame) {
    if (!posture.is_upright(frame)) continue;
    const TrunkLines of_human = trunk_lines(human.frame(frame));
    const TrunkLines of_robot =
        lines_of(trunk, [&](int body) -> const Pose& { return tracks.kept(frame, body); });
    const auto human_axes = trunk_frame(of_human), robot_axes = trunk_frame(of_robot);
    if (!human_axes || !robot_axes) continue;
    const Eigen::Vector3d human_up = trunk_up(*human_axes, *human_standing);
    const Eigen::Vector3d robot_up = trunk_up(*robot_axes, *robot_standing);
    leans.human.push_back(lean_of(human_up));
    leans.robot.push_back(lean_of(robot_up));
    leans.human_line.push_back(lean_of(of_human.chord));
    leans.robot_line.push_back(lean_of(of_robot.chord));
    leans.between.push_back(kDegreesPerRadian *
                            angle_between(robot_from_human * human_up, robot_up));
    errors.push_back(std::abs(leans.robot.back() - leans.human.back()));
    if (errors.back() > kFarOff) faults.add("trunk", frame, errors.back());
  }
  if (errors.empty()) return;
  draft.report.trunk_lean = {mean(leans.human),
                             mean(leans.robot),
                             mean(leans.human_line),
                             mean(leans.robot_line),
                             mean(leans.between),
                             lean_of(human_standing->col(2)),
                             lean_of(robot_standing->col(2))};
  draft.set("trunk_lean_error_deg", mean(errors), percentile(errors, 95.0));
  faults.move_to(draft.report, draft.options.faults_per_metric);
}

}  // namespace retarget
