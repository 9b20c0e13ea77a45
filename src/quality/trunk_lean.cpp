#include "quality/trunk_lean.h"

#include <cmath>
#include <vector>

#include "quality/fault_list.h"
#include "retarget/human/bones.h"
#include "retarget/human/canonical_pose.h"
#include "retarget/math/so3.h"
#include "retarget/math/statistics.h"

namespace retarget {
namespace {

constexpr double kNoLength = 1e-9;

// bones from the hips out to one of these
std::vector<int> way_to(std::string_view end) {
  const bool left = end.starts_with("Left");
  if (end.ends_with("Leg")) return {*find_bone("Hips"), *find_bone(end)};
  std::vector<int> way;
  for (const char* bone : {"Hips", "Spine", "Spine1", "Spine2"}) way.push_back(*find_bone(bone));
  way.push_back(*find_bone(left ? "LeftShoulder" : "RightShoulder"));
  way.push_back(*find_bone(end));
  return way;
}

// where a bone is on the mean in the frame of another
Eigen::Vector3d mean_place(const HumanClip& human, int bone, int of) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < human.frame_count; ++i) {
    const auto pose = human.frame(i);
    sum += pose[of].rotation.conjugate() * (pose[bone].translation - pose[of].translation);
  }
  return sum / human.frame_count;
}

// from the hips to an end in the T-pose
Eigen::Vector3d standing_place(const HumanClip& human, std::string_view end) {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  int before = -1;
  for (const int bone : way_to(end)) {
    if (!human.has(bone)) continue;
    if (before >= 0) place += canonical_t_pose(before) * mean_place(human, bone, before);
    before = bone;
  }
  return place;
}

// angle from the vertical, degrees
double lean_of(const Eigen::Vector3d& up) {
  return kDegreesPerRadian * angle_between(up, Eigen::Vector3d::UnitZ());
}

// @param pose_of  world from body by index among the kept ones
template <typename PoseOf>
TrunkJoints joints_of(const RobotTrunk& trunk, const PoseOf& pose_of) {
  const auto at = [&](std::size_t i) -> Eigen::Vector3d {
    return pose_of(trunk.bodies[i]) * trunk.body_from_joint[i];
  };
  return {at(0), at(1), at(2), at(3)};
}

std::optional<Eigen::Matrix3d> standing_trunk(const Robot& robot, const BodyTracks& tracks,
                                              const RobotTrunk& trunk) {
  std::vector<Pose> world_from_body(robot.bodies().size());
  forward_kinematics(robot, robot.zero_configuration(), world_from_body);
  return trunk_axes(joints_of(
      trunk, [&](int body) -> const Pose& { return world_from_body[tracks.kept_bodies[body]]; }));
}

// by frame, degrees; as TrunkLean has them
struct Leans {
  std::vector<double> human, robot, human_line, robot_line, between;
};

}  // namespace

std::optional<Eigen::Matrix3d> trunk_axes(const TrunkJoints& joints) {
  const Eigen::Vector3d line = joints.line();
  const Eigen::Vector3d hips = joints.left_hip - joints.right_hip;
  const Eigen::Vector3d shoulders = joints.left_shoulder - joints.right_shoulder;
  if (!(line.norm() > kNoLength && hips.norm() > kNoLength && shoulders.norm() > kNoLength)) {
    return std::nullopt;
  }
  const Eigen::Vector3d across = hips.normalized() + shoulders.normalized();
  const Eigen::Vector3d up = line.normalized();
  const Eigen::Vector3d forward = across.cross(up);
  if (!(forward.norm() > kNoLength)) return std::nullopt;
  Eigen::Matrix3d axes;
  axes.col(0) = forward.normalized();
  axes.col(1) = up.cross(axes.col(0));
  axes.col(2) = up;
  return axes;
}

bool has_trunk(const HumanClipInfo& human) {
  if (!human.has(*find_bone("Hips"))) return false;
  for (const std::string_view end : kTrunkBones) {
    if (!human.has(*find_bone(end))) return false;
  }
  return true;
}

TrunkJoints human_trunk(std::span<const Pose> world_from_bone) {
  static const std::array<int, 4> kBones = {*find_bone(kTrunkBones[0]), *find_bone(kTrunkBones[1]),
                                            *find_bone(kTrunkBones[2]), *find_bone(kTrunkBones[3])};
  return {world_from_bone[kBones[0]].translation, world_from_bone[kBones[1]].translation,
          world_from_bone[kBones[2]].translation, world_from_bone[kBones[3]].translation};
}

std::optional<Eigen::Matrix3d> standing_trunk(const HumanClip& human) {
  if (!has_trunk(human) || human.frame_count == 0) return std::nullopt;
  return trunk_axes({standing_place(human, kTrunkBones[0]), standing_place(human, kTrunkBones[1]),
                     standing_place(human, kTrunkBones[2]), standing_place(human, kTrunkBones[3])});
}

void measure_trunk_lean(const Draft& draft, const BodyTracks& tracks, const RobotTrunk& trunk,
                        const HumanClip& human, const Eigen::Quaterniond& robot_from_human,
                        int frames) {
  constexpr double kFarOff = 15.0;  // degrees
  const auto human_standing = standing_trunk(human);
  const auto robot_standing = standing_trunk(draft.clip.robot(), tracks, trunk);
  if (!human_standing || !robot_standing) return;
  FaultList faults("trunk_lean_error_deg", "deg");
  Leans leans;
  std::vector<double> errors;
  for (int frame = 0; frame < frames; ++frame) {
    const TrunkJoints of_human = human_trunk(human.frame(frame));
    const TrunkJoints of_robot =
        joints_of(trunk, [&](int body) -> const Pose& { return tracks.kept(frame, body); });
    const auto human_axes = trunk_axes(of_human), robot_axes = trunk_axes(of_robot);
    if (!human_axes || !robot_axes) continue;
    const Eigen::Vector3d human_up = trunk_up(*human_axes, *human_standing);
    const Eigen::Vector3d robot_up = trunk_up(*robot_axes, *robot_standing);
    leans.human.push_back(lean_of(human_up));
    leans.robot.push_back(lean_of(robot_up));
    leans.human_line.push_back(lean_of(of_human.line()));
    leans.robot_line.push_back(lean_of(of_robot.line()));
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
  faults.move_to(draft.report.faults, draft.options.faults_per_metric);
}

}  // namespace retarget
