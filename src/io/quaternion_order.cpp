#include "io/quaternion_order.h"

#include <algorithm>
#include <vector>

#include "base/number_text.h"
#include "io/touch_points.h"
#include "retarget/pose.h"
#include "retarget/robot.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr std::size_t kFramesTried = 600;
// a z axis that points up as much more than the other reading's
constexpr double kClearlyUpright = 0.25;
constexpr double kStands = 0.7;
// the better slip as a share of the worse, which must be something
constexpr double kClearlyLess = 0.6;
constexpr double kSlips = 1e-4;
// below this a robot hardly moves, metres a frame
constexpr double kStandsStill = 2e-3;

Quaterniond rotation_of(const RawMotion& raw, std::size_t frame, QuaternionOrder order) {
  const double* q = raw.rotation.data() + 4 * frame;
  return order == QuaternionOrder::kWxyz ? Quaterniond(q[0], q[1], q[2], q[3]).normalized()
                                         : Quaterniond(q[3], q[0], q[1], q[2]).normalized();
}

}  // namespace

OrderEvidence weigh_orders(const RobotClip& configurations, const RawMotion& raw) {
  const Robot& robot = configurations.robot();
  const std::vector<TouchPoint> points = touch_points(robot);
  std::vector<Pose> world_from_body(robot.bodies().size());
  OrderEvidence evidence;
  for (const QuaternionOrder order : {QuaternionOrder::kXyzw, QuaternionOrder::kWxyz}) {
    double upright = 0.0, slip = 0.0;
    std::vector<Vector3d> before, now(points.size());
    std::size_t lowest_before = 0;
    const std::size_t step = std::max<std::size_t>(1, raw.frames / kFramesTried);
    std::size_t counted = 0;
    // neighbours in time are needed, so whole stretches are taken or left out
    for (std::size_t frame = 0; frame < raw.frames; ++frame) {
      const Quaterniond rotation = rotation_of(raw, frame, order);
      upright += (rotation * Vector3d::UnitZ()).z();
      if (step > 1 && (frame / 30) % step != 0) {
        before.clear();
        continue;
      }
      const auto from = configurations.qpos(static_cast<int>(frame));
      std::vector<double> qpos(from.begin(), from.end());
      qpos[3] = rotation.w();
      for (int i = 0; i < 3; ++i) qpos[4 + i] = rotation.vec()[i];
      forward_kinematics(robot, qpos, world_from_body);
      std::size_t lowest = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        now[i] = world_from_body[points[i].body] * points[i].place;
        if (now[i].z() < now[lowest].z()) lowest = i;
      }
      if (!before.empty()) {
        slip += (now[lowest_before] - before[lowest_before]).head<2>().norm();
        ++counted;
      }
      before = now;
      lowest_before = lowest;
    }
    const auto index = static_cast<std::size_t>(order);
    evidence.upright[index] = upright / static_cast<double>(raw.frames);
    if (counted > 0) evidence.slip[index] = slip / static_cast<double>(counted);
  }
  return evidence;
}

OrderGuess guess_order(const OrderEvidence& evidence, QuaternionOrder usual) {
  const auto other = [](QuaternionOrder order) {
    return order == QuaternionOrder::kXyzw ? QuaternionOrder::kWxyz : QuaternionOrder::kXyzw;
  };
  const auto pair_text = [](double of_xyzw, double of_wxyz, int decimals) {
    return number_text(of_xyzw, decimals) + " as xyzw, " + number_text(of_wxyz, decimals) +
           " as wxyz";
  };
  OrderGuess guess;
  const double* up = evidence.upright;
  const double* slip = evidence.slip;
  const auto upper = up[0] >= up[1] ? QuaternionOrder::kXyzw : QuaternionOrder::kWxyz;
  const double highest = std::max(up[0], up[1]);
  if (highest > kStands && highest - std::min(up[0], up[1]) > kClearlyUpright) {
    guess.order = upper;
    guess.reason = "the root stands upright by " + pair_text(up[0], up[1], 2);
    return guess;
  }
  const auto steadier = slip[0] <= slip[1] ? QuaternionOrder::kXyzw : QuaternionOrder::kWxyz;
  const double max = std::max(slip[0], slip[1]);
  if (max > kSlips && std::min(slip[0], slip[1]) < kClearlyLess * max) {
    guess.order = steadier;
    guess.reason = "the lowest foot slips by " + pair_text(1000.0 * slip[0], 1000.0 * slip[1], 2) +
                   " mm per frame";
    return guess;
  }
  // both stand still; a robot that turns its back all the time is the rarer one
  if (max < kStandsStill && up[static_cast<std::size_t>(usual)] > kStands &&
      up[static_cast<std::size_t>(other(usual))] > kStands) {
    guess.order = usual;
    guess.by_habit = true;
    guess.reason = "both orders fit, and this is the usual one";
  }
  return guess;
}

}  // namespace retarget
