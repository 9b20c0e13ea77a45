#pragma once

#include <Eigen/Core>

namespace retarget {

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
