#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "refine/fit_model.h"

namespace retarget {

/// Thigh and shank of the body that lengths and speeds of FitOptions are for, metres.
inline constexpr double kUsualSourceLeg = 0.85;

/// The feet of the source in one frame.
struct SourceFoot {
  Eigen::Vector3d ankle = Eigen::Vector3d::Zero();  ///< World, metres.
  Eigen::Vector3d toe = Eigen::Vector3d::Zero();
  double up = 1.0;    ///< Height of the unit vector that points up from a standing foot.
  double side = 0.0;  ///< The same of the one to its side.

  /// @param end  kHeel (the ankle) or kToe.
  [[nodiscard]] const Eigen::Vector3d& end(int end) const { return end == kHeel ? ankle : toe; }
};

/// Feet and legs of the source over a clip, by the robot's feet.
struct SourceFeet {
  double frame_time = 1.0 / 30.0;
  double leg_length = kUsualSourceLeg;  ///< Thigh and shank, metres.
  std::vector<SourceFoot> feet;         ///< Frame-major, foot_count a frame.
  int foot_count = 0;
  std::vector<double> hips;  ///< Their height by frame, metres; empty: not known.

  [[nodiscard]] int frame_count() const {
    return foot_count == 0 ? 0 : static_cast<int>(feet.size()) / foot_count;
  }
  [[nodiscard]] const SourceFoot& at(int frame, int foot) const {
    return feet[static_cast<std::size_t>(frame) * static_cast<std::size_t>(foot_count) +
                static_cast<std::size_t>(foot)];
  }
  /// What lengths and speeds of FitOptions are multiplied by.
  [[nodiscard]] double size() const { return leg_length / kUsualSourceLeg; }
  /// Speed of one end of a foot over a short time about the frame, m/s.
  [[nodiscard]] double speed(int frame, int foot, int end) const;
};

/// Heights at which the source's feet stand.
struct StandingHeights {
  double ankle = 0.0, toe = 0.0;  ///< World, metres.
  bool found = false;             ///< False: no foot stands long enough; a guess.

  [[nodiscard]] double of(int end) const { return end == kHeel ? ankle : toe; }
};

}  // namespace retarget
