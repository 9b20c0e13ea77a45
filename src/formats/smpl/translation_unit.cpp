#include "formats/smpl/motion_arrays.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "retarget/so3.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

constexpr int kLeftToeJoint = 10, kRightToeJoint = 11;

struct UnitName {
  double metres;
  const char* name;
};
constexpr std::array<UnitName, 2> kUnits = {{{0.01, "centimetres"}, {0.001, "millimetres"}}};

// Positions of both feet relative to the body's origin, in world axes, metres.
using Feet = std::array<Eigen::Vector3d, 2>;

Feet feet_of(const MotionArrays& arrays, const SmplRestBody& body, int frame) {
  std::array<Eigen::Quaterniond, kSmplJointCount> world;
  std::array<Eigen::Vector3d, kSmplJointCount> place;
  const std::size_t first = static_cast<std::size_t>(frame) * kSmplJointCount;
  for (int joint = 0; joint <= kRightToeJoint; ++joint) {
    const int parent = kSmplParents[joint];
    const Eigen::Quaterniond local = exp_so3(arrays.rotations[first + joint]);
    world[joint] = parent < 0 ? local : world[parent] * local;
    place[joint] = parent < 0
                       ? body.joints[0]
                       : place[parent] + world[parent] * (body.joints[joint] - body.joints[parent]);
  }
  return {place[kLeftToeJoint], place[kRightToeJoint]};
}

// Statistics of a clip for a given unit of `trans`.
class Figures {
 public:
  Figures(const MotionArrays& arrays, const SmplRestBody& body) : arrays_(arrays) {
    feet_.reserve(static_cast<std::size_t>(arrays.frame_count));
    for (int frame = 0; frame < arrays.frame_count; ++frame) {
      feet_.push_back(feet_of(arrays, body, frame));
    }
  }

  // Median speed of the slower foot, m/s.
  [[nodiscard]] double slower_foot(double metres) const {
    std::vector<double> speeds;
    for (int frame = 1; frame < arrays_.frame_count; ++frame) {
      double slower = std::numeric_limits<double>::infinity();
      for (std::size_t side = 0; side < 2; ++side) {
        slower =
            std::min(slower, (foot(frame, side, metres) - foot(frame - 1, side, metres)).norm());
      }
      speeds.push_back(slower * arrays_.rate.fps());
    }
    return speeds.empty() ? 0.0 : median(speeds);
  }

  // Median height of the lower foot along an axis.
  [[nodiscard]] double level(int axis, double metres) const {
    std::vector<double> levels;
    for (int frame = 0; frame < arrays_.frame_count; ++frame) {
      levels.push_back(std::min(foot(frame, 0, metres)[axis], foot(frame, 1, metres)[axis]));
    }
    return median(levels);
  }

 private:
  [[nodiscard]] Eigen::Vector3d foot(int frame, std::size_t side, double metres) const {
    return metres * arrays_.translations[static_cast<std::size_t>(frame)] +
           feet_[static_cast<std::size_t>(frame)][side];
  }

  const MotionArrays& arrays_;
  std::vector<Feet> feet_;
};

// The axis along which the body stands on average.
int upright_axis(const MotionArrays& arrays) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int frame = 0; frame < arrays.frame_count; ++frame) {
    const std::size_t root = static_cast<std::size_t>(frame) * kSmplJointCount;
    sum += exp_so3(arrays.rotations[root]) * Eigen::Vector3d::UnitY();
  }
  int axis = 0;
  sum.cwiseAbs().maxCoeff(&axis);
  return axis;
}

}  // namespace

std::optional<DegreesFound> find_degrees(const std::vector<Eigen::Vector3d>& rotations) {
  // Some tools write rotations of more than a turn; two and a half are 16 degrees if read as such.
  constexpr double kMostRadians = 2.5 * 6.28318530717958647693;
  // Fewer joints, or a smaller part of the frames, may be faults of a fit.
  constexpr std::size_t kJointsBeyond = 3, kPartOfFrames = 20;
  const std::size_t frames = rotations.size() / kSmplJointCount;
  DegreesFound found;
  for (std::size_t joint = 1; joint < kSmplJointCount; ++joint) {
    std::size_t beyond = 0;
    for (std::size_t frame = 0; frame < frames; ++frame) {
      const Eigen::Vector3d& turn = rotations[frame * kSmplJointCount + joint];
      if (turn.norm() <= kMostRadians) continue;
      ++beyond;
      int axis = 0;
      if (!(turn.cwiseAbs().maxCoeff(&axis) > std::abs(found.value))) continue;
      found.value = turn[axis];
      found.frame = frame;
      found.joint = kSmplJointNames[joint];
    }
    if (kPartOfFrames * beyond >= frames) ++found.joints;
  }
  return found.joints >= kJointsBeyond ? std::optional(found) : std::nullopt;
}

std::optional<TranslationUnit> find_translation_unit(const MotionArrays& arrays,
                                                     const SmplRestBody& body) {
  // The fastest runners reach 12 m/s, with one foot at rest in every step; wheels may be faster.
  constexpr double kTooFast = 20.0, kPossible = 4.0;
  constexpr double kFarOff = 10.0, kOnFloor = 0.4;
  constexpr double kSame = 1.1, kNoise = 0.05;
  const Figures figures(arrays, body);
  const double speed = figures.slower_foot(1.0);
  const int up = upright_axis(arrays);
  const double level = figures.level(up, 1.0);
  const bool too_fast = speed > kTooFast, far_off = std::abs(level) > kFarOff;
  if (!too_fast && !far_off) return std::nullopt;

  // Of the units that explain the data, prefer one with feet on the floor, then the slower one.
  const UnitName* best = nullptr;
  bool best_on_floor = false;
  double best_speed = speed;
  for (const UnitName& unit : kUnits) {
    const double other = figures.slower_foot(unit.metres);
    const bool on_floor = std::abs(figures.level(up, unit.metres)) < kOnFloor;
    // On a hill, only metres keep a foot at rest.
    const bool explains =
        too_fast ? other < kPossible : on_floor && other <= kSame * speed + kNoise;
    if (!explains) continue;
    const bool better = on_floor != best_on_floor ? on_floor : other < best_speed;
    if (best != nullptr && !better) continue;
    best = &unit;
    best_on_floor = on_floor;
    best_speed = other;
  }
  if (best == nullptr) return std::nullopt;
  const std::string why =
      too_fast ? fmt::format(
                     "in metres the slower foot would have {:.0f} m/s half of the time, "
                     "instead of {:.2f}",
                     speed, best_speed)
               : fmt::format("in metres the feet would be at a height of {:.0f} m", level);
  return TranslationUnit{best->metres,
                         fmt::format("assuming that trans is in {}: {}", best->name, why)};
}

}  // namespace retarget
