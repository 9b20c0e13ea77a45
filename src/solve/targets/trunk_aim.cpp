#include "solve/targets/trunk_aim.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "base/math/least_squares.h"
#include "retarget/human_skeleton.h"
#include "retarget/kinematic_tree.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

// Weights of the residuals of the shoulder line and of the pelvis; that of the chord is 1.
constexpr double kAcrossWeight = 0.5;
constexpr double kPelvisWeight = 0.2;
constexpr double kSpare = 0.05;  // Share of a joint's range that stays unused on either side.
constexpr std::size_t kMaxJoints = 6;

using Waist = RobotTrunk::Waist;
constexpr Eigen::Index kSize = 3 + static_cast<Eigen::Index>(kMaxJoints);
using TrunkMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kSize, kSize>;
using TrunkVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kSize, 1>;

// The least-squares problem of one frame in the pelvis rotation and the waist positions.
class Search {
 public:
  // @param turn    the rotation R of TrunkAim.
  // @param across  target of the shoulder line; empty: R s.
  Search(const RobotTrunk& robot, const Eigen::Matrix3d& turn,
         const std::optional<Eigen::Vector3d>& across, const Eigen::Quaterniond& hips)
      : robot_(robot),
        wanted_chord_((turn * robot.lines.chord).normalized()),
        wanted_across_(across.value_or(turn * robot.lines.across).normalized()),
        hips_(hips),
        pelvis_(hips) {
    for (std::size_t i = 0; i < robot.waist.size(); ++i) {
      positions_[i] = std::clamp(0.0, robot.waist[i].lower, robot.waist[i].upper);
    }
  }

  // Members of LeastSquaresProblem.
  double cost() {
    update();
    return squared_error();
  }
  void linearise();
  std::optional<double> solve(double damping);
  double try_step(double length);
  void accept() {}
  void reject() {
    pelvis_ = pelvis_before_;
    positions_ = positions_before_;
    update();
  }

  [[nodiscard]] const Eigen::Quaterniond& pelvis() const { return pelvis_; }
  [[nodiscard]] Eigen::Quaterniond torso() const { return pelvis_ * waist_; }
  [[nodiscard]] const Eigen::Vector3d& chord() const { return chord_; }

 private:
  [[nodiscard]] Eigen::Index size() const {
    return 3 + static_cast<Eigen::Index>(robot_.waist.size());
  }
  void update();
  [[nodiscard]] double squared_error() const;
  void add(double weight, const Eigen::Vector3d& residual,
           const Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kSize>& jacobian);

  const RobotTrunk& robot_;
  Eigen::Vector3d wanted_chord_, wanted_across_;
  Eigen::Quaterniond hips_, pelvis_, pelvis_before_;
  Eigen::Quaterniond waist_ = Eigen::Quaterniond::Identity();  // Equals pelvis_from_torso.
  std::array<double, kMaxJoints> positions_{}, positions_before_{};
  Eigen::Vector3d chord_, across_;                                // World.
  std::array<Eigen::Vector3d, kMaxJoints> axes_, chord_changes_;  // World, by joint.
  TrunkMatrix normal_;
  TrunkVector right_, step_;
};

void Search::update() {
  const std::size_t count = robot_.waist.size();
  // Starts at the torso, because a joint moves all lines beyond it.
  Eigen::Vector3d chord = robot_.lines.chord;
  std::array<Eigen::Vector3d, kMaxJoints> levers;
  std::array<Eigen::Quaterniond, kMaxJoints> turns;
  waist_ = Eigen::Quaterniond::Identity();
  for (std::size_t i = count; i-- > 0;) {
    const Waist& joint = robot_.waist[i];
    turns[i] = exp_so3(joint.axis * positions_[i]);
    levers[i] = turns[i] * (chord - joint.anchor);
    chord = joint.anchor + levers[i];
    waist_ = turns[i] * waist_;
  }
  Eigen::Quaterniond carrier = pelvis_;
  for (std::size_t i = 0; i < count; ++i) {
    axes_[i] = carrier * robot_.waist[i].axis;
    chord_changes_[i] = axes_[i].cross(carrier * levers[i]);
    carrier = carrier * turns[i];
  }
  chord_ = pelvis_ * chord;
  across_ = pelvis_ * (waist_ * robot_.lines.across);
}

double Search::squared_error() const {
  const Eigen::Vector3d pelvis = log_so3(pelvis_ * hips_.conjugate());
  return (chord_.normalized() - wanted_chord_).squaredNorm() +
         kAcrossWeight * kAcrossWeight * (across_.normalized() - wanted_across_).squaredNorm() +
         kPelvisWeight * kPelvisWeight * pelvis.squaredNorm();
}

void Search::add(double weight, const Eigen::Vector3d& residual,
                 const Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kSize>& jacobian) {
  normal_.noalias() += weight * weight * jacobian.transpose() * jacobian;
  right_.noalias() -= weight * weight * jacobian.transpose() * residual;
}

// Linearises in the pelvis's rotation vector (world axes) and the joint positions.
void Search::linearise() {
  const Eigen::Index size = this->size();
  normal_.setZero(size, size);
  right_.setZero(size);
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kSize> jacobian(3, size);
  const auto of_line = [&](const Eigen::Vector3d& line, const auto& change) {
    const double length = line.norm();
    Eigen::Vector3d unit = line / length;
    const Eigen::Matrix3d across = (Eigen::Matrix3d::Identity() - unit * unit.transpose()) / length;
    jacobian.leftCols<3>() = -across * skew(line);
    for (std::size_t i = 0; i < robot_.waist.size(); ++i) {
      jacobian.col(3 + static_cast<Eigen::Index>(i)) = across * change(i);
    }
    return unit;
  };
  const Eigen::Vector3d chord = of_line(chord_, [&](std::size_t i) { return chord_changes_[i]; });
  add(1.0, chord - wanted_chord_, jacobian);
  const Eigen::Vector3d across =
      of_line(across_, [&](std::size_t i) { return Eigen::Vector3d(axes_[i].cross(across_)); });
  add(kAcrossWeight, across - wanted_across_, jacobian);
  const Eigen::Vector3d pelvis = log_so3(pelvis_ * hips_.conjugate());
  jacobian.setZero();
  jacobian.leftCols<3>().setIdentity();
  add(kPelvisWeight, pelvis, jacobian);
}

// Adds joints that the step would move out of their ranges to the active set, one after the other.
// Unlike ActiveSet, it releases none within a step. The next step starts with all joints free, so
// that the final result is the same, and the fixed-size arrays need no allocation per frame.
// Overwrites the system.
std::optional<double> Search::solve(double damping) {
  std::array<bool, kMaxJoints> held{};
  normal_.diagonal().array() += damping;
  for (std::size_t round = 0; round <= robot_.waist.size(); ++round) {
    step_ = normal_.llt().solve(right_);
    bool changed = false;
    for (std::size_t i = 0; i < robot_.waist.size(); ++i) {
      const auto row = 3 + static_cast<Eigen::Index>(i);
      if (held[i]) continue;
      const double to = positions_[i] + step_[row];
      if (to >= robot_.waist[i].lower && to <= robot_.waist[i].upper) continue;
      // The joint moves to the end of its range, and the other joints compensate.
      const double end = std::clamp(to, robot_.waist[i].lower, robot_.waist[i].upper);
      const double way = end - positions_[i];
      right_ -= normal_.col(row) * way;
      normal_.col(row).setZero();
      normal_.row(row).setZero();
      normal_(row, row) = 1.0;
      right_[row] = way;
      held[i] = changed = true;
      break;
    }
    if (!changed) break;
  }
  return step_.allFinite() ? step_.cwiseAbs().maxCoeff() : NAN;
}

double Search::try_step(double length) {
  pelvis_before_ = pelvis_;
  positions_before_ = positions_;
  pelvis_ = (exp_so3(length * step_.head<3>()) * pelvis_).normalized();
  for (std::size_t i = 0; i < robot_.waist.size(); ++i) {
    const auto row = 3 + static_cast<Eigen::Index>(i);
    positions_[i] = std::clamp(positions_[i] + length * step_[row], robot_.waist[i].lower,
                               robot_.waist[i].upper);
  }
  update();
  return squared_error();
}

TrunkAim::Aimed unknown_aim() {
  constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Quaterniond rotation(kNoNumber, kNoNumber, kNoNumber, kNoNumber);
  const Eigen::Vector3d line = Eigen::Vector3d::Constant(kNoNumber);
  return {rotation, rotation, line, line};
}

// Appends the hinges among some degrees of freedom.
// @param sign  -1 for joints between the common ancestor and the pelvis, whose axes are reversed.
void add_waist(const Robot& robot, const LimitSet& limits, const TreeState& posed,
               const Eigen::Vector3d& hip_centre, std::span<const int> dofs, double sign,
               std::vector<Waist>& waist) {
  const std::vector<double> zero = robot.zero_configuration();
  for (const int dof : dofs) {
    const KinematicTree::Link& link = posed.tree->links()[dof - KinematicTree::dof_of(0)];
    if (link.slides) continue;
    const double range = limits.upper[link.joint] - limits.lower[link.joint];
    const double spare = std::isfinite(range) ? kSpare * range : 0.0;
    const double at_zero = zero[link.qpos_address];
    Waist hinge;
    hinge.axis = sign * posed.axis(link.joint);
    hinge.anchor = posed.anchor(link.joint) - hip_centre;
    hinge.lower = limits.lower[link.joint] - at_zero + spare;
    hinge.upper = limits.upper[link.joint] - at_zero - spare;
    if (hinge.lower < hinge.upper) waist.push_back(hinge);
  }
}

}  // namespace

const ConfigTask* torso_task(const ResolvedConfig& config) {
  for (const Bone bone : {Bone::kSpine2, Bone::kSpine1, Bone::kSpine}) {
    const ConfigTask* const task = config.find_task(bone);
    if (task != nullptr && task->has_weight()) return task;
  }
  return nullptr;
}

std::optional<RobotTrunk> robot_trunk(const Robot& robot, const ResolvedConfig& config,
                                      const RobotLimbs& limbs, const LimitSet& limits) {
  const int pelvis = config.body_of(Bone::kHips);
  if (pelvis < 0) return std::nullopt;
  // Without a separate torso body, pelvis and torso are the same body.
  const ConfigTask* const spine = torso_task(config);
  const int torso = spine == nullptr || spine->body < 0 ? pelvis : spine->body;
  const TreeState posed(robot.tree(), robot.zero_configuration());
  RobotTrunk trunk;
  trunk.lines = {limbs.shoulder_centre - limbs.hip_centre, limbs.shoulder_line};
  trunk.hip_line = limbs.hip_line;
  trunk.world_from_pelvis = posed.world_from_body(pelvis).rotation;
  trunk.world_from_torso = posed.world_from_body(torso).rotation;

  // The path leads from the pelvis inwards to the common ancestor, then outwards to the torso.
  const auto carriers = [&](int body) {
    return robot.tree().carriers(KinematicTree::dof_of(robot.tree().attachment(body).link));
  };
  const auto to_pelvis = carriers(pelvis), to_torso = carriers(torso);
  const auto parting = std::ranges::mismatch(to_pelvis, to_torso);
  std::vector<int> up(parting.in1, to_pelvis.end());
  std::ranges::reverse(up);
  const std::vector<int> down(parting.in2, to_torso.end());
  add_waist(robot, limits, posed, limbs.hip_centre, up, -1.0, trunk.waist);
  add_waist(robot, limits, posed, limbs.hip_centre, down, 1.0, trunk.waist);
  if (trunk.waist.size() > kMaxJoints) return std::nullopt;
  return trunk;
}

TrunkAim::TrunkAim(RobotTrunk robot, const TrunkLines& standing,
                   const Eigen::Quaterniond& hips_to_pelvis)
    : robot_(std::move(robot)) {
  // Rotates the zero configuration so that its pelvis has the orientation that the retargeting
  // configuration prescribes for the T-pose.
  const Eigen::Quaterniond t_pose(canonical_t_pose(Bone::kHips));
  const Eigen::Quaterniond turn =
      (t_pose * hips_to_pelvis * robot_.world_from_pelvis.conjugate()).normalized();
  for (Eigen::Vector3d* line : {&robot_.lines.chord, &robot_.lines.across, &robot_.hip_line}) {
    *line = turn * *line;
  }
  for (Waist& waist : robot_.waist) {
    waist.axis = turn * waist.axis;
    waist.anchor = turn * waist.anchor;
  }
  robot_.world_from_pelvis = turn * robot_.world_from_pelvis;
  robot_.world_from_torso = turn * robot_.world_from_torso;
  const auto frame = trunk_frame(standing);
  usable_ = frame && trunk_frame(robot_.lines);
  if (usable_) standing_from_world_ = frame->transpose();
}

void TrunkAim::follow_robot() {
  of_robot_ = true;
  for (Waist& waist : robot_.waist) {
    const double spare = kSpare / (1.0 - 2.0 * kSpare) * (waist.upper - waist.lower);
    if (!std::isfinite(spare)) continue;
    waist.lower -= spare;
    waist.upper += spare;
  }
}

std::optional<TrunkAim::Aimed> TrunkAim::aim(const HumanPose& world_from_bone,
                                             double min_step) const {
  if (!usable_) return std::nullopt;
  const TrunkLines lines = trunk_lines(world_from_bone);
  const auto frame = trunk_frame(lines);
  if (!frame) return std::nullopt;
  const Eigen::Quaterniond t_pose(canonical_t_pose(Bone::kHips));
  Search search(robot_, *frame * standing_from_world_,
                of_robot_ ? std::optional(lines.across) : std::nullopt,
                world_from_bone[Bone::kHips].rotation.normalized() * t_pose.conjugate());
  // Takes full steps without a line search. Stops at a step that is not finite.
  const LeastSquaresPolicy policy{.max_steps = 12,
                                  .initial_damping = 1e-9,
                                  .shrink = 1.0,
                                  .min_increased = 1.0,
                                  .max_damping = 1.0,
                                  .monotone = false,
                                  .min_step = min_step};
  const auto solved = damped_least_squares(search, policy);
  if (solved.status == LeastSquaresStatus::kNonFinite) return unknown_aim();
  return Aimed{search.pelvis() * robot_.world_from_pelvis, search.torso() * robot_.world_from_torso,
               search.chord(), search.pelvis() * robot_.hip_line};
}

}  // namespace retarget
