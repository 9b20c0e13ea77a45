#include "solve/targets/limb_lengths.h"

#include <algorithm>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "base/try.h"
#include "retarget/kinematic_tree.h"
#include "retarget/pose.h"
#include "robot/model/limb_joints.h"

namespace retarget {
namespace {

using enum LimbBone;

// Smallest ratio of a limb's two segments. With a smaller one, the configuration names a wrong
// body.
constexpr double kNoLength = 0.05;

// The bones of a limb: upper, lower, end.
struct MeasuredLimb {
  std::array<Bone, 3> bones, other;  // `other`: alternatives that a configuration may use.
};

MeasuredLimb leg_of(Side side) {
  const Bone upper = side_bone(side, kUpLeg), lower = side_bone(side, kLeg);
  return {{upper, lower, side_bone(side, kFootMod)}, {upper, lower, side_bone(side, kFoot)}};
}

MeasuredLimb arm_of(Side side) {
  const std::array bones = {side_bone(side, kArm), side_bone(side, kForeArm),
                            side_bone(side, kHand)};
  return {bones, bones};
}

class RobotMeasure {
 public:
  RobotMeasure(const Robot& robot, const ResolvedConfig& config)
      : robot_(robot), config_(config), posed_(robot.tree(), robot.zero_configuration()) {}

  Result<RobotLimbs> measure();
  Result<RobotLimbs> measure_arms();
  Result<double> measure_leg();

 private:
  // The path of bodies from the root to a limb's end.
  struct Chain {
    std::vector<int> path;
    std::size_t lower = 0;  // Index of the lower bone's body in `path`.
    std::size_t bend = 0;   // Index of the first body with the lower bone's joints: `lower`, or its
                            // first joint frame (RobotProfile::joint_frames).
  };
  [[nodiscard]] bool has_forearms() const;
  [[nodiscard]] bool is_joint_frame(int body) const {
    return std::ranges::count(robot_.profile().joint_frames, robot_.bodies()[body].name) > 0;
  }
  // A limb on both sides: mid-point of the first joints, vector from the right to the left one, and
  // mean length.
  struct Pair {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    Eigen::Vector3d across = Eigen::Vector3d::Zero();
    double length = 0.0;
  };

  [[nodiscard]] Result<Chain> chain(const MeasuredLimb& limb, std::size_t bones) const;
  [[nodiscard]] Result<Pair> measure_pair(const std::array<MeasuredLimb, 2>& limbs,
                                          std::size_t bones = 3);
  // Joints of the bodies [begin, end) of a path, from the trunk outwards.
  [[nodiscard]] std::vector<int> joints_of(const std::vector<int>& path, std::size_t begin,
                                           std::size_t end) const;
  // Centres of a limb's joints.
  struct Centres {
    Eigen::Vector3d first, middle, end;
    [[nodiscard]] double length() const { return (middle - first).norm() + (end - middle).norm(); }
  };
  [[nodiscard]] Centres centres_of(const Chain& chain, std::size_t common, std::size_t bones) const;
  [[nodiscard]] Centres centres_with(const Chain& chain, std::size_t common, std::size_t bones,
                                     const Eigen::Vector3d& middle) const;
  [[nodiscard]] Eigen::Vector3d root_of(const Chain& chain, std::size_t begin,
                                        const Eigen::Vector3d& middle) const;
  [[nodiscard]] Eigen::Vector3d end_of(const Chain& chain, const Eigen::Vector3d& middle,
                                       const Eigen::Vector3d& root) const;
  [[nodiscard]] Eigen::Vector3d off_last_axis(const std::vector<int>& path,
                                              const std::vector<int>& joints) const;
  [[nodiscard]] Eigen::Vector3d centre_of_joints(const std::vector<int>& path, std::size_t begin,
                                                 std::size_t end) const;
  void note(Bone bone, const Eigen::Vector3d& centre);
  void find_ankle_height();

  const Robot& robot_;
  const ResolvedConfig& config_;
  TreeState posed_;
  RobotLimbs limbs_;
  std::vector<double> ankles_;  // Ankle heights, metres.
};

std::vector<int> RobotMeasure::joints_of(const std::vector<int>& path, std::size_t begin,
                                         std::size_t end) const {
  std::vector<int> joints;
  const auto part = std::span(path).subspan(begin, end - begin);
  for (int j = 0; j < static_cast<int>(robot_.joints().size()); ++j) {
    if (std::ranges::find(part, robot_.joints()[j].body) != part.end()) joints.push_back(j);
  }
  return joints;
}

// The common point of the joint axes on a part of a path. Without joints, the origin of the body at
// `begin`.
Eigen::Vector3d RobotMeasure::centre_of_joints(const std::vector<int>& path, std::size_t begin,
                                               std::size_t end) const {
  const std::vector<int> joints = joints_of(path, begin, end);
  if (!joints.empty()) return common_point(posed_, joints);
  return posed_.world_from_body(path[std::min(begin, path.size() - 1)]).translation;
}

// Centre of a limb's first joint: centre_of_joints() without joints that belong to the knee or
// elbow, which may have two hinges.
Eigen::Vector3d RobotMeasure::root_of(const Chain& chain, std::size_t begin,
                                      const Eigen::Vector3d& middle) const {
  std::vector<int> joints = joints_of(chain.path, begin, chain.bend);
  std::ranges::reverse(joints);
  const std::size_t at_middle = joints_at_middle(posed_, joints, middle);
  if (at_middle == 0) return centre_of_joints(chain.path, begin, chain.bend);
  joints.erase(joints.begin(), joints.begin() + static_cast<std::ptrdiff_t>(at_middle));
  return common_point(posed_, joints);
}

// Offset of the last body's origin from the axis of its own joint. The wrist is on the axis, which
// twists the forearm, but the body's origin may be anywhere.
Eigen::Vector3d RobotMeasure::off_last_axis(const std::vector<int>& path,
                                            const std::vector<int>& joints) const {
  constexpr double kRounding = 1e-6;  // Metres.
  if (joints.empty()) return Eigen::Vector3d::Zero();
  const int last = joints.back();
  const int body = robot_.joints()[last].body;
  const bool is_own = body == path.back() || robot_.moved_body(body) == path.back();
  const Eigen::Vector3d off = across(
      posed_.world_from_body(path.back()).translation - posed_.anchor(last), posed_.axis(last));
  return is_own && off.norm() > kRounding ? off : Eigen::Vector3d(Eigen::Vector3d::Zero());
}

// The end of a limb (ankle or wrist), also without joints that belong to the knee or elbow. If the
// axes of all further joints pass through the knee or elbow, the end is the origin of the last body
// or an estimate by segment_end().
Eigen::Vector3d RobotMeasure::end_of(const Chain& chain, const Eigen::Vector3d& middle,
                                     const Eigen::Vector3d& root) const {
  constexpr double kFarther = 1.1;
  const auto& [path, lower, bend] = chain;
  const std::vector<int> joints = joints_of(path, lower + 1, path.size());
  const std::span<const int> beyond =
      std::span(joints).subspan(joints_at_middle(posed_, joints, middle));
  const Eigen::Vector3d end = beyond.size() == joints.size()
                                  ? centre_of_joints(path, lower + 1, path.size())
                                  : common_point(posed_, beyond);
  const double near = kLeastSegment * (middle - root).norm();
  if (!all_pass(posed_, joints, middle, near)) return end;
  const Eigen::Vector3d origin =
      posed_.world_from_body(path.back()).translation - off_last_axis(path, joints);
  if ((origin - middle).norm() > std::max(near, kFarther * (end - middle).norm())) return origin;
  const std::vector<int> bends = joints_of(path, bend, lower + 1);
  if ((end - middle).norm() >= kNearestWrist * (middle - root).norm() || bends.empty()) return end;
  return segment_end(
             robot_, posed_,
             {robot_.tree().carrier(path.back()), root, middle, posed_.axis(bends.front()), joints})
      .point;
}

// Bodies from the child of the world to `body`.
std::vector<int> path_to(const Robot& robot, int body) {
  std::vector<int> path;
  for (; body > 0; body = robot.bodies()[body].parent) path.push_back(body);
  std::ranges::reverse(path);
  return path;
}

// Robots without wrists often have no body that follows a hand.
bool RobotMeasure::has_forearms() const {
  return config_.body_of(Bone::kLeftHand) >= 0 || config_.body_of(Bone::kRightHand) >= 0;
}

std::string text_of(Bone bone) {
  return std::string(bone_name(bone));
}

// @param bones  number of bones of the limb: three, or two if it ends at the joint of the lower
//     bone.
Result<RobotMeasure::Chain> RobotMeasure::chain(const MeasuredLimb& limb, std::size_t bones) const {
  std::array<int, 3> bodies{};
  for (std::size_t i = 0; i < bones; ++i) {
    bodies[i] = config_.body_of(limb.bones[i]);
    if (bodies[i] < 0) bodies[i] = config_.body_of(limb.other[i]);
    if (bodies[i] < 0) {
      return config_failure(
          config_.file, "no body follows " + text_of(limb.other[i]) + ": limbs cannot be measured",
          kOtherScaleHint);
    }
  }
  Chain chain{path_to(robot_, bodies[bones - 1]), 0, 0};
  const auto lower = std::ranges::find(chain.path, bodies[1]);
  if (lower == chain.path.end() || std::find(chain.path.begin(), lower, bodies[0]) == lower) {
    return config_failure(config_.file,
                          "the bodies of " + text_of(limb.bones[0]) + ", " +
                              text_of(limb.bones[1]) + " and " + text_of(limb.other[2]) +
                              " do not form a chain: limbs cannot be measured",
                          kOtherScaleHint);
  }
  chain.lower = static_cast<std::size_t>(lower - chain.path.begin());
  chain.bend = chain.lower;
  while (chain.bend > 0 && is_joint_frame(chain.path[chain.bend - 1])) --chain.bend;
  return chain;
}

// Records the position of a bone's joint in the body that follows the bone.
void RobotMeasure::note(Bone bone, const Eigen::Vector3d& centre) {
  const int body = config_.body_of(bone);
  if (body < 0) return;
  limbs_.body_from_joint[bone] = posed_.world_from_body(body).inverse() * centre;
}

RobotMeasure::Centres RobotMeasure::centres_with(const Chain& chain, std::size_t common,
                                                 std::size_t bones,
                                                 const Eigen::Vector3d& middle) const {
  const Eigen::Vector3d first = root_of(chain, common, middle);
  return {first, middle, bones == 3 ? end_of(chain, middle, first) : middle};
}

// A joint with a separate frame may be anywhere on its axis, and so may the origin of the link
// beyond it. Of both, the knee or elbow is where the limb is shorter.
RobotMeasure::Centres RobotMeasure::centres_of(const Chain& chain, std::size_t common,
                                               std::size_t bones) const {
  const auto& [path, lower, bend] = chain;
  const Eigen::Vector3d middle = centre_of_joints(path, bend, lower + 1);
  const Centres centres = centres_with(chain, common, bones, middle);
  const std::vector<int> joints = joints_of(path, bend, lower + 1);
  if (bones < 3 || bend == lower || joints.size() != 1) return centres;
  const Eigen::Vector3d& axis = posed_.axis(joints.front());
  const Eigen::Vector3d origin = posed_.world_from_body(path[lower]).translation;
  const Centres others =
      centres_with(chain, common, bones, middle + axis * axis.dot(origin - middle));
  return others.length() < centres.length() ? others : centres;
}

Result<RobotMeasure::Pair> RobotMeasure::measure_pair(const std::array<MeasuredLimb, 2>& limbs,
                                                      std::size_t bones) {
  std::array<Chain, 2> chains;
  for (std::size_t side = 0; side < 2; ++side) {
    TRY_ASSIGN(chains[side], chain(limbs[side], bones));
  }
  std::size_t common = 0;
  while (common < std::min(chains[0].bend, chains[1].bend) &&
         chains[0].path[common] == chains[1].path[common]) {
    ++common;
  }
  Pair pair;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto [first, middle, end] = centres_of(chains[side], common, bones);
    note(limbs[side].bones[0], first);
    note(limbs[side].bones[1], middle);
    note(limbs[side].bones[2], end);
    if (limbs[side].other[2] != limbs[side].bones[2]) {
      note(limbs[side].other[2], end);
      ankles_.push_back(end.z());
    }
    pair.middle += 0.5 * first;
    pair.across += (side == 0 ? 1.0 : -1.0) * first;
    const double upper = (middle - first).norm();
    const double rest = (end - middle).norm();
    if (!(upper > kNoLength * rest) || (bones == 3 && !(rest > kNoLength * upper))) {
      return config_failure(
          config_.file,
          "the bodies of " + text_of(limbs[side].bones[0]) + ", " + text_of(limbs[side].bones[1]) +
              " and " + text_of(limbs[side].other[2]) +
              " give the robot's limb zero length: each body must begin at the joint of its bone",
          kOtherScaleHint);
    }
    pair.length += 0.5 * (upper + rest);
  }
  return pair;
}

void RobotMeasure::find_ankle_height() {
  if (robot_.profile().soles.empty()) return;
  double lowest = std::numeric_limits<double>::infinity();
  for (const Sole& sole : robot_.profile().soles) {
    const Pose world_from_body = posed_.world_from_body(sole.body);
    for (const Eigen::Vector3d& point : sole.points) {
      lowest = std::min(lowest, (world_from_body * point).z());
    }
  }
  limbs_.ankle_height = 0.5 * (ankles_[0] + ankles_[1]) - lowest;
}

Result<double> RobotMeasure::measure_leg() {
  TRY_ASSIGN(const Pair legs, measure_pair({leg_of(Side::kLeft), leg_of(Side::kRight)}));
  if (!(legs.length > 0.0)) {
    return config_failure(config_.file, "a leg of the robot has zero length", kOtherScaleHint);
  }
  return legs.length;
}

Result<RobotLimbs> RobotMeasure::measure_arms() {
  limbs_.forearms = has_forearms();
  TRY_ASSIGN(const Pair arms,
             measure_pair({arm_of(Side::kLeft), arm_of(Side::kRight)}, limbs_.forearms ? 3 : 2));
  limbs_.shoulder_centre = arms.middle;
  limbs_.shoulder_line = arms.across;
  limbs_.lengths.arm = arms.length;
  return limbs_;
}

Result<RobotLimbs> RobotMeasure::measure() {
  TRY_ASSIGN(const Pair legs, measure_pair({leg_of(Side::kLeft), leg_of(Side::kRight)}));
  find_ankle_height();
  TRY(measure_arms());
  note(Bone::kHips, legs.middle);
  limbs_.hip_centre = legs.middle;
  limbs_.hip_line = legs.across;
  auto& [leg, arm, trunk] = limbs_.lengths;
  leg = legs.length;
  trunk = (limbs_.shoulder_centre - legs.middle).norm();
  if (!(leg > 0.0 && arm > 0.0 && trunk > 0.0)) {
    return config_failure(config_.file, "a limb of the robot has zero length", kOtherScaleHint);
  }
  return limbs_;
}

}  // namespace

LimbLengths human_limb_lengths(const HumanPose& world_from_bone, bool forearms) {
  const auto at = [&](Bone bone) -> const Eigen::Vector3d& {
    return world_from_bone[bone].translation;
  };
  const auto way = [&](std::initializer_list<Bone> bones) {
    double sum = 0.0;
    for (const Bone* bone = bones.begin(); bone + 1 != bones.end(); ++bone) {
      sum += (at(bone[1]) - at(*bone)).norm();
    }
    return sum;
  };
  LimbLengths lengths;
  for (const Side side : kSides) {
    lengths.leg +=
        0.5 * way({side_bone(side, kUpLeg), side_bone(side, kLeg), side_bone(side, kFoot)});
    lengths.arm +=
        0.5 * (forearms
                   ? way({side_bone(side, kArm), side_bone(side, kForeArm), side_bone(side, kHand)})
                   : way({side_bone(side, kArm), side_bone(side, kForeArm)}));
  }
  const Eigen::Vector3d hips = 0.5 * (at(Bone::kLeftUpLeg) + at(Bone::kRightUpLeg));
  const Eigen::Vector3d shoulders = 0.5 * (at(Bone::kLeftArm) + at(Bone::kRightArm));
  lengths.trunk = (at(Bone::kSpine) - hips).norm() +
                  way({Bone::kSpine, Bone::kSpine1, Bone::kSpine2}) +
                  (shoulders - at(Bone::kSpine2)).norm();
  return lengths;
}

Result<RobotLimbs> robot_limbs(const Robot& robot, const ResolvedConfig& config) {
  return RobotMeasure(robot, config).measure();
}

Result<RobotLimbs> robot_arms(const Robot& robot, const ResolvedConfig& config) {
  return RobotMeasure(robot, config).measure_arms();
}

Result<double> robot_leg_length(const Robot& robot, const ResolvedConfig& config) {
  return RobotMeasure(robot, config).measure_leg();
}

}  // namespace retarget
