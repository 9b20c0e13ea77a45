#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "smpl/array_source.h"

namespace retarget {

/// Places of joints over time, as a file has them: its units and axes.
struct JointMotion {
  int frame_count = 0;
  int joint_count = 0;
  std::vector<Eigen::Vector3d> positions;  ///< In the world, frame by frame.
  /// world_from_joint, frame by frame, where the file has them; all identity in a T-pose. Empty: not
  /// known.
  std::vector<Eigen::Quaterniond> rotations;
  std::vector<std::string> names;  ///< Of the joints; empty: the file does not tell them.
  FrameRate rate;
  std::optional<double> height;  ///< Of the body in metres, if the file gives it.
  std::vector<Warning> warnings;

  [[nodiscard]] const Eigen::Vector3d& position(int frame, int joint) const {
    return positions[index(frame, joint)];
  }
  [[nodiscard]] std::size_t index(int frame, int joint) const {
    return static_cast<std::size_t>(frame) * static_cast<std::size_t>(joint_count) +
           static_cast<std::size_t>(joint);
  }
};

struct JointReadOptions {
  std::optional<double> source_fps;      ///< In place of the file's.
  std::vector<std::string> joint_names;  ///< In place of the file's; empty: not given.
  std::string take;                      ///< Which of several motions, a number from 1; empty: the
                                         ///< only one.
  std::size_t max_clip_bytes = std::numeric_limits<std::size_t>::max();
};

/// Whether there is an array with places of joints, under any of the names that are read.
[[nodiscard]] bool has_joint_positions(const ArraySource& file);

/// Whether arrays are those of Kimodo: places of joints and their rotations.
[[nodiscard]] bool is_kimodo(const ArraySource& file);

/// Reads places of joints: (frames, joints, 3); MDM's (samples, joints, 3, frames); (samples, frames,
/// joints, 3). Kimodo's files have rotations beside them.
///
/// The rate is `fps` or the like; where there is none, that which the data set is known for, with a
/// warning that says so: 20 of HumanML3D's and MDM's 22 joints, 120 of holosoma's 53, 30 of what has
/// `global_joint_positions` and of Kimodo.
/// Errors: other shapes, no frames, numbers that are not finite, no rate, several motions without a
/// choice, names of another count.
[[nodiscard]] Result<JointMotion> read_joint_motion(const ArraySource& file,
                                                    const JointReadOptions& options);

}  // namespace retarget
