#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "human/gait/source_feet.h"

namespace retarget {

/// Vertical speed (m/s) and climb through a clip (metres) above which standing feet climb.
inline constexpr double kClimbSpeed = 0.03, kClimb = 0.05;

inline constexpr int kEndCount = 4;  ///< Left heel, left toe, right heel, right toe.

/// Tracks of the ends of both feet, scaled to a body with legs of kUsualSourceLeg.
struct EndTracks {
  explicit EndTracks(const SourceFeet& feet);

  [[nodiscard]] double lower(int foot, std::size_t i) const;
  [[nodiscard]] Eigen::Vector3d velocity(int foot, std::size_t i) const {
    return 0.5 * (velocities[2 * foot][i] + velocities[2 * foot + 1][i]);
  }
  /// Speed at which a foot turns, as the speed of one end about the other.
  [[nodiscard]] double turning(int foot, std::size_t i) const {
    return (velocities[2 * foot][i] - velocities[2 * foot + 1][i]).norm();
  }

  double frame_time, scale = 1.0;
  std::size_t count = 0;
  std::array<std::vector<Eigen::Vector3d>, kEndCount> places, velocities;
  std::array<std::vector<double>, kEndCount>
      heights;  ///< Heels are shifted to the height of the toes of a flat foot.
  std::vector<double> lowest;

 private:
  void level_heel(const SourceFeet& feet, int foot);
  [[nodiscard]] Eigen::Vector3d velocity_of(int end, std::size_t i) const;
};

/// One entry per frame: whether the feet are in free fall with the body, so that none of them
/// stands. The heights of the hips and of the lowest foot follow parabolas of gravity for about a
/// fifth of a second or longer. Includes frames whose velocities in EndTracks overlap with such a
/// fall. If the hips are unknown: none.
[[nodiscard]] std::vector<char> frames_in_free_fall(const SourceFeet& feet,
                                                    const EndTracks& tracks);

/// Whether both feet have ankles and toes, in enough frames.
[[nodiscard]] bool has_whole_feet(const SourceFeet& feet);

}  // namespace retarget
