#include "judge/simulation/reference_track.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/math/convex_hull.h"
#include "base/math/gravity.h"
#include "base/math/segment.h"
#include "retarget/so3.h"

namespace retarget {

using Eigen::Vector2d;

Vector2d nearest_in_support(const Vector2d& point, std::vector<Vector2d> support, double share) {
  if (support.empty()) return point;
  reduce_to_hull(support);
  Vector2d middle = Vector2d::Zero();
  for (const Vector2d& corner : support) middle += corner;
  middle /= static_cast<double>(support.size());
  for (Vector2d& corner : support) corner = middle + share * (corner - middle);
  bool inside = support.size() > 2;
  double nearest = std::numeric_limits<double>::infinity();
  Vector2d best = point;
  for (std::size_t i = 0; i < support.size(); ++i) {
    const Vector2d& from = support[i];
    const Vector2d& to = support[(i + 1) % support.size()];
    const Vector2d at = nearest_on_segment(point, from, to);
    inside = inside && cross_2d(to - from, point - from) >= 0.0;
    if ((at - point).squaredNorm() >= nearest) continue;
    nearest = (at - point).squaredNorm();
    best = at;
  }
  return inside ? point : best;
}

// Solves the tridiagonal system of the finite differences. It is diagonally dominant, so
// elimination without pivoting is stable.
std::vector<Vector2d> balancing_shift(const std::vector<BalanceSample>& samples, double time_step,
                                      double share) {
  std::vector<Vector2d> shift(samples.size(), Vector2d::Zero());
  if (samples.size() < 3) return shift;
  std::vector<double> upper(samples.size(), 0.0);
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    const BalanceSample& each = samples[i];
    const double pull = std::max(0.0, each.pull) * time_step * time_step;
    const Vector2d moved = nearest_in_support(each.zmp, each.support, share) - each.zmp;
    // Row i: -x[i-1] + (2 + pull) x[i] - x[i+1] = pull * moved.
    const double pivot = 2.0 + pull - upper[i - 1];
    upper[i] = 1.0 / pivot;
    shift[i] = (pull * moved + shift[i - 1]) / pivot;
  }
  for (std::size_t i = samples.size() - 2; i > 0; --i) shift[i] += upper[i] * shift[i + 1];
  return shift;
}

namespace {

using Eigen::Vector3d;

// Thresholds below which the contact of a point is planned, for a robot of a G1's size.
constexpr double kPlannedHeight = 0.005;  // Metres above the floor, or above the lowest point.
// Height of the lowest point above which the body flies, metres.
constexpr double kLowestHeight = 0.03;
constexpr double kPlannedSpeed = 0.35;  // Metres per second.
// Thresholds if these find no contact and the body does not fall, because heels strike and toes
// push off at higher speeds.
constexpr double kLooseHeight = 0.02, kLooseSpeed = 0.7;
// Smallest required vertical force of a body that does not fall, share of the weight.
constexpr double kBorne = 0.35;

// Smallest vertical force for a zero-moment point, share of the weight.
constexpr double kLeastHeld = 0.2;
constexpr double kSoleShare = 0.8;  // Scale of the support polygon that the motion may use.

Vector6d difference(const Pose& from, const Pose& to) {
  Vector6d step;
  step << to.translation - from.translation, log_so3(to.rotation * from.rotation.conjugate());
  return step;
}

}  // namespace

std::vector<FootFrame> make_foot_frames(const Robot& robot) {
  std::vector<FootFrame> feet;
  for (const Sole& sole : robot.profile().soles) {
    const KinematicTree::Attachment& at = robot.tree().attachment(sole.body);
    const bool known =
        std::ranges::any_of(feet, [&](const FootFrame& f) { return f.link == at.link; });
    if (at.link == KinematicTree::kWorld || known || sole.points.empty()) continue;
    Vector3d middle = Vector3d::Zero();
    for (const Vector3d& point : sole.points) middle += at.link_from_body * point;
    feet.push_back({at.link, middle / static_cast<double>(sole.points.size())});
  }
  return feet;
}

ReferenceTrack::ReferenceTrack(const RobotClip& clip, int steps_per_frame, double floor)
    : robot_(clip.robot()),
      spline_(clip),
      inertias_(make_inertias(robot_)),
      points_(make_support_points(robot_)),
      feet_(make_foot_frames(robot_)),
      steps_per_frame_(steps_per_frame),
      step_count_((clip.frame_count() - 1) * steps_per_frame + 1),
      time_step_(1.0 / (clip.rate().fps() * steps_per_frame)),
      floor_(floor),
      size_(body_size(robot_)),
      state_(robot_.tree()),
      inverse_(robot_.tree(), inertias_),
      window_{Sample(robot_), Sample(robot_), Sample(robot_)},
      reference_(robot_) {
  for (Sample& each : window_) {
    each.feet.resize(feet_.size());
    each.points.resize(points_.size());
  }
  reference_.feet.resize(feet_.size());
  reference_.planned.resize(points_.size());
  preview_balance();
}

// Computes the shift of the centre of mass for all steps, and the touchdowns of the feet.
void ReferenceTrack::preview_balance() {
  std::vector<BalanceSample> samples(static_cast<std::size_t>(step_count_));
  std::vector<std::vector<char>> planned(feet_.size());
  for (int step = 0; step < step_count_; ++step) {
    const ReferenceState& state = at(step);
    BalanceSample& into = samples[static_cast<std::size_t>(step)];
    const Wrench& needed = window_[1].needed;
    const double height = state.com.z();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (state.planned[i] != 0) into.support.emplace_back(window_[1].points[i].head<2>());
    }
    for (std::size_t f = 0; f < feet_.size(); ++f) {
      planned[f].push_back(state.feet[f].planned ? 1 : 0);
    }
    const double held = needed.force.z() / (inertias_.mass * kGravity);
    if (into.support.empty() || held < kLeastHeld || height <= 0.0) continue;
    into.pull = needed.force.z() / (inertias_.mass * height);
    into.zmp = zero_moment_point(needed, state.com, height);
  }
  shift_ = balancing_shift(samples, time_step_, kSoleShare);
  find_touchdowns(planned);
  for (Sample& each : window_) each.step = -1;
}

// Computes FootMotion::until_planned. @param planned  FootMotion::planned by foot and step.
void ReferenceTrack::find_touchdowns(const std::vector<std::vector<char>>& planned) {
  for (const std::vector<char>& of_foot : planned) {
    std::vector<double>& until = until_planned_.emplace_back(of_foot.size());
    double time = std::numeric_limits<double>::infinity();
    for (std::size_t step = of_foot.size(); step-- > 0;) {
      time = of_foot[step] != 0 ? 0.0 : time + time_step_;
      until[step] = time;
    }
  }
}

// Shift of the centre of mass at a step; zero beyond the ends and in preview_balance().
Vector3d ReferenceTrack::shift_at(int step) const {
  const bool known = step >= 0 && step < static_cast<int>(shift_.size());
  if (!known) return Vector3d::Zero();
  const Eigen::Vector2d& shift = shift_[static_cast<std::size_t>(step)];
  return {shift.x(), shift.y(), 0.0};
}

void ReferenceTrack::sample(int step, Sample& into) {
  into.step = step;
  // Extrapolates the first and last segments of the spline beyond the ends of the motion.
  const int frame =
      std::clamp(step / steps_per_frame_, 0, std::max(0, (step_count_ - 1) / steps_per_frame_ - 1));
  const double within = static_cast<double>(step - frame * steps_per_frame_) / steps_per_frame_;
  spline_.sample(frame, within, into.motion);
  into.motion.qpos[2] -= floor_;
  state_.update(into.motion.qpos);
  inverse_.compute(state_, into.motion.velocity, into.motion.acceleration);
  into.com = inverse_.com();
  into.com_acceleration = inverse_.com_acceleration();
  into.momentum = inverse_.angular_momentum();
  into.needed = inverse_.needed();
  for (std::size_t i = 0; i < feet_.size(); ++i) {
    const Pose& link = state_.world_from_link[feet_[i].link];
    into.feet[i] = {link.rotation, link * feet_[i].in_link};
  }
  for (std::size_t i = 0; i < points_.size(); ++i) into.points[i] = lowest_of(points_[i], state_);
}

const ReferenceState& ReferenceTrack::at(int step) {
  if (window_[1].step == step - 1 && window_[2].step == step) {
    std::rotate(window_.begin(), window_.begin() + 1, window_.end());
  } else {
    sample(step - 1, window_[0]);
    sample(step, window_[1]);
  }
  sample(step + 1, window_[2]);
  const Sample& now = window_[1];
  reference_.motion = now.motion;
  reference_.com = now.com;
  reference_.com_velocity = (window_[2].com - window_[0].com) / (2.0 * time_step_);
  reference_.com_acceleration = now.com_acceleration;
  const Vector3d shift = shift_at(step), next = shift_at(step + 1);
  // The shift is extrapolated linearly to the step before the first.
  const Vector3d last = step > 0 ? shift_at(step - 1) : Vector3d(2.0 * shift - next);
  reference_.com += shift;
  reference_.shift_velocity = (next - last) / (2.0 * time_step_);
  reference_.com_velocity += reference_.shift_velocity;
  reference_.com_acceleration += (next - 2.0 * shift + last) / (time_step_ * time_step_);
  reference_.momentum = now.momentum;
  reference_.momentum_rate = now.needed.torque;
  set_feet(window_[0], now, window_[2]);
  set_planned(window_[0], now, window_[2]);
  for (std::size_t f = 0; f < until_planned_.size(); ++f) {
    reference_.feet[f].until_planned = until_planned_[f][static_cast<std::size_t>(step)];
  }
  return reference_;
}

void ReferenceTrack::set_feet(const Sample& before, const Sample& now, const Sample& after) {
  for (std::size_t i = 0; i < feet_.size(); ++i) {
    const Vector6d first = difference(before.feet[i], now.feet[i]);
    const Vector6d second = difference(now.feet[i], after.feet[i]);
    FootMotion& foot = reference_.feet[i];
    foot.pose = now.feet[i];
    foot.velocity = (first + second) / (2.0 * time_step_);
    foot.acceleration = (second - first) / (time_step_ * time_step_);
    foot.planned = false;
  }
}

void ReferenceTrack::set_planned(const Sample& before, const Sample& now, const Sample& after) {
  if (plan_points(before, now, after, kPlannedHeight, kPlannedSpeed)) return;
  const bool is_borne = now.needed.force.z() > kBorne * inertias_.mass * kGravity;
  if (is_borne) plan_points(before, now, after, kLooseHeight, kLooseSpeed);
}

// Plans contacts for points below a height and a speed.
// @param height, speed  thresholds for a robot of a G1's size; metres, m/s.
// @return whether a contact is planned.
bool ReferenceTrack::plan_points(const Sample& before, const Sample& now, const Sample& after,
                                 double height, double speed) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Vector3d& point : now.points) lowest = std::min(lowest, point.z());
  const double top =
      height * size_ + (lowest < kLowestHeight * size_ ? std::max(0.0, lowest) : 0.0);
  bool any = false;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const double moves = (after.points[i] - before.points[i]).norm() / (2.0 * time_step_);
    const bool bears = now.points[i].z() < top && moves < speed * std::sqrt(size_);
    reference_.planned[i] = bears ? 1 : 0;
    any = any || bears;
    if (!bears || !points_[i].of_sole) continue;
    for (std::size_t f = 0; f < feet_.size(); ++f) {
      if (feet_[f].link == points_[i].link) reference_.feet[f].planned = true;
    }
  }
  return any;
}

}  // namespace retarget
