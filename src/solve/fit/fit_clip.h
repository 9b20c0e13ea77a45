#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "solve/fit/foot_plan.h"
#include "solve/fit/frame_terms.h"

namespace retarget {

/// The goals and the current solution of a fit.
struct FitClip {
  double frame_time = 1.0 / 30.0;  ///< Seconds.
  int frame_count = 0;
  std::vector<TaskTarget> targets;  ///< Frame-major, one per task of the model.
  FootPlan feet;
  std::vector<Eigen::Vector2d> anchors;   ///< Anchor of each contact phase; world x and y, metres.
  std::vector<double> qpos;               ///< Frame-major, laid out as in RobotClip.
  std::shared_ptr<const FitScene> scene;  ///< Null: none.
  /// Writes the positions of joints that the fit does not move, such as fingers, into the
  /// configuration of a frame; null: these joints are still.
  std::function<void(int frame, std::span<double> qpos)> hold;

  [[nodiscard]] int frames_in(double seconds) const {
    return static_cast<int>(std::lround(seconds / frame_time));
  }
  /// Configuration of frame `t`. @param size  FitModel::configuration_size.
  [[nodiscard]] std::span<double> frame(int t, int size) {
    return {qpos.data() + static_cast<std::size_t>(t) * static_cast<std::size_t>(size),
            static_cast<std::size_t>(size)};
  }
  [[nodiscard]] std::span<const double> frame(int t, int size) const {
    return {qpos.data() + static_cast<std::size_t>(t) * static_cast<std::size_t>(size),
            static_cast<std::size_t>(size)};
  }
  [[nodiscard]] FrameGoals goals(int t, std::size_t tasks) const {
    return {{targets.data() + static_cast<std::size_t>(t) * tasks, tasks},
            feet.ends_of(t),
            feet.upright_of(t),
            anchors,
            1.0,
            feet.supports_of(t),
            feet.lying_of(t),
            scene.get(),
            t};
  }
};

/// Frames that are solved together.
struct FitWindow {
  int begin = 0, end = 0;   ///< Frames [begin, end).
  bool fixed_ends = false;  ///< The adjacent frames are fixed, and the steps to them have a cost.
  int context = 0;          ///< Number of fixed frames on either side used for smoothing.
  bool between_frames = false;  ///< Whether self-collision terms also act half-way between frames.

  /// Whether the window contains the whole contact phase. Only then may it move the phase's anchor.
  [[nodiscard]] bool owns(const PlantedPhase& phase) const {
    return phase.begin >= begin && phase.end <= end;
  }
};

}  // namespace retarget
