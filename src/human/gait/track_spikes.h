#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "retarget/clip.h"

namespace retarget {

/// Interpolates over spikes: a joint turns by more than 30 degrees in one frame, or moves by more
/// than 0.15 m, and returns within three frames, while it is much slower before and after. No body
/// reverses that fast. Does not change clips with fewer than 22 frames per second.
/// @return one sentence per joint: `Hips jumped away in 1 frame`.
std::vector<std::string> bridge_spikes(Clip& clip, FrameRange part, double metres_per_unit);

/// Interpolates over spikes of the world positions of joints, indexed by joint and frame; the first
/// joint is the root. A spike of the root moves the body, or the root alone. Other joints are
/// measured relative to the root. A spike is a jump by more than `least` away from the way, on
/// which the joint moves at the mean velocity across the spike; the way bends much less before and
/// after. In frames in which two joints jump away, half of that suffices for others: left and right
/// were exchanged.
/// @return sentences: `the body jumped away in 1 frame`, `LeftFoot jumped away in 3 frames`.
std::vector<std::string> bridge_spikes(std::vector<std::vector<Eigen::Vector3d>>& tracks,
                                       const std::vector<std::string>& names, FrameRate rate,
                                       double least);

}  // namespace retarget
