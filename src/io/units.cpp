#include "io/units.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "retarget/base/number_text.h"

namespace retarget {
namespace {

constexpr double kHalfTurn = 3.14159265358979323846;
// radians that a motion may go beyond a range before its unit is doubted
constexpr double kBeyondRange = 0.5;
// the root's height over what the limbs reach: doubted when it is never lower, and refused
constexpr double kOddReaches = 2.5;
constexpr double kMostReaches = 5.0;
// m/s on the mean: no runner keeps it up
constexpr double kFastestMean = 10.0;

// the widest that a hinge of the robot turns from 0
double widest_angle(const Robot& robot) {
  double widest = kHalfTurn;
  const LimitSet& limits = robot.model_limits();
  for (std::size_t j = 0; j < robot.joints().size(); ++j) {
    if (robot.joints()[j].type != RobotJoint::Type::kHinge) continue;
    for (const double limit : {limits.lower[j], limits.upper[j]}) {
      if (std::isfinite(limit)) widest = std::max(widest, std::abs(limit));
    }
  }
  return widest;
}

// how far the robot reaches from its root: the longest chain of bodies, metres. Not how high it
// stands in its zero configuration, which may lie folded.
double reach_of(const Robot& robot) {
  std::vector<double> reach(robot.bodies().size(), 0.0);
  double longest = 0.0;
  for (std::size_t b = 1; b < reach.size(); ++b) {
    const RobotBody& body = robot.bodies()[b];
    if (static_cast<int>(b) == robot.root_body() || body.parent == 0) continue;
    reach[b] =
        reach[static_cast<std::size_t>(body.parent)] + body.parent_from_body.translation.norm();
    longest = std::max(longest, reach[b]);
  }
  constexpr double kSmallest = 0.05;
  return std::max(longest, kSmallest);
}

class UnitFinder {
 public:
  UnitFinder(const Robot& robot, const FrameRate& rate, const std::string& file,
             const ReadMotionOptions& options, RawMotion& raw)
      : robot_(robot), rate_(rate), file_(file), options_(options), raw_(raw) {}

  Result<void> find_angle_unit() {
    if (options_.degrees) {
      if (raw_.degrees && *raw_.degrees != *options_.degrees) {
        note_other_unit("angles", *raw_.degrees ? "degrees" : "radians",
                        *options_.degrees ? "degrees" : "radians");
      }
      raw_.degrees = options_.degrees;
      return {};
    }
    if (raw_.degrees) return {};
    double largest = 0.0;
    for (std::size_t i = 0; i < raw_.joints.size(); ++i) {
      if (is_hinge(i % raw_.joint_count)) largest = std::max(largest, std::abs(raw_.joints[i]));
    }
    for (const double angle : raw_.euler) largest = std::max(largest, std::abs(angle));
    const double widest = widest_angle(robot_);
    if (largest > widest + kBeyondRange) {
      return input_failure(file_,
                           "the largest joint value is " + number_text(largest, 3) +
                               ", which may be radians or degrees: the robot's joints turn up to " +
                               number_text(widest, 2) + " rad, and the file names no unit",
                           "say which with --source-angles rad or --source-angles deg");
    }
    doubt_radians();
    return {};
  }

  Result<void> find_length_unit() {
    if (options_.metres_per_unit) {
      if (raw_.metres_per_unit && *raw_.metres_per_unit != *options_.metres_per_unit) {
        note_other_unit("lengths", "units of " + number_text(*raw_.metres_per_unit, 3) + " m",
                        number_text(*options_.metres_per_unit, 3) + " m");
      }
      raw_.metres_per_unit = options_.metres_per_unit;
      return {};
    }
    if (raw_.metres_per_unit) return {};
    double highest = 0.0, lowest = INFINITY;
    for (std::size_t frame = 0; frame < raw_.frames; ++frame) {
      const double height = std::abs(raw_.position[3 * frame + 2]);
      highest = std::max(highest, height);
      lowest = std::min(lowest, height);
    }
    const double reach = reach_of(robot_);
    if (highest > kMostReaches * reach) {
      return input_failure(file_,
                           "the root is up to " + number_text(highest, 2) +
                               " high, which may be metres, centimetres or millimetres: the "
                               "robot's limbs reach " +
                               number_text(reach, 2) + " m, and the file names no unit",
                           "say which with --source-unit m, cm or mm");
    }
    raw_.metres_per_unit = 1.0;
    if (lowest > kOddReaches * reach) {
      doubt_metres("the root is never lower than " + number_text(lowest, 2) + " m");
    } else if (const double speed = mean_speed(); speed > kFastestMean) {
      doubt_metres("the root moves at " + number_text(speed, 1) + " m/s on the mean");
    }
    return {};
  }

 private:
  // degrees of a motion that moves little may pass for radians of a joint that turns far
  void doubt_radians() {
    const LimitSet& limits = robot_.model_limits();
    std::size_t beyond = 0, worst_column = 0;
    double worst = kBeyondRange;
    for (std::size_t frame = 0; frame < raw_.frames; ++frame) {
      bool is_beyond = false;
      for (std::size_t j = 0; j < raw_.joint_count; ++j) {
        if (!is_hinge(j)) continue;
        const auto joint = static_cast<std::size_t>(raw_.joint_indices[j]);
        const double value = raw_.joints[frame * raw_.joint_count + j];
        const double excess = std::max(value - limits.upper[joint], limits.lower[joint] - value);
        is_beyond = is_beyond || excess > kBeyondRange;
        if (excess > worst) {
          worst = excess;
          worst_column = j;
        }
      }
      beyond += is_beyond ? 1 : 0;
    }
    if (2 * beyond < raw_.frames) return;
    const auto joint = static_cast<std::size_t>(raw_.joint_indices[worst_column]);
    raw_.warnings.push_back(
        "joints are beyond their ranges by more than " + number_text(kBeyondRange, 1) + " rad in " +
        number_text(100.0 * static_cast<double>(beyond) / static_cast<double>(raw_.frames), 0) +
        " % of frames, most " + robot_.joints()[joint].name +
        "; the file names no unit and is taken as radians: --source-angles deg takes degrees");
  }

  void doubt_metres(const std::string& what) {
    raw_.warnings.push_back(what +
                            "; the file names no unit and is taken as metres: --source-unit cm "
                            "takes centimetres");
  }

  // of the root, in units of the file per second
  [[nodiscard]] double mean_speed() const {
    if (raw_.frames < 2) return 0.0;
    double path = 0.0;
    for (std::size_t frame = 1; frame < raw_.frames; ++frame) {
      const double* now = raw_.position.data() + 3 * frame;
      double square = 0.0;
      for (int i = 0; i < 3; ++i) square += (now[i] - now[i - 3]) * (now[i] - now[i - 3]);
      path += std::sqrt(square);
    }
    return path / static_cast<double>(raw_.frames - 1) * rate_.fps();
  }

  void note_other_unit(const std::string& what, const std::string& own, const std::string& taken) {
    raw_.warnings.push_back("by its format or header the file has " + what + " in " + own +
                            "; taken are the " + taken + " that were asked for");
  }

  [[nodiscard]] bool is_hinge(std::size_t column) const {
    const auto joint = static_cast<std::size_t>(raw_.joint_indices[column]);
    return robot_.joints()[joint].type == RobotJoint::Type::kHinge;
  }

  const Robot& robot_;
  const FrameRate rate_;
  const std::string& file_;
  const ReadMotionOptions& options_;
  RawMotion& raw_;
};

}  // namespace

Result<void> find_units(const Robot& robot, const FrameRate& rate, const std::string& file,
                        const ReadMotionOptions& options, RawMotion& raw) {
  UnitFinder finder(robot, rate, file, options, raw);
  if (auto angles = finder.find_angle_unit(); !angles) return angles;
  return finder.find_length_unit();
}

}  // namespace retarget
