#include "pipeline/trunk_aim.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "human/canonical_pose.h"
#include "math/se3.h"
#include "math/so3.h"
#include "retarget/robot.h"
#include "robot/kinematic_tree.h"

namespace retarget {
namespace {

constexpr double kAcrossWeight = 0.5;  // of residuals; the chord's is 1
constexpr double kPelvisWeight = 0.2;
constexpr double kSpare = 0.05;  // of a joint's range, kept free on either side
constexpr std::size_t kMaxJoints = 6;

using Waist = RobotTrunk::Waist;
constexpr Eigen::Index kSize = 3 + static_cast<Eigen::Index>(kMaxJoints);
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kSize, kSize>;
using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kSize, 1>;

// the search for one frame: pelvis rotation and waist positions
class Search {
 public:
  /// @param across  the wanted line between the shoulders; nothing: turned as the chord is.
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

  void run() {
    constexpr int kSteps = 12;
    constexpr double kDone = 1e-10;  // radians
    for (int step = 0; step < kSteps; ++step) {
      update();
      if (!(take_step() > kDone)) break;
    }
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
  double take_step();
  void add(double weight, const Eigen::Vector3d& residual,
           const Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kSize>& jacobian);

  const RobotTrunk& robot_;
  Eigen::Vector3d wanted_chord_, wanted_across_;
  Eigen::Quaterniond hips_, pelvis_;
  Eigen::Quaterniond waist_ = Eigen::Quaterniond::Identity();  // pelvis from torso
  std::array<double, kMaxJoints> positions_{};
  Eigen::Vector3d chord_, across_;                                // world
  std::array<Eigen::Vector3d, kMaxJoints> axes_, chord_changes_;  // world, by joint
  Matrix normal_;
  Vector right_;
};

void Search::update() {
  const std::size_t count = robot_.waist.size();
  // from the torso's end: what a joint turns is all that comes behind it
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

void Search::add(double weight, const Eigen::Vector3d& residual,
                 const Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kSize>& jacobian) {
  normal_.noalias() += weight * weight * jacobian.transpose() * jacobian;
  right_.noalias() -= weight * weight * jacobian.transpose() * residual;
}

// One Gauss-Newton step over the pelvis's rotation vector (world axes) and the joints that are not
// held at the ends of their ranges; its largest component.
double Search::take_step() {
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

  // Joints that the step would take out of their ranges are held, one after the other. None is let go
  // in the same step, as ActiveSet does: the next step begins with all of them free, so what is left at
  // the end is no different, and a few numbers of fixed size need no memory for each frame.
  std::array<bool, kMaxJoints> held{};
  Vector step(size);
  constexpr double kDamping = 1e-9;
  normal_.diagonal().array() += kDamping;
  for (std::size_t round = 0; round <= robot_.waist.size(); ++round) {
    step = normal_.llt().solve(right_);
    bool changed = false;
    for (std::size_t i = 0; i < robot_.waist.size(); ++i) {
      const auto row = 3 + static_cast<Eigen::Index>(i);
      if (held[i]) continue;
      const double to = positions_[i] + step[row];
      if (to >= robot_.waist[i].lower && to <= robot_.waist[i].upper) continue;
      // it goes to the end of its range, and the others make up for it
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
  pelvis_ = (exp_so3(step.head<3>()) * pelvis_).normalized();
  for (std::size_t i = 0; i < robot_.waist.size(); ++i) {
    positions_[i] = std::clamp(positions_[i] + step[3 + static_cast<Eigen::Index>(i)],
                               robot_.waist[i].lower, robot_.waist[i].upper);
  }
  return step.cwiseAbs().maxCoeff();
}

// the hinges among degrees of freedom; going up, they turn what is above them backwards
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
  // without a torso of its own, pelvis and torso are one
  const ConfigTask* const spine = torso_task(config);
  const int torso = spine == nullptr || spine->body < 0 ? pelvis : spine->body;
  const TreeState posed(robot.tree(), robot.zero_configuration());
  RobotTrunk trunk;
  trunk.lines = {limbs.shoulder_centre - limbs.hip_centre, limbs.shoulder_line};
  trunk.hip_line = limbs.hip_line;
  trunk.world_from_pelvis = posed.world_from_body(pelvis).rotation;
  trunk.world_from_torso = posed.world_from_body(torso).rotation;

  // from the pelvis up to the body that carries both, and down to the torso
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
  // the robot's zero configuration, turned to where the configuration has it in the T-pose
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

std::optional<TrunkAim::Aimed> TrunkAim::aim(const HumanPose& world_from_bone) const {
  if (!usable_) return std::nullopt;
  const TrunkLines lines = trunk_lines(world_from_bone);
  const auto frame = trunk_frame(lines);
  if (!frame) return std::nullopt;
  const Eigen::Quaterniond t_pose(canonical_t_pose(Bone::kHips));
  Search search(robot_, *frame * standing_from_world_,
                of_robot_ ? std::optional(lines.across) : std::nullopt,
                world_from_bone[Bone::kHips].rotation.normalized() * t_pose.conjugate());
  search.run();
  return Aimed{search.pelvis() * robot_.world_from_pelvis, search.torso() * robot_.world_from_torso,
               search.chord(), search.pelvis() * robot_.hip_line};
}

}  // namespace retarget
