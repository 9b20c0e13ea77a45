#pragma once

#include <Eigen/Geometry>
#include <string>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/options.h"
#include "retarget/pose.h"

namespace retarget {

/// Returns the clip with unit and up axis in its origin. If the file does not contain them, they
/// are inferred with the human in it.
/// @param data_folder  contains configs/skeletons.
/// Errors: those of find_human.
[[nodiscard]] Result<Clip> clip_with_units(Clip clip, const HumanOptions& options,
                                           const std::string& data_folder);

/// Converts poses of a clip to metres and another up axis, for protocols with a fixed unit and
/// world. Joint axes rotate with the world, so that a zero pose remains a zero pose.
class ClipAxes {
 public:
  ClipAxes() = default;
  /// @param clip  has unit and up axis in its origin (clip_with_units); otherwise they stay
  ///   unchanged.
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
