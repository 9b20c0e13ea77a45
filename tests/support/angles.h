// Angles that tests write and compare.
#pragma once

#include <numbers>

namespace retarget {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegree = kPi / 180.0;   // radians in a degree
inline constexpr double kDegrees = 180.0 / kPi;  // degrees in a radian

}  // namespace retarget
