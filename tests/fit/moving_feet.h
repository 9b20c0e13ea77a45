#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "human/gait/source_feet.h"
#include "solve/fit/foot_plan.h"

namespace retarget {

inline constexpr double kStandingAnkle = 0.09, kStandingToe = 0.02;  // standing heights, metres

// Height and position of a foot over time; both ends are equal.
struct FootPlace {
  double x = 0.0, height = 0.0;
};
using FootPath = std::function<FootPlace(double seconds)>;

// One foot that moves along x.
inline SourceFeet make_feet(double seconds, double fps, const FootPath& path) {
  SourceFeet feet;
  feet.foot_count = 1;
  feet.frame_time = 1.0 / fps;
  const int frames = static_cast<int>(std::lround(seconds * fps)) + 1;
  for (int frame = 0; frame < frames; ++frame) {
    const FootPlace place = path(frame / fps);
    SourceFoot foot;
    foot.ankle = {place.x, 0.0, kStandingAnkle + place.height};
    foot.toe = {place.x + 0.14, 0.0, kStandingToe + place.height};
    feet.feet.push_back(foot);
  }
  return feet;
}

// Stands for a second, rises and falls at 1 m/s, and stands half a metre ahead.
inline FootPlace step(double t) {
  const double up = std::max(0.0, 0.25 - std::abs(t - 1.25));
  return {0.5 * std::min(1.0, std::max(0.0, 2.0 * (t - 1.0))), up};
}

inline FootPlan plan_of(const SourceFeet& feet, double scale = 1.0) {
  FootPlan plan;
  const ContactOptions options = contact_options({});
  plan_feet(feet, find_contacts(feet, options), options, std::array{0}, scale, {}, plan);
  return plan;
}

}  // namespace retarget
