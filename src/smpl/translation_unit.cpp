#include "smpl/translation_unit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "math/so3.h"
#include "math/statistics.h"

namespace retarget {
namespace {

constexpr int kLeftToeJoint = 10, kRightToeJoint = 11;

struct UnitName {
  double metres;
  const char* name;
};
constexpr std::array<UnitName, 2> kUnits = {{{0.01, "centimetres"}, {0.001, "millimetres"}}};

// where both feet are from the body's origin, in the world's axes, metres
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

// figures of a clip with `trans` in a unit
class Figures {
 public:
  Figures(const MotionArrays& arrays, const SmplRestBody& body) : arrays_(arrays) {
    feet_.reserve(static_cast<std::size_t>(arrays.frame_count));
    for (int frame = 0; frame < arrays.frame_count; ++frame) {
      feet_.push_back(feet_of(arrays, body, frame));
    }
  }

  // of the slower foot, m/s, the median over the clip
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

  // of the lowest foot along an axis, as far from 0 as it is in half of the frames
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

// the axis along which the body stands on average
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

std::optional<TranslationUnit> find_translation_unit(const MotionArrays& arrays,
                                                     const SmplRestBody& body) {
  // the fastest runner has 12 m/s, and a foot at rest in every step; wheels carry people so fast
  constexpr double kTooFast = 20.0, kPossible = 4.0;
  constexpr double kFarOff = 10.0, kOnFloor = 0.4;
  constexpr double kSame = 1.1, kNoise = 0.05;
  const Figures figures(arrays, body);
  const double speed = figures.slower_foot(1.0);
  const int up = upright_axis(arrays);
  const double level = figures.level(up, 1.0);
  const bool too_fast = speed > kTooFast, far_off = std::abs(level) > kFarOff;
  if (!too_fast && !far_off) return std::nullopt;

  // of both units that explain the figures the one that puts the feet on the floor, else the calmer
  const UnitName* best = nullptr;
  bool best_on_floor = false;
  double best_speed = speed;
  for (const UnitName& unit : kUnits) {
    const double other = figures.slower_foot(unit.metres);
    const bool on_floor = std::abs(figures.level(up, unit.metres)) < kOnFloor;
    // who walks on a hill has a foot at rest in metres alone
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
  return TranslationUnit{best->metres, fmt::format("trans was taken as {}: {}", best->name, why)};
}

}  // namespace retarget
