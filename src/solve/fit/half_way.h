#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "solve/fit/fit_model.h"

namespace retarget {

/// Distance of the shapes of a pair in a pose, metres; negative if they overlap.
[[nodiscard]] double pair_distance(const FitModel& model, const TreeState& pose,
                                   std::uint32_t pair);

/// Whether the shapes of a pair may pass through each other between two frames: their centres move
/// by more than kPassing relative to each other.
[[nodiscard]] bool may_cross(const FitModel& model, const TreeState& before, const TreeState& now,
                             std::uint32_t pair);

/// The pose half-way between two frames. There, shapes overlap that pass through each other between
/// the frames.
class HalfWay {
 public:
  explicit HalfWay(const FitModel& model);

  /// @param from, to  configurations of the two frames.
  void update(std::span<const double> from, std::span<const double> to);
  [[nodiscard]] const TreeState& pose() const { return pose_; }

 private:
  TreeState pose_;
  std::vector<double> qpos_;
};

}  // namespace retarget
