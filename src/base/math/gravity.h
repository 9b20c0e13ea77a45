#pragma once

namespace retarget {

inline constexpr double kGravity = 9.81;  ///< Metres per second squared, along -z of the world.

}  // namespace retarget
