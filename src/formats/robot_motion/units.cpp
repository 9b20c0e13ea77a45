#include "formats/robot_motion/raw_motion.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/option_name.h"
#include "base/try.h"
#include "retarget/pose.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr double kHalfTurn = 3.14159265358979323846;
// Radians beyond a joint range from which the unit is doubted.
constexpr double kBeyondRange = 0.5;
// Root heights relative to the robot's reach: a warning if the root is never below the first, an
// error if it ever exceeds the second.
constexpr double kOddReaches = 2.5;
constexpr double kMaxReaches = 5.0;
// The root counts as upright if its z axis is within 45 degrees of vertical. If it is upright in
// most frames, the robot stands or walks, and its height is compared with the reach of the legs.
constexpr double kUpright = 0.70710678118654752;
constexpr double kMinUprightReaches = 0.15;
constexpr double kLowUprightReaches = 0.35;
// Depth of the soles below the floor that confirms a low root; a sitting robot stays above it.
constexpr double kSunkReaches = 0.2;
constexpr double kHighUprightReaches = 1.6;
// Quantile of the height over upright frames; the others may be a fall or the start.
constexpr double kUprightQuantile = 0.95;
// Mean speed in m/s that no runner sustains.
constexpr double kMaxMeanSpeed = 10.0;

// Radians. Hinges without a range may turn this far before the values suggest degrees.
constexpr double kTurnsOfUnlimited = 8.0 * kHalfTurn;

// The largest absolute limit of any hinge with a range, at least half a turn.
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

// Distance of each body from the root along the kinematic chain, metres.
std::vector<double> chain_lengths(const Robot& robot) {
  std::vector<double> lengths(robot.bodies().size(), 0.0);
  for (std::size_t b = 1; b < lengths.size(); ++b) {
    const RobotBody& body = robot.bodies()[b];
    if (static_cast<int>(b) == robot.root_body() || body.parent == 0) continue;
    lengths[b] = lengths[body.parent] + body.parent_from_body.translation.norm();
  }
  return lengths;
}

// Reach of the robot: the longest chain of bodies from the root, metres. The height in the zero
// configuration would not do, because the robot may be folded there.
double reach_of(const Robot& robot) {
  constexpr double kMinMagnitude = 0.05;
  return std::max(std::ranges::max(chain_lengths(robot)), kMinMagnitude);
}

// Distance of the soles from the root with stretched legs; without soles, the robot's reach.
double leg_reach_of(const Robot& robot) {
  const std::vector<double> lengths = chain_lengths(robot);
  double longest = 0.0;
  for (const Sole& sole : robot.profile().soles) {
    longest = std::max(longest, lengths[sole.body]);
  }
  return longest > 0.0 ? longest : reach_of(robot);
}

// Whether the bodies of a file confirm that its lengths are in metres, and where its root is.
bool have_places_in_world(const RawMotion& raw) {
  return !raw.places.bodies.empty() && !raw.places.of_root;
}

// How the unit of lengths or angles is known, for messages.
std::string source_of_unit(const RawMotion& raw, const std::string& unit) {
  return raw.units_of_format ? "the format " + std::string(format_name(raw.format)) + " has " + unit
                             : "the file names no unit, so " + unit + " are assumed";
}

// A remedy with an option that NPZ files do not accept.
std::string unit_hint(const RawMotion& raw, const std::string& option,
                      const std::string& otherwise) {
  return format_ending(raw.format) == ".npz" ? otherwise : option;
}

class UnitFinder {
 public:
  UnitFinder(const Robot& robot, const std::string& file, const ReadMotionOptions& options,
             RawMotion& raw)
      : robot_(robot), file_(file), options_(options), raw_(raw) {}

  Result<void> find_angle_unit() {
    if (options_.degrees) {
      if (raw_.degrees && *raw_.degrees != *options_.degrees) {
        note_other_unit("angles", *raw_.degrees ? "degrees" : "radians",
                        *options_.degrees ? "degrees" : "radians");
      }
      raw_.degrees = options_.degrees;
      return {};
    }
    if (raw_.degrees && !raw_.units_of_format) return {};
    const double widest = widest_angle(robot_);
    // Of the values beyond the range of their own joint.
    double largest = 0.0;
    std::size_t where = 0;
    const auto weigh = [&](double value, double allowed, std::size_t at) {
      if (std::abs(value) <= std::max(allowed, largest)) return;
      largest = std::abs(value);
      where = at;
    };
    for (std::size_t i = 0; i < raw_.joints.size(); ++i) {
      const std::size_t column = i % raw_.joint_count;
      if (!is_hinge(column)) continue;
      weigh(raw_.joints[i], has_range(column) ? widest + kBeyondRange : kTurnsOfUnlimited, i);
    }
    for (const double angle : raw_.euler) weigh(angle, widest + kBeyondRange, 0);
    if (largest > 0.0 && raw_.units_of_format) return joint_beyond_format(where, widest);
    if (largest > 0.0) {
      return input_failure(
          file_,
          "the largest joint value is " + number_text(largest, 3) +
              ", which may be radians or degrees: the robot's joints reach " +
              number_text(widest, 2) + " rad, and the file names no unit",
          "choose with " OPTION("source-angles") " rad or " OPTION("source-angles") " deg");
    }
    // Bodies confirm or refute the unit.
    if (raw_.places.bodies.empty()) doubt_radians();
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
    if (raw_.metres_per_unit && (!raw_.units_of_format || have_places_in_world(raw_))) return {};
    if (robot_.fixed_base() && is_at_fixed_base()) {
      raw_.metres_per_unit = 1.0;
      return {};
    }
    double highest = 0.0;
    std::size_t highest_frame = 0;
    for (std::size_t frame = 0; frame < raw_.frames; ++frame) {
      const double height = std::abs(raw_.position[3 * frame + 2]);
      if (height > highest) highest_frame = frame;
      highest = std::max(highest, height);
    }
    const double reach = reach_of(robot_);
    if (highest > kMaxReaches * reach && raw_.units_of_format) {
      return input_failure(file_,
                           "the root is " + number_text(highest, 2) + " m high in frame " +
                               std::to_string(highest_frame) + ", but the robot's limbs reach " +
                               number_text(reach, 2) + " m, and " + source_of_unit(raw_, "metres") +
                               ": is it in centimetres or millimetres?",
                           unit_hint(raw_,
                                     OPTION("source-unit") " cm or mm reads these, " OPTION(
                                         "source-unit") " m confirms metres",
                                     "convert the positions to metres first"));
    }
    if (highest > kMaxReaches * reach) {
      return input_failure(file_,
                           "the root is up to " + number_text(highest, 2) +
                               " high, which may be metres, centimetres or millimetres: the "
                               "robot's limbs reach " +
                               number_text(reach, 2) + " m, and the file names no unit",
                           "choose with " OPTION("source-unit") " m, cm or mm");
    }
    raw_.metres_per_unit = 1.0;
    return {};
  }

 private:
  // Whether the root is at the model's fixed base, assuming metres.
  [[nodiscard]] bool is_at_fixed_base() const {
    constexpr double kSame = 0.01;
    const std::vector<double> zero = robot_.zero_configuration();
    for (std::size_t i = 0; i < raw_.position.size(); ++i) {
      if (std::abs(raw_.position[i] - zero[i % 3]) > kSame) return false;
    }
    return true;
  }

  // The error for a file that contradicts its format.
  // @param where  index of the value in RawMotion::joints.
  [[nodiscard]] Failure joint_beyond_format(std::size_t where, double widest) const {
    const std::size_t column = where % raw_.joint_count;
    const auto joint = static_cast<std::size_t>(raw_.joint_indices[column]);
    const LimitSet& limits = robot_.model_limits();
    const std::string reach = has_range(column)
                                  ? "it turns from " + number_text(limits.lower[joint], 2) +
                                        " to " + number_text(limits.upper[joint], 2) + " rad"
                                  : "the robot's joints reach " + number_text(widest, 2) + " rad";
    return input_failure(file_,
                         robot_.joints()[joint].name + " is " + number_text(raw_.joints[where], 3) +
                             " in frame " + std::to_string(where / raw_.joint_count) + ", but " +
                             reach + ", and " + source_of_unit(raw_, "radians") +
                             ": are these degrees?",
                         unit_hint(raw_,
                                   OPTION("source-angles") " deg reads degrees, " OPTION(
                                       "source-angles") " rad confirms radians",
                                   "convert the joints to radians first"));
  }

  // Small motions in degrees may pass for large ones in radians; warn about values beyond a joint's
  // range.
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
        " % of frames, most " + robot_.joints()[joint].name + "; " +
        source_of_unit(raw_, "radians") +
        unit_hint(raw_, ": " OPTION("source-angles") " deg selects degrees", ""));
  }

  void note_other_unit(const std::string& what, const std::string& own, const std::string& taken) {
    raw_.warnings.push_back("by its format or header the file has " + what + " in " + own +
                            "; using the requested " + taken);
  }

  [[nodiscard]] bool has_range(std::size_t column) const {
    const auto joint = static_cast<std::size_t>(raw_.joint_indices[column]);
    const LimitSet& limits = robot_.model_limits();
    return std::isfinite(limits.lower[joint]) && std::isfinite(limits.upper[joint]);
  }

  [[nodiscard]] bool is_hinge(std::size_t column) const {
    const auto joint = static_cast<std::size_t>(raw_.joint_indices[column]);
    return robot_.joints()[joint].type == RobotJoint::Type::kHinge;
  }

  const Robot& robot_;
  const std::string& file_;
  const ReadMotionOptions& options_;
  RawMotion& raw_;
};

// A frame in which the root is upright.
struct UprightFrame {
  double height;  // Absolute height of the root.
  int frame;
};

// Sorted by height.
std::vector<UprightFrame> upright_frames(const RobotClip& clip) {
  std::vector<UprightFrame> frames;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto qpos = clip.qpos(frame);
    const double up = 1.0 - 2.0 * (qpos[4] * qpos[4] + qpos[5] * qpos[5]);
    if (up > kUpright) frames.push_back({std::abs(qpos[2]), frame});
  }
  std::ranges::sort(frames, {}, &UprightFrame::height);
  return frames;
}

// Whether the soles are far below the floor in most of these frames.
bool has_sunk(const RobotClip& clip, const std::vector<UprightFrame>& frames, double reach) {
  constexpr std::size_t kTried = 200;
  const std::vector<TouchPoint> points = touch_points(clip.robot());
  std::vector<Pose> world_from_body(clip.robot().bodies().size());
  std::size_t tried = 0, sunk = 0;
  for (std::size_t i = 0; i < frames.size();
       i += std::max<std::size_t>(1, frames.size() / kTried)) {
    forward_kinematics(clip.robot(), clip.qpos(frames[i].frame), world_from_body);
    double lowest = INFINITY;
    for (const TouchPoint& point : points) {
      const Pose& body = world_from_body[point.body];
      lowest = std::min(lowest, (body * point.place).z());
    }
    ++tried;
    if (lowest < -kSunkReaches * reach) ++sunk;
  }
  return 2 * sunk > tried;
}

double lowest_height(const RobotClip& clip) {
  double lowest = INFINITY;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    lowest = std::min(lowest, std::abs(clip.qpos(frame)[2]));
  }
  return lowest;
}

// Mean speed of the root, m/s.
double mean_speed(const RobotClip& clip) {
  if (clip.frame_count() < 2) return 0.0;
  double path = 0.0;
  for (int frame = 1; frame < clip.frame_count(); ++frame) {
    const auto now = clip.qpos(frame), before = clip.qpos(frame - 1);
    double square = 0.0;
    for (std::size_t i = 0; i < 3; ++i) square += (now[i] - before[i]) * (now[i] - before[i]);
    path += std::sqrt(square);
  }
  return path / (clip.frame_count() - 1) * clip.rate().fps();
}

}  // namespace

Result<void> find_units(const Robot& robot, const std::string& file,
                        const ReadMotionOptions& options, RawMotion& raw) {
  UnitFinder finder(robot, file, options, raw);
  TRY(finder.find_angle_unit());
  return finder.find_length_unit();
}

Result<void> check_assumed_metres(const RobotClip& clip, const std::string& file, RawMotion& raw) {
  // The height of a fixed base comes from the model and does not indicate the unit.
  if (clip.frame_count() == 0 || clip.robot().fixed_base() || have_places_in_world(raw)) return {};
  const auto doubt = [&](const std::string& what, const std::string& remedy) {
    raw.warnings.push_back(what + "; " + source_of_unit(raw, "metres") +
                           unit_hint(raw, ": " OPTION("source-unit") " " + remedy, ""));
  };
  const double reach = leg_reach_of(clip.robot());
  const std::vector<UprightFrame> frames = upright_frames(clip);
  const bool upright = 2 * frames.size() > static_cast<std::size_t>(clip.frame_count());
  if (upright) {
    const auto index =
        static_cast<std::size_t>(kUprightQuantile * static_cast<double>(frames.size()));
    const double height = frames[std::min(index, frames.size() - 1)].height;
    const bool low = height < kLowUprightReaches * reach && has_sunk(clip, frames, reach);
    const std::string what = "the root is upright and only " + number_text(height, 4) +
                             " m high, but the robot's legs reach " + number_text(reach, 2) + " m";
    if (low && height < kMinUprightReaches * reach) {
      return input_failure(file, what + "; lengths may not be in metres",
                           unit_hint(raw,
                                     "to confirm, use " OPTION(
                                         "source-unit") " m; else convert the positions to metres, "
                                                        "centimetres or millimetres first",
                                     "convert the positions to metres first"));
    }
    if (low) doubt(what, "m confirms it");
  }
  const double lowest = lowest_height(clip);
  const double odd = upright ? kHighUprightReaches * reach : kOddReaches * reach_of(clip.robot());
  if (lowest > odd) {
    doubt("the root is never lower than " + number_text(lowest, 2) + " m",
          "cm selects centimetres");
  } else if (const double speed = mean_speed(clip); speed > kMaxMeanSpeed) {
    doubt("the root moves at " + number_text(speed, 1) + " m/s on average",
          "cm selects centimetres");
  }
  return {};
}

}  // namespace retarget
