#include "solve/dynamics/reference_spline.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>

#include "retarget/kinematic_tree.h"
#include "retarget/root_pose.h"

namespace retarget {
namespace {

// Changes and excesses up to this size are not reported: rad, m, or relative to a speed limit.
constexpr double kNothing = 1e-9;

std::vector<double> column_of(const RobotClip& clip, int address) {
  std::vector<double> values;
  for (int t = 0; t < clip.frame_count(); ++t) {
    values.push_back(clip.qpos(t)[static_cast<std::size_t>(address)]);
  }
  return values;
}

}  // namespace

ReferenceSpline::ReferenceSpline(const RobotClip& clip, const LimitSet& limits)
    : fps_(clip.rate().fps()), addresses_{0, 1, 2} {
  const Robot& robot = clip.robot();
  const auto& links = robot.tree().links();
  for (std::size_t i = 1; i < links.size(); ++i) addresses_.push_back(links[i].qpos_address);
  for (const int address : addresses_) scalars_.emplace_back(column_of(clip, address));
  for (std::size_t i = 1; i < links.size(); ++i) {
    keep_limits(robot, limits, static_cast<int>(i), scalars_[2 + i]);
  }
  std::vector<Eigen::Quaterniond> rotations;
  for (int t = 0; t < clip.frame_count(); ++t) {
    rotations.push_back(root_rotation(clip.qpos(t)).normalized());
  }
  rotation_ = RotationSpline(rotations);
}

void ReferenceSpline::keep_limits(const Robot& robot, const LimitSet& limits, int link,
                                  UniformSpline& spline) {
  const int joint = robot.tree().links()[static_cast<std::size_t>(link)].joint;
  const auto at = static_cast<std::size_t>(joint);
  const SplineBounds bounds{limits.lower[at], limits.upper[at], robot.speed_limit(joint) / fps_};
  const SplineCorrection correction = spline.keep_inside(bounds);
  const std::string& name = robot.joints()[at].name;
  if (correction.largest > kNothing) {
    corrections_.push_back({name, correction.at / fps_, correction.largest});
  }
  report_beyond(bounds, spline, name);
}

void ReferenceSpline::report_beyond(const SplineBounds& bounds, const UniformSpline& spline,
                                    const std::string& joint) {
  ReferenceLimit position{ReferenceLimit::Kind::kPosition, joint, 0.0, 0.0, 0.0};
  ReferenceLimit speed{ReferenceLimit::Kind::kSpeed, joint, 0.0, 0.0, 0.0};
  double worst = kNothing, fastest = kNothing;
  for (int piece = 0; piece < spline.piece_count(); ++piece) {
    const UniformSpline::Range values = spline.values(piece), rates = spline.velocities(piece);
    const auto check_position = [&](const SplineExtreme& value, double over, double limit) {
      if (!(over > worst)) return;
      worst = over;
      position.time = value.at / fps_;
      position.value = value.value;
      position.limit = limit;
    };
    check_position(values.greatest, values.greatest.value - bounds.upper, bounds.upper);
    check_position(values.least, bounds.lower - values.least.value, bounds.lower);
    for (const SplineExtreme& rate : {rates.least, rates.greatest}) {
      const double over = std::abs(rate.value) / bounds.speed - 1.0;
      if (!(over > fastest)) continue;
      fastest = over;
      speed.time = rate.at / fps_;
      speed.value = std::abs(rate.value) * fps_;
      speed.limit = bounds.speed * fps_;
    }
  }
  if (worst > kNothing) beyond_.push_back(position);
  if (fastest > kNothing) beyond_.push_back(speed);
}

void ReferenceSpline::sample(int index, double s, MotionState& state) const {
  const double fps = fps_;
  for (std::size_t i = 0; i < addresses_.size(); ++i) {
    const SplineState scalar = scalars_[i].at(index, s);
    const std::size_t dof = i < 3 ? i : i + 3;
    state.qpos[static_cast<std::size_t>(addresses_[i])] = scalar.value;
    state.velocity[dof] = fps * scalar.velocity;
    state.acceleration[dof] = fps * fps * scalar.acceleration;
  }
  set_root_rotation(rotation_.at(index, s), fps, state);
}

}  // namespace retarget
