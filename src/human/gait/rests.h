#pragma once

#include <Eigen/Core>
#include <vector>

#include "human/gait/contact_plan.h"
#include "human/gait/source_feet.h"
#include "human/skeleton/human_clip.h"
#include "retarget/clip.h"

namespace retarget {

/// The part of a human that rests on a surface.
enum class RestKind : unsigned char { kStep, kSeat, kHand };

/// A human rests on a surface.
struct RaisedRest {
  RestKind kind = RestKind::kStep;
  FrameRange frames;
  double height = 0.0;                   ///< Of the surface; world, metres.
  std::vector<Eigen::Vector2d> outline;  ///< Points that the surface supports; world, metres.
};

/// Feet, contacts and poses of a human.
struct RestingHuman {
  const HumanClip* human = nullptr;
  SourceFeet feet;
  ContactPlan contacts;
};

/// Finds stances, seats and rests of hands above the floor (scene_from_motion.h), by time.
[[nodiscard]] std::vector<RaisedRest> find_raised_rests(const RestingHuman& of);

/// Points of the feet in all stances, with the heights on which they stand.
struct Footing {
  Eigen::Vector2d point = Eigen::Vector2d::Zero();
  double height = 0.0;
};
[[nodiscard]] std::vector<Footing> find_footings(const RestingHuman& of);

}  // namespace retarget
