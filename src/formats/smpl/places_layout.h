#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/containers/array_source.h"

namespace retarget {

/// Returns the name of the array with joint positions, by the names that programs use, with any
/// capitals and separators: `joints3d`, `Joints_3D`. Empty: no such array.
[[nodiscard]] std::string places_of(const ArraySource& file);

/// Whether a name of places_of() is holosoma's.
[[nodiscard]] bool is_of_holosoma(std::string_view name);

/// Memory layout of an array of positions.
struct PlacesLayout {
  std::size_t samples = 1, frames = 0, joints = 0;
  bool frames_last = false;  ///< MDM: (samples, joints, 3, frames)
  bool are_people = false;   ///< The samples are people: (frames, samples, joints, 3)

  [[nodiscard]] std::size_t index(std::size_t sample, std::size_t frame, std::size_t joint,
                                  std::size_t axis) const {
    if (are_people) return ((frame * samples + sample) * joints + joint) * 3 + axis;
    return frames_last ? ((sample * joints + joint) * 3 + axis) * frames + frame
                       : ((sample * frames + frame) * joints + joint) * 3 + axis;
  }
};

/// Finds the layout of (frames, joints, 3), (samples, frames, joints, 3), MDM's
/// (samples, joints, 3, frames), or a table of named joints.
/// @param named_joints  number of joint names; 0: unknown.
[[nodiscard]] std::optional<PlacesLayout> layout_of(const std::vector<std::size_t>& shape,
                                                    std::size_t named_joints);

/// Decides whether samples are motions, or people of a detector of key points, whose arrays are
/// (frames, people, joints, 3). Joints move little from frame to frame, compared with the distances
/// of people or motions, but they move.
/// @return nothing if the positions do not decide between a few people in many frames and many
///   motions of a few frames
[[nodiscard]] std::optional<PlacesLayout> settle_people(const PlacesLayout& layout,
                                                        const std::vector<double>& values);

/// Whether no joint of a sample is tracked in any frame.
[[nodiscard]] bool is_absent_sample(const PlacesLayout& layout, std::size_t sample,
                                    const std::vector<double>& values);

}  // namespace retarget
