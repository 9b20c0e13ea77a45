#include "human/skeleton/learned_axes.h"

#include <cmath>
#include <initializer_list>
#include <utility>

#include "human/skeleton/movement_means.h"
#include "retarget/human_skeleton.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

using enum LimbBone;

// Mean sine of the bend below which a hinge axis is unknown.
constexpr double kMinBend = 0.1;

// Cosine of 20 degrees, more than human habits explain.
constexpr double kPlainlyOff = 0.93969262078590838;

// Expected errors of learned axes in degrees, measured on LAFAN1's clips: of a standing body or
// foot, of axes that follow from the build of the body, of the habits of arms, of a hinge whose bends
// have a mean sine of 1, and of axes that are not learned.
constexpr double kErrorOfStanding = 6.0, kErrorOfBuild = 10.0, kErrorOfHabit = 9.0;
constexpr double kErrorOfHinge = 2.0, kErrorOfGuess = 40.0;
// Maximum expected error of a hinge that overrides a rest pose.
constexpr double kCertain = 10.0;

// Angle between the bending normal and -Z, as cosine and sine.
struct Bias {
  double cosine = 1.0;
  double sine = 0.0;
};
constexpr Bias kUpperArmBias = {0.97437006478523525, 0.22495105434386500};  // 13 degrees
constexpr Bias kForearmBias = {0.98480775301220802, 0.17364817766693033};   // 10 degrees
constexpr Bias kHandBias = {0.78801075360672201, 0.61566147532565829};      // 38 degrees

Bias habit_of(Bone bone) {
  switch (limb_bone(bone).value_or(kUpLeg)) {
    case kArm:
      return kUpperArmBias;
    case kForeArm:
      return kForearmBias;
    case kHand:
      return kHandBias;
    default:
      return {};
  }
}

// Makes axes from an exact first direction and a second one that is orthogonalised against it. The
// directions must not be parallel.
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
      : body_(body), means_(body, poses, up), axes_(std::move(start)) {}

  LearnedAxes learn() {
    learn_trunk();
    for (const Side side : kSides) {
      const double sign = side == Side::kLeft ? 1.0 : -1.0;
      learn_collar(side, sign);
      learn_arm(side);
      straighten_elbow(side);
      learn_leg(side);
      learn_foot(side);
    }
    return {axes_, error_};
  }

  // Corrects the arms that clearly bend about another axis than in the start.
  JointFromBone correct_arms() {
    const JointFromBone start = axes_;
    for (const Side side : kSides) {
      learn_arm(side);
      if (is_plainly_off(start, side_bone(side, kArm))) continue;
      keep(start, side, {kArm, kForeArm, kHand});
    }
    return axes_;
  }

  // Toe axes of a foot that stands flat in a sufficient number of poses.
  [[nodiscard]] std::optional<Eigen::Matrix3d> standing_axes(Side side) const {
    constexpr std::size_t kMinFlat = 5;
    const int toe = toe_joint(side);
    return toe < 0 ? std::nullopt : level_axes(side, toe, kMinFlat);
  }

  // The axes with the feet that the movement shows.
  JointFromBone with_foot(Side side) {
    learn_foot(side);
    return axes_;
  }

  // Corrects the legs in the same way and keeps the feet.
  JointFromBone correct_legs() {
    const JointFromBone start = axes_;
    for (const Side side : kSides) {
      learn_leg(side);
      const bool bends = error_[side_bone(side, kUpLeg)] < kCertain;
      if (bends && is_plainly_off(start, side_bone(side, kUpLeg)) &&
          is_plainly_off(start, side_bone(side, kLeg))) {
        continue;
      }
      keep(start, side, {kUpLeg, kLeg});
    }
    return axes_;
  }

 private:
  [[nodiscard]] bool is_plainly_off(const JointFromBone& start, Bone bone) const {
    const auto &before = start[bone], &after = axes_[bone];
    return before && after && before->col(2).dot(after->col(2)) < kPlainlyOff;
  }
  void keep(const JointFromBone& start, Side side, std::initializer_list<LimbBone> parts) {
    for (const LimbBone part : parts) axes_[side_bone(side, part)] = start[side_bone(side, part)];
  }

  void set(Bone bone, const Eigen::Vector3d& first, const Eigen::Vector3d& second, int first_axis,
           int second_axis, double error) {
    if (!are_apart(first, second)) return;
    axes_[bone] = square(first, second, first_axis, second_axis);
    error_[bone] = error;
  }
  void learn_hips() {
    const int hips = body_.turning_joint(Bone::kHips);
    const Eigen::Vector3d line = means_.line(hips, kUpLeg);
    const Eigen::Vector3d above = means_.lower_trunk(hips);
    if (means_.shows_upright() || above.isZero()) {
      set(Bone::kHips, line, means_.vertical_upright(hips), 2, 0, kErrorOfStanding);
    } else {
      set(Bone::kHips, line, above, 2, 0, kErrorOfBuild);
    }
  }

  void learn_head() {
    const int head = body_.turning_joint(Bone::kHead);
    const int torso = body_.turning_joint(Bone::kSpine2);
    const auto& torso_axes = axes_[Bone::kSpine2];
    if (head < 0) return;
    Eigen::Vector3d above = means_.vertical_upright(head);
    if (!means_.shows_upright() && torso >= 0 && torso_axes) {
      above = means_.mean(head, [&](const JointPoses& pose) {
        return Eigen::Vector3d(pose[torso].rotation * torso_axes->col(0));
      });
    }
    set(Bone::kHead, above, means_.line(head, kArm), 0, 2, kErrorOfBuild);
  }

  void learn_trunk() {
    learn_hips();
    for (const Bone bone : {Bone::kSpine, Bone::kSpine1, Bone::kSpine2, Bone::kNeck}) {
      const int joint = body_.turning_joint(bone);
      const Segment& segment = body_.segment(bone);
      // The direction of a spine that ends at an unmapped child is unknown.
      if (joint < 0 || !segment.known() || segment.end_joint == segment.joint) continue;
      set(bone, means_.course(joint, segment), means_.line(joint, kArm), 0, 2, kErrorOfStanding);
    }
    learn_head();
  }

  void learn_collar(Side side, double sign) {
    const Bone clavicle = side_bone(side, kShoulder);
    const int joint = body_.turning_joint(clavicle);
    if (joint < 0 || !body_.has(Bone::kSpine2)) return;
    set(clavicle, means_.course(joint, body_.segment(clavicle)),
        sign * means_.course(joint, body_.segment(Bone::kSpine2)), 0, 2, kErrorOfBuild);
  }

  void learn_leg(Side side) {
    learn_hinge(side, kUpLeg, kLeg, kUpLeg);
    learn_hinge(side, kUpLeg, kLeg, kLeg);
  }

  void learn_arm(Side side) {
    learn_hinge(side, kArm, kForeArm, kArm);
    learn_hinge(side, kArm, kForeArm, kForeArm);
    learn_hinge(side, kArm, kForeArm, kHand);
  }

  // No pose shows the direction of a forearm without a length. In the zero pose of nearly all
  // skeletons the elbow is straight, even where the pose as a whole is not human.
  void straighten_elbow(Side side) {
    const Bone arm = side_bone(side, kArm), forearm = side_bone(side, kForeArm);
    if (body_.turning_joint(forearm) < 0 || along(body_.segment(forearm), means_.poses().front()))
      return;
    const auto& of_arm = axes_[arm];
    if (!of_arm) return;
    axes_[forearm] = *of_arm * canonical_t_pose(arm).transpose() * canonical_t_pose(forearm);
  }

  // Learns Z of a part from the bend between the bones `upper_part` and `lower_part`.
  void learn_hinge(Side side, LimbBone upper_part, LimbBone lower_part, LimbBone part) {
    const Bone upper = side_bone(side, upper_part), lower = side_bone(side, lower_part);
    const Bone bone = side_bone(side, part);
    const int joint = body_.turning_joint(bone);
    if (joint < 0 || !body_.has(upper) || !body_.has(lower)) return;
    const Eigen::Vector3d normal = means_.mean(joint, [&](const JointPoses& pose) {
      const auto a = along(body_.segment(upper), pose), b = along(body_.segment(lower), pose);
      return a && b ? Eigen::Vector3d(a->normalized().cross(b->normalized()))
                    : Eigen::Vector3d(0, 0, 0);
    });
    // The neutral direction of a hand is the direction of the forearm.
    const Eigen::Vector3d course =
        means_.course(joint, body_.segment(part == kHand ? lower : bone));
    if (normal.norm() < kMinBend || !are_apart(course, normal)) return;
    const Eigen::Matrix3d hinge = square(course, normal, 0, 2);
    const Eigen::Vector3d x = hinge.col(0);
    axes_[bone] = square(x, canonical_z(bone, x, hinge.col(2)), 0, 2);
    const double of_habit = part == kUpLeg || part == kLeg ? 0.0 : kErrorOfHabit;
    const double of_hinge = kErrorOfHinge / normal.norm();
    error_[bone] = std::sqrt(of_habit * of_habit + of_hinge * of_hinge);
  }

  // The joint that rotates the sole; -1 without a foot.
  [[nodiscard]] int toe_joint(Side side) const {
    const int foot = body_.joint(side_bone(side, kFoot));
    const int toe = body_.turning_joint(side_bone(side, kToe));
    return foot < 0 || toe < 0 ? foot : toe;
  }

  // Axes of a flat foot, from the vertical and from its direction, in at least `min_flat` poses.
  [[nodiscard]] std::optional<Eigen::Matrix3d> level_axes(Side side, int toe,
                                                          std::size_t min_flat = 1) const {
    Eigen::Vector3d vertical = Eigen::Vector3d::Zero(), heading = Eigen::Vector3d::Zero();
    const std::vector<const JointPoses*> flat = means_.flat_poses(side);
    if (flat.size() < min_flat) return std::nullopt;
    for (const JointPoses* pose : flat) {
      const auto way = means_.foot_direction(side, *pose);
      if (!way) continue;
      vertical += (*pose)[toe].rotation.conjugate() * means_.up();
      heading += (*pose)[toe].rotation.conjugate() * way->normalized();
    }
    if (!are_apart(vertical, heading)) return std::nullopt;
    return square(vertical, heading, 1, 0);
  }

  // Axes of a foot that never stands: it points along its bone and bends about the knee's axis.
  [[nodiscard]] std::optional<Eigen::Matrix3d> axes_under_shin(Side side, int toe) const {
    const Bone foot_bone = side_bone(side, kFoot), toe_bone = side_bone(side, kToe);
    const Bone shin = side_bone(side, kLeg);
    const int knee = body_.turning_joint(shin);
    const auto& shin_axes = axes_[shin];
    if (knee < 0 || !shin_axes) return std::nullopt;
    const Eigen::Vector3d lateral = means_.mean(toe, [&](const JointPoses& pose) {
      return Eigen::Vector3d(pose[knee].rotation * shin_axes->col(2));
    });
    // Toes may be bent, so their own direction is better than that of the foot.
    const bool has_toes = body_.turning_joint(toe_bone) == toe && body_.segment(toe_bone).known();
    const Bone pointing = has_toes ? toe_bone : foot_bone;
    if (!body_.segment(pointing).known()) return std::nullopt;
    const Eigen::Vector3d course = means_.course(toe, body_.segment(pointing));
    if (!are_apart(course, lateral)) return std::nullopt;
    return square(course, lateral, 0, 2) * canonical_t_pose(pointing).transpose() *
           canonical_t_pose(toe_bone);
  }

  void learn_foot(Side side) {
    const Bone foot_bone = side_bone(side, kFoot), toe_bone = side_bone(side, kToe);
    const int foot = body_.joint(foot_bone);
    if (foot < 0) return;
    const bool has_toe = body_.turning_joint(toe_bone) >= 0;
    const int toe = toe_joint(side);
    auto level = level_axes(side, toe);
    const double error = level ? kErrorOfStanding : kErrorOfBuild;
    // In an upright body, the foot of the best frame is closer than one that is built.
    if (!level && !means_.shows_upright()) level = axes_under_shin(side, toe);
    if (level || means_.shows_upright()) error_[foot_bone] = error_[toe_bone] = error;
    if (!level) return;
    if (!has_toe) {
      // Choose the foot's axes such that a toe would be level.
      axes_[foot_bone] =
          *level * canonical_t_pose(toe_bone).transpose() * canonical_t_pose(foot_bone);
      return;
    }
    axes_[toe_bone] = level;
    const Eigen::Vector3d lateral = means_.mean(
        foot, [&](const JointPoses& pose) { return pose[toe].rotation * level->col(2); });
    set(foot_bone, means_.course(foot, body_.segment(foot_bone)), lateral, 0, 2, error);
  }

  const Body& body_;
  MovementMeans means_;
  JointFromBone axes_;
  BoneArray<double> error_{kErrorOfGuess};
};

}  // namespace

Eigen::Vector3d canonical_z(Bone bone, const Eigen::Vector3d& x, const Eigen::Vector3d& normal) {
  const Bias bias = habit_of(bone);
  const double sign = side_of(bone) == Side::kLeft ? 1.0 : -1.0;
  return -bias.cosine * normal - sign * bias.sine * x.cross(normal);
}

bool LearnedAxes::is_learned(Bone bone) const {
  return error[bone] < kErrorOfGuess;
}

LearnedAxes learned_axes(const Body& body, const std::vector<JointPoses>& poses,
                         const Eigen::Vector3d& up, const RestCandidate& best) {
  return Learner(body, poses, up, bring_to_t(body, best)).learn();
}

JointFromBone with_corrected_arms(const Body& body, const std::vector<JointPoses>& poses,
                                  const Eigen::Vector3d& up, JointFromBone axes) {
  return Learner(body, poses, up, std::move(axes)).correct_arms();
}

JointFromBone with_corrected_legs(const Body& body, const std::vector<JointPoses>& poses,
                                  const Eigen::Vector3d& up, JointFromBone axes) {
  return Learner(body, poses, up, std::move(axes)).correct_legs();
}

SoleCheck::SoleCheck(const Body& body, const std::vector<JointPoses>& poses,
                     const Eigen::Vector3d& up)
    : body_(body), poses_(poses), up_(up) {
  if (poses.empty()) return;
  const Learner learner(body, poses, up, {});
  for (std::size_t i = 0; i < 2; ++i) level_[i] = learner.standing_axes(kSides[i]);
}

std::optional<double> SoleCheck::error_of(const JointFromBone& axes, std::size_t side) const {
  const Bone foot = side_bone(kSides[side], kFoot), toe = side_bone(kSides[side], kToe);
  const Bone sole = axes[toe] ? toe : foot;
  if (!level_[side] || !axes[sole]) return std::nullopt;
  const Eigen::Matrix3d toe_axes =
      *axes[sole] * canonical_t_pose(sole).transpose() * canonical_t_pose(toe);
  constexpr double kDegrees = 57.295779513082321;
  return kDegrees * angle_between(toe_axes.col(1), level_[side]->col(1));
}

std::optional<double> SoleCheck::error(const JointFromBone& axes) const {
  double sum = 0.0;
  int feet = 0;
  for (const std::size_t side : {0U, 1U}) {
    const auto found = error_of(axes, side);
    if (!found) continue;
    sum += *found;
    ++feet;
  }
  return feet > 0 ? std::optional(sum / feet) : std::nullopt;
}

JointFromBone SoleCheck::corrected(const RestCandidate& rest, JointFromBone axes) const {
  constexpr double kOff = 20.0;    // Degrees.
  constexpr double kSlope = 0.26;  // Sine of 15 degrees.
  for (const std::size_t side : {0U, 1U}) {
    const Bone foot = side_bone(kSides[side], kFoot);
    const auto error = error_of(axes, side);
    const auto way = along(body_.segment(foot), rest.pose);
    if (!error || *error < kOff || !way) continue;
    const double slope = (rest.axes * way->normalized()).z();
    if (std::abs(slope - canonical_t_pose(foot)(2, 0)) < kSlope) continue;
    axes = Learner(body_, poses_, up_, std::move(axes)).with_foot(kSides[side]);
  }
  return axes;
}

}  // namespace retarget
