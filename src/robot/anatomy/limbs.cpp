#include "robot/anatomy/limbs.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "base/try.h"
#include "retarget/kinematic_tree.h"
#include "retarget/so3.h"
#include "retarget/text.h"
#include "retarget/trigonometry.h"
#include "robot/anatomy/branches.h"
#include "robot/anatomy/limb_shape.h"
#include "robot/anatomy/limb_sides.h"
#include "robot/anatomy/underside.h"

namespace retarget {
namespace {

// Returns the direction in which flexion moves the limb's end.
Eigen::Vector3d motion_of_bending(const LimbShape& limb) {
  return limb.flexion * limb.axis.cross(limb.end - limb.bend).normalized();
}

class LimbFinder {
 public:
  LimbFinder(const Robot& robot, std::string file)
      : robot_(robot),
        file_(std::move(file)),
        reference_(reference_configuration(robot)),
        posed_(robot.tree(), reference_) {}

  Result<RobotAnatomy> find();

 private:
  void find_facing();
  [[nodiscard]] double foot_vote(const Eigen::Vector3d& forward) const;
  [[nodiscard]] std::optional<double> outward_angle(const LimbShape& leg, double side) const;
  [[nodiscard]] double toe_out() const;
  [[nodiscard]] Limb limb_of(const LimbShape& shape, bool is_leg) const;
  void set_end(Limb& limb, const LimbShape& shape, bool is_leg) const;
  [[nodiscard]] Eigen::Matrix3d in_body(int body, const Eigen::Matrix3d& world_from_bone) const;
  [[nodiscard]] std::optional<LimbPart> head() const;
  [[nodiscard]] double foot_tilt_degrees() const;
  [[nodiscard]] Result<void> check_lean() const;
  [[nodiscard]] Failure no_ankles() const;
  [[nodiscard]] int body_of(int link) const { return robot_.tree().links()[link].body; }

  const Robot& robot_;
  std::string file_;
  std::vector<double> reference_;
  TreeState posed_;
  ShapedPair legs_, arms_;
  double lean_ = 0.0;  // LimbPairs::lean.
  RobotAnatomy found_;
};

// Returns the extent of the feet ahead of the ankles minus that behind them, relative to their
// size.
double LimbFinder::foot_vote(const Eigen::Vector3d& forward) const {
  double vote = 0.0;
  for (const LimbShape& leg : legs_.limbs) {
    const int foot = robot_.joints()[leg.joints.back()].body;
    double ahead = 0.0;
    double behind = 0.0;
    for (const Eigen::Vector3d& point : outline_points(robot_, posed_, foot)) {
      const double x = (point - leg.end).dot(forward);
      ahead = std::max(ahead, x);
      behind = std::max(behind, -x);
    }
    if (ahead + behind > 1e-6) vote += (ahead - behind) / (ahead + behind);
  }
  return vote;
}

void LimbFinder::find_facing() {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d& across = (found_.has_legs ? legs_ : arms_).pair.across;
  const Eigen::Vector3d forward = across.cross(up);
  // Each pair has its own direction across, and the two may be opposite. Names can only be added if
  // arms and legs are in the same order.
  if ((arms_.limbs[0].root - arms_.limbs[1].root).dot(across) < 0.0) {
    std::swap(arms_.limbs[0], arms_.limbs[1]);
  }
  // A positive vote means that the first branches are the left ones.
  double votes = 0.25 * (forward.x() + forward.y());
  const double names = side_by_names(robot_, legs_.limbs) + side_by_names(robot_, arms_.limbs);
  votes += names > 0.0 ? 2.0 : (names < 0.0 ? -2.0 : 0.0);
  if (found_.has_legs) {
    for (const LimbShape& leg : legs_.limbs) votes -= 1.5 * motion_of_bending(leg).dot(forward);
    votes += foot_vote(forward);
  }
  for (const LimbShape& arm : arms_.limbs) votes += 0.5 * motion_of_bending(arm).dot(forward);
  const double sign = votes >= 0.0 ? 1.0 : -1.0;
  found_.forward = sign * forward;
  found_.left = sign * across;
  found_.facing_is_sure = std::abs(votes) > 1.0;
  if (sign * names < 0.0) {
    found_.notes.emplace_back(found_.has_legs
                                  ? "the limbs on the robot's left side are named right: the "
                                    "facing direction comes from knees and feet"
                                  : "the arms on the robot's left side are named right: the facing "
                                    "direction comes from the elbows");
  }
  if (!found_.facing_is_sure) {
    found_.notes.emplace_back(
        found_.has_legs ? "knees, feet and names hardly determine the robot's facing direction"
                        : "elbows and names hardly determine the robot's facing direction");
  }
  if (sign < 0.0) {
    std::swap(legs_.limbs[0], legs_.limbs[1]);
    std::swap(arms_.limbs[0], arms_.limbs[1]);
  }
}

// The angle, radians, by which the long axis of a foot's outline points away from the other foot;
// nothing if the outline is not long.
// @param side  1: left, -1: right.
std::optional<double> LimbFinder::outward_angle(const LimbShape& leg, double side) const {
  constexpr double kLong = 1.7;  // Length over width.
  const int foot = robot_.joints()[leg.joints.back()].body;
  std::vector<Eigen::Vector2d> points;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const Eigen::Vector3d& point : outline_points(robot_, posed_, foot)) {
    points.emplace_back(point.dot(found_.forward), side * point.dot(found_.left));
    centre += points.back();
  }
  centre /= static_cast<double>(points.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& point : points) {
    spread += (point - centre) * (point - centre).transpose();
  }
  const double along = spread(0, 0) - spread(1, 1), across = 2.0 * spread(0, 1);
  const double difference = std::sqrt(along * along + across * across), sum = spread.trace();
  if (!(sum + difference > kLong * kLong * (sum - difference))) return std::nullopt;
  return 0.5 * portable::atan2(across, along);
}

// The angle, radians, by which both feet point outwards in the zero configuration; 0 unless their
// outlines are long and clearly turned like mirror images.
double LimbFinder::toe_out() const {
  constexpr double kClearly = 5.0 * std::numbers::pi / 180.0;
  constexpr double kAlike = 3.0 * std::numbers::pi / 180.0;
  constexpr double kMost = std::numbers::pi / 3.0;
  const auto left = outward_angle(legs_.limbs[0], 1.0), right = outward_angle(legs_.limbs[1], -1.0);
  if (!left || !right || std::abs(*left - *right) > kAlike) return 0.0;
  const double mean = 0.5 * (*left + *right);
  return std::abs(mean) > kClearly && std::abs(mean) < kMost ? mean : 0.0;
}

Eigen::Matrix3d LimbFinder::in_body(int body, const Eigen::Matrix3d& world_from_bone) const {
  return posed_.world_from_body(body).rotation.toRotationMatrix().transpose() * world_from_bone;
}

void LimbFinder::set_end(Limb& limb, const LimbShape& shape, bool is_leg) const {
  const std::size_t beyond =
      shape.joints.size() - 1 - static_cast<std::size_t>(shape.middle) - shape.at_end;
  limb.end_joints = static_cast<int>(beyond);
  if (beyond == 0 && (is_leg || !shape.end_body)) return;
  LimbPart end;
  end.body = shape.end_body.value_or(robot_.joints()[shape.joints.back()].body);
  Eigen::Matrix3d world_from_bone;
  if (is_leg) {
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    const double side = (shape.root - legs_.limbs[0].root).dot(found_.left) < -1e-9 ? -1.0 : 1.0;
    const double angle = side * toe_out();
    const auto [sine, cosine] = portable::sin_cos(angle);
    world_from_bone << cosine * found_.forward + sine * found_.left, up,
        sine * found_.forward - cosine * found_.left;
  } else {
    world_from_bone = posed_.world_from_body(limb.lower.body).rotation.toRotationMatrix() *
                      limb.lower.body_from_bone;
  }
  end.body_from_bone = in_body(end.body, world_from_bone);
  end.joint = posed_.world_from_body(end.body).inverse() * shape.end;
  if (is_leg) {
    const double leg_length = limb.upper_length + limb.lower_length;
    const auto balls = foot_balls(contact_shapes(robot_), posed_, end.body);
    end.body_from_bone =
        foot_tilt(balls, end.body_from_bone, leg_length).toRotationMatrix() * end.body_from_bone;
  }
  limb.end = end;
}

Limb LimbFinder::limb_of(const LimbShape& shape, bool is_leg) const {
  Limb limb;
  limb.joints = shape.joints;
  limb.middle = shape.middle;
  limb.clarity = shape.clarity;
  limb.straight = shape.straight;
  limb.lower_is_estimated = shape.end_is_estimated;
  limb.flexion_is_sure = shape.flexion != 0.0;
  limb.flexion = shape.flexion;
  if (!limb.flexion_is_sure) {
    // Knees bend the shin backwards, elbows bend the forearm forwards.
    const double swing = shape.axis.cross(shape.end - shape.bend).dot(found_.forward);
    limb.flexion = (swing > 0.0) == is_leg ? -1.0 : 1.0;
  }
  const Eigen::Vector3d z = -limb.flexion * shape.axis;
  const auto bone = [&](const Eigen::Vector3d& x) {
    Eigen::Matrix3d axes;
    axes << x, z.cross(x), z;
    return axes;
  };
  const auto body_at = [&](std::size_t joint) { return robot_.joints()[shape.joints[joint]].body; };
  const auto middle = static_cast<std::size_t>(shape.middle);
  limb.lower.body = body_at(middle + shape.at_end);
  limb.upper.body = robot_.tree().carrier(robot_.bodies()[body_at(middle - shape.at_root)].parent);
  limb.upper.body_from_bone = in_body(limb.upper.body, bone(shape.upper()));
  limb.upper.joint = posed_.world_from_body(limb.upper.body).inverse() * shape.root;
  limb.lower.body_from_bone = in_body(limb.lower.body, bone(shape.lower()));
  limb.lower.joint = posed_.world_from_body(limb.lower.body).inverse() * shape.bend;
  limb.upper_length = (shape.bend - shape.root).norm();
  limb.lower_length = (shape.end - shape.bend).norm();
  set_end(limb, shape, is_leg);
  return limb;
}

// Returns the branch of the trunk, other than a limb, that reaches highest above the shoulders.
std::optional<LimbPart> LimbFinder::head() const {
  const double shoulders = 0.5 * (arms_.limbs[0].root + arms_.limbs[1].root).z();
  std::optional<LimbPart> best;
  double highest = shoulders;
  for (const int trunk : {arms_.pair.parent, legs_.pair.parent}) {
    for (const int child : robot_.tree().children(trunk)) {
      const bool is_limb = child == legs_.pair.first || child == legs_.pair.second ||
                           child == arms_.pair.first || child == arms_.pair.second;
      const std::vector<int> chain = joint_chain(robot_, child);
      if (is_limb || chain.empty() || chain.size() > 3) continue;
      const int body = robot_.joints()[chain.back()].body;
      const double height = posed_.world_from_body(body).translation.z();
      if (height <= highest) continue;
      highest = height;
      Eigen::Matrix3d upright;
      upright << Eigen::Vector3d::UnitZ(), found_.forward, found_.left;
      best = LimbPart{body, in_body(body, upright), Eigen::Vector3d::Zero()};
    }
  }
  return best;
}

// Returns the angle by which the feet are off level in the zero configuration; 0 without legs.
double LimbFinder::foot_tilt_degrees() const {
  double largest = 0.0;
  for (const Limb& leg : found_.legs) {
    if (!leg.end) continue;
    const Eigen::Vector3d up =
        posed_.world_from_body(leg.end->body).rotation * leg.end->body_from_bone.col(1);
    largest = std::max(largest, angle_between(up, Eigen::Vector3d::UnitZ()));
  }
  return largest * (180.0 / std::numbers::pi);
}

// A robot that leans far is accepted if its limbs and facing are unambiguous.
Result<void> LimbFinder::check_lean() const {
  constexpr double kFar = 40.0;
  if (lean_ <= kFar || (found_.doubts.empty() && found_.facing_is_sure)) return {};
  return config_failure(
      file_,
      fmt::format("the trunk leans by {} degrees in the zero configuration, and {}",
                  number_text(lean_, 0),
                  found_.doubts.empty() ? "the robot's facing direction is uncertain"
                                        : found_.doubts.front()),
      "turn the root body so that the robot stands upright along z");
}

// A slide ends the joints of a limb, so an ankle behind it is not found.
Failure LimbFinder::no_ankles() const {
  for (const int first : {legs_.pair.first, legs_.pair.second}) {
    const auto slide = first_slide(robot_, first);
    if (!slide) continue;
    return config_failure(
        file_,
        fmt::format("the leg starting at \"{}\" has a slide, \"{}\", before its end: the joints of "
                    "a leg up to the ankle must be hinges",
                    robot_.bodies()[body_of(first)].name, robot_.joints()[*slide].name),
        "remove the slide, or replace it with the hinge that it drives");
  }
  return no_legs_failure(file_, "the legs have no ankle joints (a stand or wheels?)");
}

Result<RobotAnatomy> LimbFinder::find() {
  TRY_ASSIGN(const LimbPairs pairs, find_limb_pairs(robot_, posed_, reference_, file_));
  legs_ = pairs.legs;
  arms_ = pairs.arms;
  lean_ = pairs.lean;
  found_.has_legs = !robot_.fixed_base();
  TRY(check_joint_counts(robot_, file_, legs_.limbs));
  TRY(check_joint_counts(robot_, file_, arms_.limbs));
  find_facing();
  if (found_.has_legs) TRY(compare_flexion(robot_, file_, true, legs_.limbs, found_));
  TRY(compare_flexion(robot_, file_, false, arms_.limbs, found_));
  found_.pelvis = found_.has_legs ? body_of(legs_.pair.parent) : robot_.root_body();
  found_.torso = body_of(arms_.pair.parent);
  Eigen::Matrix3d upright;
  upright << Eigen::Vector3d::UnitZ(), found_.forward, found_.left;
  found_.pelvis_from_hips = in_body(found_.pelvis, upright);
  found_.torso_from_spine2 = in_body(found_.torso, upright);
  for (std::size_t side = 0; side < 2; ++side) {
    if (found_.has_legs) found_.legs[side] = limb_of(legs_.limbs[side], true);
    found_.arms[side] = limb_of(arms_.limbs[side], false);
  }
  if (found_.has_legs && (!found_.legs[0].end || !found_.legs[1].end)) {
    return no_ankles();
  }
  found_.head = head();
  note_limbs(robot_, {lean_, foot_tilt_degrees(), legs_.limbs[0].toe}, found_);
  doubt_limbs(robot_, found_);
  TRY(check_lean());
  doubt_sides(found_);
  return found_;
}

}  // namespace

std::vector<double> reference_configuration(const Robot& robot) {
  std::vector<double> qpos = robot.zero_configuration();
  const LimitSet& limits = robot.model_limits();
  for (std::size_t j = 0; j < robot.joints().size(); ++j) {
    double& position = qpos[robot.joints()[j].qpos_address];
    position = std::clamp(position, limits.lower[j], limits.upper[j]);
  }
  return qpos;
}

Result<RobotAnatomy> find_limbs(const Robot& robot, const std::string& file) {
  return LimbFinder(robot, file).find();
}

}  // namespace retarget
