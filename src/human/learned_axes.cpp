#include "human/learned_axes.h"

#include <algorithm>
#include <utility>

#include "human/canonical_pose.h"

namespace retarget {
namespace {

using enum LimbBone;

constexpr double kUpright = 0.90630778703664996;  // cosine of 25 degrees
// mean sine of the bend below which a hinge is not known
constexpr double kMinBend = 0.1;

// cosine of 20 degrees: people's habits account for less
constexpr double kPlainlyOff = 0.93969262078590838;

// how far the bending normal stands off -Z, cosine and sine
struct Bias {
  double cosine = 1.0;
  double sine = 0.0;
};
constexpr Bias kUpperArmBias = {0.97437006478523525, 0.22495105434386500};  // 13 degrees
constexpr Bias kForearmBias = {0.98480775301220802, 0.17364817766693033};   // 10 degrees
constexpr Bias kHandBias = {0.78801075360672201, 0.61566147532565829};      // 38 degrees

// axes from an exact first direction and one to be made square to it; nothing when they agree
Eigen::Matrix3d square(const Eigen::Vector3d& first, const Eigen::Vector3d& second, int first_axis,
                       int second_axis) {
  Eigen::Matrix3d axes;
  const Eigen::Vector3d a = first.normalized();
  const Eigen::Vector3d b = (second - second.dot(a) * a).normalized();
  const int third = 3 - first_axis - second_axis;
  axes.col(first_axis) = a;
  axes.col(second_axis) = b;
  const bool cyclic = (first_axis + 1) % 3 == second_axis;
  axes.col(third) = cyclic ? a.cross(b) : b.cross(a);
  return axes;
}

bool are_apart(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return a.cross(b).norm() > 0.1 * a.norm() * b.norm() && a.norm() > 0.0;
}

class Learner {
 public:
  Learner(const Body& body, const std::vector<JointPoses>& poses, const Eigen::Vector3d& up,
          JointFromBone start)
      : body_(body), poses_(poses), up_(up), axes_(std::move(start)) {
    for (const JointPoses& pose : poses) {
      const auto trunk = trunk_direction(body, pose);
      if (trunk && trunk->dot(up) > kUpright) upright_.push_back(&pose);
    }
  }

  JointFromBone learn() {
    learn_trunk();
    for (const Side side : kSides) {
      const double sign = side == Side::kLeft ? 1.0 : -1.0;
      learn_collar(side, sign);
      learn_arm(side, sign);
      learn_hinge(side, kUpLeg, kLeg, kUpLeg, {}, sign);
      learn_hinge(side, kUpLeg, kLeg, kLeg, {}, sign);
      learn_foot(side);
    }
    return axes_;
  }

  // arms that the movement plainly bends another way than the start has it
  JointFromBone correct_arms() {
    const JointFromBone start = axes_;
    for (const Side side : kSides) {
      learn_arm(side, side == Side::kLeft ? 1.0 : -1.0);
      const auto& before = start[side_bone(side, kArm)];
      const auto& after = axes_[side_bone(side, kArm)];
      if (before && after && before->col(2).dot(after->col(2)) < kPlainlyOff) continue;
      for (const LimbBone part : {kArm, kForeArm, kHand}) {
        axes_[side_bone(side, part)] = start[side_bone(side, part)];
      }
    }
    return axes_;
  }

 private:
  // mean of a direction of the world as the joint sees it
  template <typename Direction>
  [[nodiscard]] Eigen::Vector3d mean(int joint, const Direction& direction) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const JointPoses& pose : poses_) {
      sum += pose[joint].rotation.conjugate() * Eigen::Vector3d(direction(pose));
    }
    return sum / static_cast<double>(poses_.size());
  }
  [[nodiscard]] Eigen::Vector3d mean_vertical_upright(int joint) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const JointPoses* pose : upright_) sum += (*pose)[joint].rotation.conjugate() * up_;
    return sum;
  }
  [[nodiscard]] Eigen::Vector3d mean_course(int joint, const Segment& segment) const {
    return mean(joint, [&](const JointPoses& pose) {
      const auto way = along(segment, pose);
      return way ? Eigen::Vector3d(way->normalized()) : Eigen::Vector3d(0, 0, 0);
    });
  }
  // from the right to the left one of a pair
  [[nodiscard]] Eigen::Vector3d mean_line(int joint, LimbBone part) const {
    const int left = body_.joint(side_bone(Side::kLeft, part));
    const int right = body_.joint(side_bone(Side::kRight, part));
    if (left < 0 || right < 0) return Eigen::Vector3d::Zero();
    return mean(joint, [&](const JointPoses& pose) {
      return (pose[left].translation - pose[right].translation).normalized();
    });
  }

  void set(Bone bone, const Eigen::Vector3d& first, const Eigen::Vector3d& second, int first_axis,
           int second_axis) {
    if (!are_apart(first, second)) return;
    axes_[bone] = square(first, second, first_axis, second_axis);
  }

  void learn_trunk() {
    const int hips = body_.turning_joint(Bone::kHips);
    set(Bone::kHips, mean_line(hips, kUpLeg), mean_vertical_upright(hips), 2, 0);
    for (const Bone bone : {Bone::kSpine, Bone::kSpine1, Bone::kSpine2, Bone::kNeck}) {
      const int joint = body_.turning_joint(bone);
      const Segment& segment = body_.segment(bone);
      // a spine that ends at a joint's child of unknown meaning has no known course
      if (joint < 0 || !segment.known() || segment.end_joint == segment.joint) continue;
      set(bone, mean_course(joint, segment), mean_line(joint, kArm), 0, 2);
    }
    if (const int head = body_.turning_joint(Bone::kHead); head >= 0) {
      set(Bone::kHead, mean_vertical_upright(head), mean_line(head, kArm), 0, 2);
    }
  }

  void learn_collar(Side side, double sign) {
    const Bone clavicle = side_bone(side, kShoulder);
    const int joint = body_.turning_joint(clavicle);
    if (joint < 0 || !body_.has(Bone::kSpine2)) return;
    set(clavicle, mean_course(joint, body_.segment(clavicle)),
        sign * mean_course(joint, body_.segment(Bone::kSpine2)), 0, 2);
  }

  void learn_arm(Side side, double sign) {
    learn_hinge(side, kArm, kForeArm, kArm, kUpperArmBias, sign);
    learn_hinge(side, kArm, kForeArm, kForeArm, kForearmBias, sign);
    learn_hinge(side, kArm, kForeArm, kHand, kHandBias, sign);
  }

  // Z of a part from the bend between the bones `upper_part` and `lower_part`
  void learn_hinge(Side side, LimbBone upper_part, LimbBone lower_part, LimbBone part,
                   const Bias& bias, double sign) {
    const Bone upper = side_bone(side, upper_part), lower = side_bone(side, lower_part);
    const Bone bone = side_bone(side, part);
    const int joint = body_.turning_joint(bone);
    if (joint < 0 || !body_.has(upper) || !body_.has(lower)) return;
    const Eigen::Vector3d normal = mean(joint, [&](const JointPoses& pose) {
      const auto a = along(body_.segment(upper), pose), b = along(body_.segment(lower), pose);
      return a && b ? Eigen::Vector3d(a->normalized().cross(b->normalized()))
                    : Eigen::Vector3d(0, 0, 0);
    });
    // a hand's neutral direction is the forearm's
    const Eigen::Vector3d course = mean_course(joint, body_.segment(part == kHand ? lower : bone));
    if (normal.norm() < kMinBend || !are_apart(course, normal)) return;
    const Eigen::Matrix3d hinge = square(course, normal, 0, 2);
    const Eigen::Vector3d x = hinge.col(0), n = hinge.col(2);
    const Eigen::Vector3d z = -bias.cosine * n - sign * bias.sine * x.cross(n);
    axes_[bone] = square(x, z, 0, 2);
  }

  void learn_foot(Side side) {
    const Bone foot_bone = side_bone(side, kFoot), toe_bone = side_bone(side, kToe);
    const int foot = body_.joint(foot_bone);
    if (foot < 0) return;
    const bool has_toe = body_.turning_joint(toe_bone) >= 0;
    const int toe = has_toe ? body_.turning_joint(toe_bone) : foot;
    Eigen::Vector3d vertical = Eigen::Vector3d::Zero(), heading = Eigen::Vector3d::Zero();
    for (const JointPoses* pose : flat_frames(side)) {
      const auto way = foot_direction(side, *pose);
      if (!way) continue;
      vertical += (*pose)[toe].rotation.conjugate() * up_;
      heading += (*pose)[toe].rotation.conjugate() * way->normalized();
    }
    if (!are_apart(vertical, heading)) return;
    const Eigen::Matrix3d level = square(vertical, heading, 1, 0);
    if (!has_toe) {
      // the foot's joint in the pose in which a toe would be level
      axes_[foot_bone] =
          level * canonical_t_pose(toe_bone).transpose() * canonical_t_pose(foot_bone);
      return;
    }
    axes_[toe_bone] = level;
    const Eigen::Vector3d lateral =
        mean(foot, [&](const JointPoses& pose) { return pose[toe].rotation * level.col(2); });
    set(foot_bone, mean_course(foot, body_.segment(foot_bone)), lateral, 0, 2);
  }

  // of an ankle without toes, where the body faces
  [[nodiscard]] std::optional<Eigen::Vector3d> foot_direction(Side side,
                                                              const JointPoses& pose) const {
    const Segment& foot = body_.segment(side_bone(side, kFoot));
    if (foot.known()) return along(foot, pose);
    const auto axes = body_axes(body_, pose, up_);
    return axes ? std::optional<Eigen::Vector3d>(axes->row(0)) : std::nullopt;
  }

  // poses in which the ankle is as low as ankles on the floor, under an upright shin
  [[nodiscard]] std::vector<const JointPoses*> flat_frames(Side side) const {
    const int ankle = body_.joint(side_bone(side, kFoot));
    std::vector<double> heights;
    for (const JointPoses& pose : poses_) heights.push_back(up_.dot(pose[ankle].translation));
    std::vector<double> sorted = heights;
    const auto tenth = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 10);
    std::ranges::nth_element(sorted, tenth);
    std::vector<const JointPoses*> flat;
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const auto shin = along(body_.segment(side_bone(side, kLeg)), poses_[i]);
      // 3 cm on an adult
      const double limit = *tenth + 0.07 * (shin ? shin->norm() : 0.0);
      const bool stands = !shin || shin->normalized().dot(-up_) > kUpright;
      if (stands && heights[i] <= limit) flat.push_back(&poses_[i]);
    }
    return flat;
  }

  const Body& body_;
  const std::vector<JointPoses>& poses_;
  Eigen::Vector3d up_;
  std::vector<const JointPoses*> upright_;
  JointFromBone axes_;
};

}  // namespace

JointFromBone learned_axes(const Body& body, const std::vector<JointPoses>& poses,
                           const Eigen::Vector3d& up, const RestCandidate& best) {
  return Learner(body, poses, up, bring_to_t(body, best)).learn();
}

JointFromBone with_corrected_arms(const Body& body, const std::vector<JointPoses>& poses,
                                  const Eigen::Vector3d& up, JointFromBone axes) {
  return Learner(body, poses, up, std::move(axes)).correct_arms();
}

}  // namespace retarget
