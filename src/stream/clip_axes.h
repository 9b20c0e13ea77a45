#pragma once

#include <Eigen/Geometry>
#include <string>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/options.h"
#include "retarget/pose.h"

namespace retarget {

/// The clip with unit and up axis in its origin, where the file does not tell them: as they are found
/// with the human in it.
/// @param data_folder  with configs/skeletons.
/// Errors: those of find_human.
[[nodiscard]] Result<Clip> clip_with_units(Clip clip, const HumanOptions& options,
                                           const std::string& data_folder);

/// Poses of a clip in metres and in a world with another axis up, for protocols that have one unit and
/// one world. Joints are turned as well, so that a zero pose remains one.
class ClipAxes {
 public:
  ClipAxes() = default;
  /// @param clip  whose origin has unit and up axis (clip_with_units); else they stay.
  ClipAxes(const Clip& clip, const Eigen::Vector3d& up);

  [[nodiscard]] Pose metric(const Pose& pose) const {
    return {turn_ * pose.rotation * turn_.conjugate(),
            metres_per_unit_ * (turn_ * pose.translation)};
  }
  [[nodiscard]] Eigen::Vector3d metric(const Eigen::Vector3d& offset) const {
    return metres_per_unit_ * (turn_ * offset);
  }

 private:
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
  double metres_per_unit_ = 1.0;
};

}  // namespace retarget
