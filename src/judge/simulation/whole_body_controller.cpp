#include "judge/simulation/whole_body_controller.h"

#include <mujoco/mujoco.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/math/gravity.h"
#include "retarget/so3.h"
#include "solve/dynamics/force_cone.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr std::size_t kMaxPointsOfFoot = 6, kMaxPointsInAll = 16;
constexpr int kEdges = ForceCone::kEdges;
constexpr double kTouching = 0.002;    // Height up to which a point is near the floor, metres.
constexpr double kNearlyFlat = 0.012;  // The same for planned points of a foot in contact, metres.
constexpr double kLoadTime = 0.06;     // Time in which the load on a point may grow, seconds.
constexpr double kLeverOfG1 = 0.3;     // Radius of gyration of a G1, metres.
constexpr double kShiftTime = 0.08;    // Time constant of a swing foot's shift, seconds.
constexpr double kFreeTorque = 100.0;  // Scale of torques without a limit, N m.

Vector3d vector_of(const mjtNum* values) {
  return {values[0], values[1], values[2]};
}

Eigen::Quaterniond rotation_of(const mjtNum* wxyz) {
  return {wxyz[0], wxyz[1], wxyz[2], wxyz[3]};
}

Pose body_pose(const mjData* data, int body) {
  return {rotation_of(data->xquat + 4L * body), vector_of(data->xpos + 3L * body)};
}

}  // namespace

// Rows of the weighted least-squares problem.
class WholeBodyController::Tasks {
 public:
  explicit Tasks(int inputs_at_most, int rows_at_most)
      : rows_(rows_at_most, inputs_at_most), right_(rows_at_most) {}
  void begin(int inputs) {
    inputs_ = inputs;
    count_ = 0;
  }
  template <typename Rows, typename Desired>
  void add(const Rows& rows, const Desired& desired, double weight) {
    const Eigen::Index n = rows.rows();
    rows_.block(count_, 0, n, inputs_) = weight * rows;
    right_.segment(count_, n) = weight * desired;
    count_ += n;
  }
  [[nodiscard]] auto rows() const { return rows_.topLeftCorner(count_, inputs_); }
  [[nodiscard]] auto right() const { return right_.head(count_); }

  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;

 private:
  Eigen::MatrixXd rows_;
  Eigen::VectorXd right_;
  Eigen::Index inputs_ = 0, count_ = 0;
};

// State of a foot.
struct WholeBodyController::Foot {
  FootFrame frame;
  int body = 0;                       // Body of the physics model.
  Vector3d shift = Vector3d::Zero();  // From the reference, metres; horizontal except in flight.
  bool stands = false;                // Whether it is in contact as planned.
  std::optional<Pose> landed = {};    // Pose at an early landing.
};

WholeBodyController::WholeBodyController(const PhysicsModel& physics, const Robot& robot)
    : physics_(physics),
      robot_(robot),
      weight_(physics.mass * kGravity),
      joint_count_(static_cast<int>(physics.joints.size())),
      qp_(joint_count_ + kEdges * static_cast<int>(kMaxPointsInAll)) {
  const double size = body_size(robot);
  lever_ = kLeverOfG1 * size;
  for (double* stiffness : {&gains_.com_stiffness, &gains_.root_stiffness, &gains_.foot_stiffness,
                            &gains_.joint_stiffness}) {
    *stiffness /= size;
  }
  for (double* damping : {&gains_.com_damping, &gains_.spin_damping, &gains_.root_damping,
                          &gains_.foot_damping, &gains_.joint_damping}) {
    *damping /= std::sqrt(size);
  }
  gains_.step_reach *= size;
  gains_.flight_reach *= size;
  gains_.early_height *= size;
  for (const FootFrame& frame : make_foot_frames(robot)) {
    feet_.push_back({frame, frame.link + 1});
  }
  for (const PhysicsJoint& joint : physics.joints) {
    scales_.push_back(std::isfinite(joint.limit) ? joint.limit : kFreeTorque * size);
  }
  const auto dofs = static_cast<int>(physics.model->nv);
  const int inputs = joint_count_ + kEdges * static_cast<int>(kMaxPointsInAll);
  tasks_ = std::make_unique<Tasks>(inputs, 9 + 6 * static_cast<int>(feet_.size()) + joint_count_);
  inputs_.resize(inputs, dofs);
  response_.resize(inputs, dofs);
  free_.resize(dofs);
  wanted_positions_.resize(physics.model->nq);
  wanted_rates_.resize(dofs);
  wanted_accelerations_.resize(dofs);
  lower_.resize(inputs);
  upper_.resize(inputs);
  amounts_.resize(inputs);
  tasks_->hessian.resize(inputs, inputs);
  tasks_->gradient.resize(inputs);
  step_.torques.resize(physics.joints.size());
  loads_.assign(physics.points.size(), 1.0);
}

WholeBodyController::~WholeBodyController() = default;

const ControlStep& WholeBodyController::compute(const ReferenceState& reference, double time_step,
                                                mjData_* data) {
  physics_.set_positions(reference.motion.qpos, robot_, wanted_positions_.data());
  physics_.set_rates(reference.motion.velocity, wanted_rates_.data());
  physics_.set_rates(reference.motion.acceleration, wanted_accelerations_.data());
  mj_subtreeVel(physics_.model.get(), data);
  find_points(reference, time_step, data);
  build_inputs(data);
  move_feet(reference, time_step, data);
  tasks_->begin(input_count_);
  add_centroid(reference, data);
  add_root(data);
  add_feet(reference, data);
  add_joints(data);
  solve(reference);
  return step_;
}

// Selects the points near the floor: at most kMaxPointsOfFoot outermost points per foot, and at
// most kMaxPointsInAll in total.
void WholeBodyController::find_points(const ReferenceState& reference, double time_step,
                                      mjData_* data) {
  std::vector<Vector3d> all(physics_.points.size());
  std::vector<int> near;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const PhysicsPoint& point = physics_.points[i];
    all[i] = body_pose(data, point.body) * point.in_body - point.radius * Vector3d::UnitZ();
    if (all[i].z() < kTouching) near.push_back(static_cast<int>(i));
  }
  // Planned points of a foot in contact remain active at larger heights, so that a foot that tips
  // can press its other end down again.
  std::vector<char> touches(physics_.model->nbody, 0);
  for (const int i : near) touches[physics_.points[i].body] = 1;
  near.clear();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const PhysicsPoint& point = physics_.points[i];
    const bool flat = point.of_sole && touches[point.body] != 0 && reference.planned[i] != 0;
    if (all[i].z() < (flat ? kNearlyFlat : kTouching)) {
      near.push_back(static_cast<int>(i));
      loads_[i] = std::min(1.0, loads_[i] + time_step / kLoadTime);
    } else {
      loads_[i] = 0.0;
    }
  }
  step_.points.clear();
  for (const Foot& foot : feet_) {
    std::vector<int> of_foot;
    for (const int i : near) {
      if (physics_.points[i].body == foot.body && physics_.points[i].of_sole) of_foot.push_back(i);
    }
    keep_outermost(all, kMaxPointsOfFoot, of_foot);
    step_.points.insert(step_.points.end(), of_foot.begin(), of_foot.end());
  }
  for (const int i : near) {
    if (!physics_.points[i].of_sole) step_.points.push_back(i);
  }
  keep_outermost(all, kMaxPointsInAll, step_.points);
  places_.clear();
  for (const int i : step_.points) places_.push_back(all[i]);
}

// Computes the generalised force of each input, and the acceleration that it causes.
void WholeBodyController::build_inputs(mjData_* data) {
  const mjModel* model = physics_.model.get();
  input_count_ = joint_count_ + kEdges * static_cast<int>(step_.points.size());
  inputs_.topRows(input_count_).setZero();
  for (int i = 0; i < joint_count_; ++i) inputs_(i, physics_.joints[i].dof) = scales_[i];
  const Eigen::Matrix<double, 3, kEdges> pyramid = weight_ * friction_pyramid(gains_.friction);
  RowMajor jacobian(3, model->nv);
  for (std::size_t p = 0; p < places_.size(); ++p) {
    mj_jac(model, data, jacobian.data(), nullptr, places_[p].data(),
           physics_.points[step_.points[p]].body);
    inputs_.middleRows(joint_count_ + kEdges * static_cast<int>(p), kEdges) =
        pyramid.transpose() * jacobian;
  }
  mj_solveM(model, data, response_.data(), inputs_.data(), input_count_);
  const Eigen::VectorXd loads = Eigen::Map<const Eigen::VectorXd>(data->qfrc_passive, model->nv) -
                                Eigen::Map<const Eigen::VectorXd>(data->qfrc_bias, model->nv);
  mj_solveM(model, data, free_.data(), loads.data(), 1);
}

Pose WholeBodyController::pose_of(const Foot& foot, mjData_* data) const {
  const Pose body = body_pose(data, foot.body);
  return {body.rotation, body * foot.frame.in_link};
}

bool WholeBodyController::is_down(const Foot& foot) const {
  return std::ranges::any_of(step_.points,
                             [&](int p) { return physics_.points[p].body == foot.body; });
}

// The shift with which a swing foot steps onto the capture point, with a reduced offset.
Vector3d WholeBodyController::step_shift(const ReferenceState& reference, mjData_* data) const {
  const Vector3d com = vector_of(data->subtree_com + 3);
  const Vector3d velocity = vector_of(data->subtree_linvel + 3);
  const double pace = std::sqrt(std::max(0.05, reference.com.z()) / kGravity);
  Vector3d step = com - reference.com + pace * (velocity - reference.com_velocity) - offset_;
  step.z() = 0.0;
  if (step.norm() > gains_.step_reach) step *= gains_.step_reach / step.norm();
  return step + gains_.offset_share * offset_;
}

// Updates the shifts: that of a swing foot moves to step_shift(), that of a standing foot is
// constant.
void WholeBodyController::move_feet(const ReferenceState& reference, double time_step,
                                    mjData_* data) {
  const Vector3d step = step_shift(reference, data);
  const double rise = vector_of(data->subtree_com + 3).z() - reference.com.z();
  const bool flies =
      std::ranges::none_of(reference.feet, [](const FootMotion& foot) { return foot.planned; });
  for (std::size_t i = 0; i < feet_.size(); ++i) {
    Foot& foot = feet_[i];
    const bool down = is_down(foot), stands = down && reference.feet[i].planned;
    const bool early = down && flies && rise < -gains_.early_height &&
                       reference.feet[i].until_planned < gains_.early_time;
    if (!early) foot.landed.reset();
    if (early && !foot.landed) foot.landed = pose_of(foot, data);
    if (stands && !foot.stands) {
      foot.shift = pose_of(foot, data).translation - reference.feet[i].pose.translation;
      foot.shift.z() = 0.0;
    } else if (!stands) {
      Vector3d to = step;
      if (flies && !down) to.z() = std::clamp(rise, -gains_.flight_reach, gains_.flight_reach);
      foot.shift += std::min(1.0, time_step / kShiftTime) * (to - foot.shift);
    }
    foot.stands = stands;
  }
  follow_feet(time_step);
}

// Moves the body's offset to the mean shift of the standing feet.
void WholeBodyController::follow_feet(double time_step) {
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  for (const Foot& foot : feet_) {
    if (!foot.stands) continue;
    sum += foot.shift;
    ++count;
  }
  if (count == 0) return;
  offset_ += std::min(1.0, time_step / gains_.follow_time) * (sum / count - offset_);
}

// Adds the tasks of the centre of mass and of the angular momentum.
void WholeBodyController::add_centroid(const ReferenceState& reference, mjData_* data) {
  const Vector3d com = vector_of(data->subtree_com + 3);
  const Vector3d velocity = vector_of(data->subtree_linvel + 3);
  const Vector3d spin = vector_of(data->subtree_angmom + 3);
  const Eigen::Matrix<double, 3, kEdges> pyramid = weight_ * friction_pyramid(gains_.friction);
  Eigen::MatrixXd force = Eigen::MatrixXd::Zero(3, input_count_), moment = force;
  for (std::size_t p = 0; p < places_.size(); ++p) {
    const int at = joint_count_ + kEdges * static_cast<int>(p);
    force.middleCols(at, kEdges) = pyramid / physics_.mass;
    const double inertia = physics_.mass * lever_ * lever_;
    moment.middleCols(at, kEdges) = skew(places_[p] - com) * pyramid / inertia;
  }
  const Vector3d desired = reference.com_acceleration + kGravity * Vector3d::UnitZ() +
                           gains_.com_stiffness * (reference.com + offset_ - com) +
                           gains_.com_damping * (reference.com_velocity - velocity);
  tasks_->add(force, desired, gains_.com_weight);
  const Vector3d rate =
      (reference.momentum_rate + gains_.spin_damping * (reference.momentum - spin)) /
      (physics_.mass * lever_ * lever_);
  tasks_->add(moment, rate, gains_.spin_weight);
}

void WholeBodyController::add_root(mjData_* data) {
  const Eigen::Quaterniond current = rotation_of(data->qpos + 3);
  const Eigen::Quaterniond current_from_desired =
      current.conjugate() * rotation_of(wanted_positions_.data() + 3);
  const Vector3d rate =
      current_from_desired * wanted_rates_.segment<3>(3) - vector_of(data->qvel + 3);
  const Vector3d desired = current_from_desired * wanted_accelerations_.segment<3>(3) +
                           gains_.root_stiffness * log_so3(current_from_desired) +
                           gains_.root_damping * rate - free_.segment<3>(3);
  tasks_->add(response_.topRows(input_count_).middleCols(3, 3).transpose(), desired,
              gains_.root_weight);
}

void WholeBodyController::add_feet(const ReferenceState& reference, mjData_* data) {
  const mjModel* model = physics_.model.get();
  RowMajor jacobian(6, model->nv), drift(6, model->nv);
  const Eigen::Map<const Eigen::VectorXd> rates(data->qvel, model->nv);
  for (std::size_t i = 0; i < feet_.size(); ++i) {
    const Foot& foot = feet_[i];
    const FootMotion& to = reference.feet[i];
    const Pose pose = pose_of(foot, data);
    mj_jac(model, data, jacobian.data(), jacobian.data() + 3L * model->nv, pose.translation.data(),
           foot.body);
    mj_jacDot(model, data, drift.data(), drift.data() + 3L * model->nv, pose.translation.data(),
              foot.body);
    const Pose goal =
        foot.landed.value_or(Pose{to.pose.rotation, Vector3d(to.pose.translation + foot.shift)});
    const double moves = foot.landed ? 0.0 : 1.0;
    Vector6d error;
    error << goal.translation - pose.translation,
        log_so3(goal.rotation * pose.rotation.conjugate());
    const Vector6d desired = moves * to.acceleration + gains_.foot_stiffness * error +
                             gains_.foot_damping * (moves * to.velocity - jacobian * rates) -
                             drift * rates - jacobian * free_;
    tasks_->add(jacobian * response_.topRows(input_count_).transpose(), desired,
                gains_.foot_weight);
  }
}

void WholeBodyController::add_joints(mjData_* data) {
  const auto n = static_cast<Eigen::Index>(joint_count_);
  const Eigen::Map<const Eigen::VectorXd> positions(data->qpos + 7, n), rates(data->qvel + 6, n);
  const Eigen::VectorXd desired = wanted_accelerations_.tail(n) +
                                  gains_.joint_stiffness * (wanted_positions_.tail(n) - positions) +
                                  gains_.joint_damping * (wanted_rates_.tail(n) - rates) -
                                  free_.tail(n);
  tasks_->add(response_.topRows(input_count_).rightCols(n).transpose(), desired,
              gains_.joint_weight);
}

bool WholeBodyController::bears(int point, const ReferenceState& reference) const {
  const auto has_landed = [&](const Foot& foot) {
    return foot.landed && foot.body == physics_.points[point].body;
  };
  return reference.planned[point] != 0 || std::ranges::any_of(feet_, has_landed);
}

void WholeBodyController::solve(const ReferenceState& reference) {
  const int size = static_cast<int>(amounts_.size());
  Eigen::MatrixXd& hessian = tasks_->hessian;
  Eigen::VectorXd& gradient = tasks_->gradient;
  hessian.setZero();
  hessian.diagonal().setOnes();
  gradient.setZero();
  lower_.setZero();
  upper_.setZero();
  auto used = hessian.topLeftCorner(input_count_, input_count_);
  used.setZero();
  used.selfadjointView<Eigen::Lower>().rankUpdate(tasks_->rows().transpose());
  gradient.head(input_count_) = -(tasks_->rows().transpose() * tasks_->right());
  for (int i = 0; i < joint_count_; ++i) {
    hessian(i, i) += gains_.torque_weight * gains_.torque_weight;
    upper_[i] =
        std::isfinite(physics_.joints[i].limit) ? 1.0 : std::numeric_limits<double>::infinity();
    lower_[i] = -upper_[i];
  }
  // Points without a planned contact may bear force only if no point with one is near the floor.
  const bool any_planned =
      std::ranges::any_of(step_.points, [&](int p) { return reference.planned[p] != 0; });
  for (int i = joint_count_; i < input_count_; ++i) {
    const int point = step_.points[(i - joint_count_) / kEdges];
    hessian(i, i) += gains_.force_weight * gains_.force_weight;
    if (!any_planned || bears(point, reference)) {
      upper_[i] = loads_[point] < 1.0 ? loads_[point] : std::numeric_limits<double>::infinity();
    }
  }
  const BoxQpStats stats = qp_.solve(hessian, gradient, lower_, upper_, amounts_);
  step_.converged = stats.converged;
  if (!step_.converged) amounts_.head(size).setZero();
  for (int i = 0; i < joint_count_; ++i) step_.torques[i] = amounts_[i] * scales_[i];
  step_.acceleration =
      free_ + response_.topRows(input_count_).transpose() * amounts_.head(input_count_);
  const Eigen::Matrix<double, 3, kEdges> pyramid = weight_ * friction_pyramid(gains_.friction);
  step_.forces.clear();
  for (std::size_t p = 0; p < places_.size(); ++p) {
    step_.forces.push_back(pyramid *
                           amounts_.segment<kEdges>(joint_count_ + kEdges * static_cast<int>(p)));
  }
}

}  // namespace retarget
