#include "formats/robot_motion/raw_motion.h"

#include <algorithm>
#include <vector>

#include "retarget/pose.h"
#include "retarget/robot.h"
#include "retarget/root_pose.h"
#include "retarget/so3.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr std::size_t kFramesTried = 600;
// Minimum difference between the mean upward components of the up axes of both readings.
constexpr double kClearlyUpright = 0.25;
constexpr double kStands = 0.7;
// Maximum ratio of the smaller slip to the larger one, which must exceed kSlips (metres per frame).
constexpr double kClearlyLess = 0.6;
constexpr double kSlips = 1e-4;
// Below this slip a robot hardly moves, metres per frame.
constexpr double kStandsStill = 2e-3;

Quaterniond rotation_at(const RawMotion& raw, std::size_t frame, QuaternionOrder order) {
  const double* q = raw.rotation.data() + 4 * frame;
  return order == QuaternionOrder::kWxyz ? Quaterniond(q[0], q[1], q[2], q[3]).normalized()
                                         : Quaterniond(q[3], q[0], q[1], q[2]).normalized();
}

// Movement of the lowest of several points in a step, perpendicular to an axis.
class LowestSlip {
 public:
  explicit LowestSlip(int up) : up_(up) {}

  void add(const std::vector<Vector3d>& now) {
    std::size_t lowest = 0;
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (now[i][up_] < now[lowest][up_]) lowest = i;
    }
    if (!before_.empty()) {
      Vector3d step = now[lowest_before_] - before_[lowest_before_];
      step[up_] = 0.0;
      sum_ += step.norm();
      ++counted_;
    }
    before_ = now;
    lowest_before_ = lowest;
  }
  void interrupt() { before_.clear(); }
  [[nodiscard]] double mean() const {
    return counted_ > 0 ? sum_ / static_cast<double>(counted_) : 0.0;
  }

 private:
  int up_;
  std::vector<Vector3d> before_;
  std::size_t lowest_before_ = 0, counted_ = 0;
  double sum_ = 0.0;
};

}  // namespace

OrderEvidence weigh_orders(const RobotClip& configurations, const RawMotion& raw) {
  const Robot& robot = configurations.robot();
  const std::vector<TouchPoint> points = touch_points(robot);
  std::vector<Pose> world_from_body(robot.bodies().size());
  // The axis of the root that points up while the robot stands.
  const std::vector<double> zero = robot.zero_configuration();
  const Vector3d up = root_rotation(zero).conjugate() * Vector3d::UnitZ();
  OrderEvidence evidence;
  for (const QuaternionOrder order : {QuaternionOrder::kXyzw, QuaternionOrder::kWxyz}) {
    const auto index = static_cast<std::size_t>(order);
    Vector3d upright = Vector3d::Zero();
    LowestSlip slip(2), slip_if_y_up(1);
    std::vector<Vector3d> now(points.size());
    const std::size_t step = std::max<std::size_t>(1, raw.frames / kFramesTried);
    // Slip needs consecutive frames, so sample whole runs of frames.
    for (std::size_t frame = 0; frame < raw.frames; ++frame) {
      const Quaterniond rotation = rotation_at(raw, frame, order);
      upright += rotation * up;
      if (step > 1 && (frame / 30) % step != 0) {
        slip.interrupt();
        slip_if_y_up.interrupt();
        continue;
      }
      const auto from = configurations.qpos(static_cast<int>(frame));
      std::vector<double> qpos(from.begin(), from.end());
      set_root_rotation(qpos, rotation);
      forward_kinematics(robot, qpos, world_from_body);
      for (std::size_t i = 0; i < points.size(); ++i) {
        now[i] = world_from_body[points[i].body] * points[i].place;
      }
      slip.add(now);
      slip_if_y_up.add(now);
    }
    evidence.upright[index] = upright.z() / static_cast<double>(raw.frames);
    evidence.slip[index] = slip.mean();
    evidence.upright_if_y_up[index] = upright.y() / static_cast<double>(raw.frames);
    evidence.slip_if_y_up[index] = slip_if_y_up.mean();
  }
  return evidence;
}

OrderGuess guess_order(const OrderEvidence& evidence, QuaternionOrder usual) {
  const auto other = [](QuaternionOrder order) {
    return order == QuaternionOrder::kXyzw ? QuaternionOrder::kWxyz : QuaternionOrder::kXyzw;
  };
  const auto pair_text = [](double of_xyzw, double of_wxyz, const char* unit) {
    return number_text(of_xyzw, 2) + unit + " as xyzw, " + number_text(of_wxyz, 2) + unit +
           " as wxyz";
  };
  OrderGuess guess;
  const double* up = evidence.upright;
  const double* slip = evidence.slip;
  const auto upper = up[0] >= up[1] ? QuaternionOrder::kXyzw : QuaternionOrder::kWxyz;
  const double highest = std::max(up[0], up[1]);
  // A file with y up, whose other interpretation may stand along z.
  for (const QuaternionOrder order : {QuaternionOrder::kXyzw, QuaternionOrder::kWxyz}) {
    const auto index = static_cast<std::size_t>(order);
    const double least = std::min(slip[0], slip[1]);
    const double slip_if_y_up = evidence.slip_if_y_up[index];
    if (evidence.upright_if_y_up[index] <= kStands || least <= kSlips ||
        slip_if_y_up >= kClearlyLess * least) {
      continue;
    }
    guess.order = order;
    guess.reason = "the root stands upright along y, where the lowest foot slips by " +
                   number_text(1000.0 * slip_if_y_up, 2) + " mm per frame";
    return guess;
  }
  const auto steadier = slip[0] <= slip[1] ? QuaternionOrder::kXyzw : QuaternionOrder::kWxyz;
  const double max = std::max(slip[0], slip[1]);
  const bool clearly_steadier = max > kSlips && std::min(slip[0], slip[1]) < kClearlyLess * max;
  const std::string upright_text =
      "the vertical component of the root's up axis is " + pair_text(up[0], up[1], "");
  const std::string slip_text =
      "the lowest foot slips by " + pair_text(1000.0 * slip[0], 1000.0 * slip[1], " mm per frame");
  if (highest > kStands && highest - std::min(up[0], up[1]) > kClearlyUpright) {
    guess.reason = upright_text;
    // A robot that lies may stand upright in the wrong order, but its feet slip then.
    guess.contradictory =
        upper != usual && clearly_steadier && steadier == usual && max > kStandsStill;
    if (guess.contradictory) {
      guess.reason += ", but " + slip_text;
    } else {
      guess.order = upper;
    }
    return guess;
  }
  if (clearly_steadier) {
    guess.order = steadier;
    guess.reason = slip_text;
    return guess;
  }
  // Both fit. Choose the usual order: a robot turned by half a turn throughout is less likely.
  if (max < kStandsStill && up[static_cast<std::size_t>(usual)] > kStands &&
      up[static_cast<std::size_t>(other(usual))] > kStands) {
    guess.order = usual;
    guess.reason = "both orders fit, and this is the usual one";
  }
  return guess;
}

OrderGuess order_of_fixed_base(const Robot& robot, const RawMotion& raw) {
  // Radians; large enough for CSVs with few digits.
  constexpr double kSame = 0.02;
  const std::vector<double> zero = robot.zero_configuration();
  const Quaterniond base = root_rotation(zero).normalized();
  const auto fits = [&](QuaternionOrder order) {
    for (std::size_t frame = 0; frame < raw.frames; ++frame) {
      if (log_so3(rotation_at(raw, frame, order).conjugate() * base).norm() > kSame) return false;
    }
    return true;
  };
  OrderGuess guess;
  const auto other =
      raw.usual == QuaternionOrder::kXyzw ? QuaternionOrder::kWxyz : QuaternionOrder::kXyzw;
  if (fits(raw.usual)) {
    guess.order = raw.usual;
  } else if (fits(other)) {
    guess.order = other;
  }
  guess.reason = "so the root has the rotation of the robot's fixed base";
  return guess;
}

std::vector<TouchPoint> touch_points(const Robot& robot) {
  std::vector<TouchPoint> points;
  for (const Sole& sole : robot.profile().soles) {
    for (const Eigen::Vector3d& point : sole.points) points.push_back({sole.body, point});
  }
  if (!points.empty()) return points;
  for (std::size_t b = 1; b < robot.bodies().size(); ++b) {
    points.push_back({static_cast<int>(b), Eigen::Vector3d::Zero()});
  }
  return points;
}

}  // namespace retarget
