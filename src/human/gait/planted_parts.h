#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "human/gait/end_tracks.h"
#include "human/gait/source_feet.h"

namespace retarget {

/// Feet and hands that stand still in the world while the body moves past them, and feet that the
/// body carries. Speeds refer to a body with legs of kUsualSourceLeg, over about a third of a
/// second.
///
/// The stillest foot or hand that moves relative to the body shows how fast the root drifts. A foot
/// that moves with the body much faster is not one that stands while the root drifts: the body
/// climbs, hangs, jumps or swings between crutches.
class PlantedParts {
 public:
  /// @param hips  hip positions by frame; world, metres
  PlantedParts(const SourceFeet& feet, const EndTracks& tracks,
               const std::vector<Eigen::Vector3d>& hips);

  /// Usual speed of the stillest part, m/s; 0: the parts hardly move relative to the body, so that
  /// nothing is known about the root, and no foot is planted or carried.
  [[nodiscard]] double root_speed() const { return root_speed_; }
  /// Whether a foot moves relative to the body, but hardly in the world.
  [[nodiscard]] bool is_planted(int foot, std::size_t i) const;
  /// Whether a foot moves with the body or faster, and much faster than planted parts.
  [[nodiscard]] bool is_carried(int foot, std::size_t i) const;

 private:
  struct PartSpeeds {
    std::vector<double> in_world, from_body;
    std::vector<double> with_body;  // Share of the body's velocity that the part has.
  };

  [[nodiscard]] PartSpeeds speeds_of(const std::vector<Eigen::Vector3d>& places,
                                     const std::vector<Eigen::Vector3d>& body) const;
  // Of the parts that move relative to the body, the least speed by frame; infinite: there are none.
  [[nodiscard]] std::vector<double> least_speeds(const std::vector<PartSpeeds>& hands) const;

  double frame_time_;
  std::array<PartSpeeds, 2> feet_;
  std::vector<char> has_planted_;  // One per frame: whether any part is planted.
  double root_speed_ = 0.0;
};

}  // namespace retarget
