#pragma once

namespace retarget {

inline constexpr double kGravity = 9.81;  ///< m/s^2, along -z of the world.

}  // namespace retarget
