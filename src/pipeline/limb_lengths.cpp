#include "pipeline/limb_lengths.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "pipeline/body_path.h"

namespace retarget {
namespace {

constexpr std::array<const char*, 2> kSides = {"Left", "Right"};

// a limb of one side: the bones that it consists of, the bodies that follow them
struct LimbBones {
  std::array<std::string, 3> bones;  // upper, lower, end
  std::array<std::string, 3> other;  // names that the mapping may use instead
};

LimbBones leg_bones(const std::string& side) {
  return {{side + "UpLeg", side + "Leg", side + "FootMod"},
          {side + "UpLeg", side + "Leg", side + "Foot"}};
}

LimbBones arm_bones(const std::string& side) {
  return {{side + "Arm", side + "ForeArm", side + "Hand"},
          {side + "Arm", side + "ForeArm", side + "Hand"}};
}

class RobotMeasure {
 public:
  RobotMeasure(const Robot& robot, const IkTables& tables)
      : robot_(robot), tables_(tables), world_from_body_(robot.bodies().size()) {
    forward_kinematics(robot, robot.zero_configuration(), world_from_body_);
  }

  Result<RobotLimbs> measure();
  Result<double> measure_leg();

 private:
  // the way to a limb's end
  struct Chain {
    std::vector<int> path;
    std::size_t lower = 0;  // where the lower bone's body is on it
  };
  [[nodiscard]] bool has_forearms() const;
  // middle of both sides' first joints, the way from the right one to the left one, and the mean
  // length of both sides
  struct Pair {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    Eigen::Vector3d across = Eigen::Vector3d::Zero();
    double length = 0.0;
  };

  [[nodiscard]] std::optional<int> body_of(const std::string& bone) const;
  [[nodiscard]] Result<Chain> chain(const LimbBones& limb, std::size_t bones) const;
  [[nodiscard]] Result<Pair> measure_pair(const std::array<LimbBones, 2>& limbs,
                                          std::size_t bones = 3);
  [[nodiscard]] Eigen::Vector3d centre_of_joints(const std::vector<int>& path, std::size_t begin,
                                                 std::size_t end) const;
  void note(const std::string& bone, const Eigen::Vector3d& centre);
  void find_ankle_height();

  const Robot& robot_;
  const IkTables& tables_;
  std::vector<Pose> world_from_body_;
  RobotLimbs limbs_;
  std::vector<double> ankles_;  // heights
};

std::optional<int> RobotMeasure::body_of(const std::string& bone) const {
  const IkRow* const row = tables_.find_row(bone);
  return row == nullptr ? std::nullopt : robot_.find_body(row->body);
}

// where the axes of the joints on a part of a path come nearest to each other; without joints the
// origin of the body before which they would be
Eigen::Vector3d RobotMeasure::centre_of_joints(const std::vector<int>& path, std::size_t begin,
                                               std::size_t end) const {
  constexpr double kPullToAnchor = 0.01;
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  bool any = false;
  for (std::size_t i = begin; i < end; ++i) {
    for (const RobotJoint& joint : robot_.joints()) {
      if (joint.body != path[i]) continue;
      const Pose& world_from_body = world_from_body_[joint.body];
      const Eigen::Vector3d axis = world_from_body.rotation * joint.axis;
      const Eigen::Vector3d anchor =
          world_from_body.translation + world_from_body.rotation * joint.anchor;
      Eigen::Matrix3d across = (1.0 + kPullToAnchor) * Eigen::Matrix3d::Identity();
      if (joint.type == RobotJoint::Type::kHinge) across -= axis * axis.transpose();
      a += across;
      b += across * anchor;
      any = true;
    }
  }
  if (!any) return world_from_body_[path[std::min(begin, path.size() - 1)]].translation;
  return a.inverse() * b;
}

// robots without wrists often have no hand that follows anything
bool RobotMeasure::has_forearms() const {
  return std::ranges::any_of(
      kSides, [&](const std::string& side) { return body_of(side + "Hand").has_value(); });
}

// @param bones  of the limb: three, or two where it ends with the lower bone's joint
Result<RobotMeasure::Chain> RobotMeasure::chain(const LimbBones& limb, std::size_t bones) const {
  std::array<int, 3> bodies{};
  for (std::size_t i = 0; i < bones; ++i) {
    auto body = body_of(limb.bones[i]);
    if (!body) body = body_of(limb.other[i]);
    if (!body) {
      return config_failure(tables_.file,
                            "no body follows " + limb.other[i] + ": limbs cannot be measured",
                            kOtherScaleHint);
    }
    bodies[i] = *body;
  }
  Chain chain{path_to(robot_, bodies[bones - 1]), 0};
  const auto lower = std::ranges::find(chain.path, bodies[1]);
  if (lower == chain.path.end() || std::find(chain.path.begin(), lower, bodies[0]) == lower) {
    return config_failure(tables_.file,
                          "the bodies of " + limb.bones[0] + ", " + limb.bones[1] + " and " +
                              limb.other[2] + " do not follow each other: limbs cannot be measured",
                          kOtherScaleHint);
  }
  chain.lower = static_cast<std::size_t>(lower - chain.path.begin());
  return chain;
}

// where a bone's joint lies in the body that follows the bone
void RobotMeasure::note(const std::string& bone, const Eigen::Vector3d& centre) {
  const auto body = body_of(bone);
  if (!body) return;
  const Pose& world_from_body = world_from_body_[*body];
  limbs_.body_from_joint[find_bone(bone).value()] =
      world_from_body.rotation.conjugate() * (centre - world_from_body.translation);
}

Result<RobotMeasure::Pair> RobotMeasure::measure_pair(const std::array<LimbBones, 2>& limbs,
                                                      std::size_t bones) {
  std::array<Chain, 2> chains;
  for (std::size_t side = 0; side < 2; ++side) {
    auto found = chain(limbs[side], bones);
    if (!found) return failure(found.error());
    chains[side] = std::move(*found);
  }
  std::size_t common = 0;
  while (common < std::min(chains[0].lower, chains[1].lower) &&
         chains[0].path[common] == chains[1].path[common]) {
    ++common;
  }
  Pair pair;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto& [path, lower] = chains[side];
    const Eigen::Vector3d first = centre_of_joints(path, common, lower);
    const Eigen::Vector3d middle = centre_of_joints(path, lower, lower + 1);
    const Eigen::Vector3d end =
        bones == 3 ? centre_of_joints(path, lower + 1, path.size()) : middle;
    note(limbs[side].bones[0], first);
    note(limbs[side].bones[1], middle);
    note(limbs[side].bones[2], end);
    if (limbs[side].other[2] != limbs[side].bones[2]) {
      note(limbs[side].other[2], end);
      ankles_.push_back(end.z());
    }
    pair.middle += 0.5 * first;
    pair.across += (side == 0 ? 1.0 : -1.0) * first;
    pair.length += 0.5 * ((middle - first).norm() + (end - middle).norm());
  }
  return pair;
}

void RobotMeasure::find_ankle_height() {
  if (robot_.profile().soles.empty()) return;
  double lowest = std::numeric_limits<double>::infinity();
  for (const Sole& sole : robot_.profile().soles) {
    for (const Eigen::Vector3d& point : sole.points) {
      const Pose& world_from_body = world_from_body_[sole.body];
      lowest =
          std::min(lowest, (world_from_body.translation + world_from_body.rotation * point).z());
    }
  }
  limbs_.ankle_height = 0.5 * (ankles_[0] + ankles_[1]) - lowest;
}

Result<double> RobotMeasure::measure_leg() {
  const auto legs = measure_pair({leg_bones(kSides[0]), leg_bones(kSides[1])});
  if (!legs) return failure(legs.error());
  if (!(legs->length > 0.0)) {
    return config_failure(tables_.file, "a leg of the robot has no length", kOtherScaleHint);
  }
  return legs->length;
}

Result<RobotLimbs> RobotMeasure::measure() {
  const auto legs = measure_pair({leg_bones(kSides[0]), leg_bones(kSides[1])});
  if (!legs) return failure(legs.error());
  find_ankle_height();
  limbs_.forearms = has_forearms();
  const auto arms =
      measure_pair({arm_bones(kSides[0]), arm_bones(kSides[1])}, limbs_.forearms ? 3 : 2);
  if (!arms) return failure(arms.error());
  note("Hips", legs->middle);
  limbs_.hip_centre = legs->middle;
  limbs_.shoulder_centre = arms->middle;
  limbs_.hip_line = legs->across;
  limbs_.shoulder_line = arms->across;
  limbs_.lengths = {legs->length, arms->length, (arms->middle - legs->middle).norm()};
  const auto& [leg, arm, trunk] = limbs_.lengths;
  if (!(leg > 0.0 && arm > 0.0 && trunk > 0.0)) {
    return config_failure(tables_.file, "a limb of the robot has no length", kOtherScaleHint);
  }
  return limbs_;
}

}  // namespace

std::array<int, 13> limb_bones() {
  std::array<int, 13> bones{find_bone("Hips").value()};
  std::size_t next = 1;
  for (const std::string side : kSides) {
    for (const char* part : {"UpLeg", "Leg", "Foot", "Arm", "ForeArm", "Hand"}) {
      bones[next++] = find_bone(side + part).value();
    }
  }
  return bones;
}

LimbLengths human_limb_lengths(std::span<const Pose> world_from_bone, bool forearms) {
  const auto at = [&](const std::string& bone) -> const Eigen::Vector3d& {
    return world_from_bone[find_bone(bone).value()].translation;
  };
  const auto way = [&](std::initializer_list<std::string> bones) {
    double sum = 0.0;
    for (auto bone = bones.begin(); bone + 1 != bones.end(); ++bone) {
      sum += (at(bone[1]) - at(*bone)).norm();
    }
    return sum;
  };
  LimbLengths lengths;
  for (const std::string side : kSides) {
    lengths.leg += 0.5 * way({side + "UpLeg", side + "Leg", side + "Foot"});
    lengths.arm += 0.5 * (forearms ? way({side + "Arm", side + "ForeArm", side + "Hand"})
                                   : way({side + "Arm", side + "ForeArm"}));
  }
  const Eigen::Vector3d hips = 0.5 * (at("LeftUpLeg") + at("RightUpLeg"));
  const Eigen::Vector3d shoulders = 0.5 * (at("LeftArm") + at("RightArm"));
  lengths.trunk = (at("Spine") - hips).norm() + way({"Spine", "Spine1", "Spine2"}) +
                  (shoulders - at("Spine2")).norm();
  return lengths;
}

Result<RobotLimbs> robot_limbs(const Robot& robot, const IkTables& tables) {
  return RobotMeasure(robot, tables).measure();
}

Result<double> robot_leg_length(const Robot& robot, const IkTables& tables) {
  return RobotMeasure(robot, tables).measure_leg();
}

}  // namespace retarget
