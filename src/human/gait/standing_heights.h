#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "human/gait/contact_plan.h"
#include "human/gait/source_feet.h"

namespace retarget {

/// Returns the height of the floor on which the feet of a plan stand, metres.
[[nodiscard]] double floor_height(const ContactPlan& contacts);

/// Height of the toe joint of a standing foot above the floor, metres.
inline constexpr double kToeHeight = 0.02;

/// Least height of the rest of a body above the hands on which it stands, metres.
inline constexpr double kAloft = 0.3;

/// Returns the largest height of a support's joint above the floor when the body lies, kneels,
/// leans or sits on it, metres.
/// @param support  index into kSupportBones.
/// @param scale    scale of lengths, as ContactPlan::scale.
[[nodiscard]] double rest_height(std::size_t support, double scale);

/// Returns the height of the floor on which the lowest part of the body rests in a frame, metres;
/// infinite for a body without known parts.
/// @param scale  scale of lengths, as ContactPlan::scale.
[[nodiscard]] double floor_below_lowest(const SourceFeet& source, int frame, double scale);

/// find_standing_heights() for repeated use: keeps its memory.
class StandingHeightFinder {
 public:
  /// @param scale  scale of lengths and speeds, as ContactPlan::scale.
  [[nodiscard]] StandingHeights find(const SourceFeet& source, double scale,
                                     const ContactOptions& options);
  /// Reserves memory so that find() does not allocate for this many frames.
  void reserve(int frames);

 private:
  // A foot in a frame in which it is as slow and as steep as a supporting foot.
  struct StandingFoot {
    int frame = 0, foot = 0;
    double ankle = 0.0,
           toe = 0.0;  // Heights; with a known sole, `ankle` refers to the heel.
    bool upright = true;
  };
  using Feet = std::span<const StandingFoot>;

  template <typename IsLikeStanding>
  void find_slow_feet(const SourceFeet& source, double speed,
                      const IsLikeStanding& is_like_standing);
  void find_feet_that_stand(const SourceFeet& source, double speed, double size);
  [[nodiscard]] static Feet between(Feet standing, double from, double to);
  [[nodiscard]] static bool carries(Feet level, double frame_time);
  [[nodiscard]] static bool is_a_moment(Feet level, std::size_t standing, double frame_time);
  [[nodiscard]] static bool is_only_passed(Feet level, const SourceFeet& source, double size);
  [[nodiscard]] Feet feet_on_floor(const SourceFeet& source, double lowest, double size);
  [[nodiscard]] double low_height(const SourceFeet& source, int end);
  [[nodiscard]] double middle_height(Feet feet, double StandingFoot::*height);
  [[nodiscard]] double guessed_rise(const SourceFeet& source, double floor, double size,
                                    const ContactOptions& options);
  [[nodiscard]] std::optional<double> floor_below_body(const SourceFeet& source, double toe,
                                                       double size);
  [[nodiscard]] StandingHeights heights_of_ends(const SourceFeet& source, double size,
                                                const ContactOptions& options);

  std::vector<StandingFoot> slow_;
  std::vector<double> values_;
};

/// Maximum movement of the joint of a resting body part before the part slides, for a body with
/// legs of kUsualSourceLeg, metres: joints lie above the floor, so they move while a part rolls in
/// place.
inline constexpr double kRestingRadius = 0.04;

/// Separates the slide of a body part over the floor from movements in place. The part stays where
/// it is while its joint is within `radius` of the middle; beyond it, the joint pulls the middle
/// along.
class SlideTracker {
 public:
  SlideTracker(const Eigen::Vector3d& joint, double radius)
      : begin_(joint.head<2>()), middle_(begin_), radius_(radius) {}

  /// Takes the joint's next position. @return the slide so far, world x and y, metres.
  Eigen::Vector2d follow(const Eigen::Vector3d& joint) {
    const Eigen::Vector2d away = joint.head<2>() - middle_;
    const double distance = away.norm();
    if (distance > radius_) middle_ += (distance - radius_) / distance * away;
    return middle_ - begin_;
  }

 private:
  Eigen::Vector2d begin_, middle_;
  double radius_;
};

}  // namespace retarget
