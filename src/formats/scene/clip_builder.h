#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/pose.h"

namespace retarget {

/// A joint of a skeleton, given by its world pose in the rest pose.
struct WorldJoint {
  std::string name;
  int parent = -1;  ///< Smaller than its own index.
  Pose world_from_rest;
};

/// Builds a clip from world poses.
///
/// In the rest pose the axes of all joints are aligned with the world, regardless of their axes in
/// the file: with all rotations identity the skeleton is in the rest pose. Bone lengths are those
/// of the motion, not of the rest pose. A joint whose translation is the same in all frames has it
/// as its offset.
class ClipBuilder {
 public:
  /// Bytes per frame of `joints` joints while a clip is built.
  [[nodiscard]] static std::size_t frame_bytes(std::size_t joints);

  ClipBuilder(std::vector<WorldJoint> joints, FrameRate rate, int frame_count);

  void set_frame(int frame, std::span<const Pose> world_from_joint);

  [[nodiscard]] Clip build() const;

 private:
  // Whether a joint translates relative to its parent by more than rounding.
  [[nodiscard]] bool is_translated(std::size_t joint, double tolerance) const;
  [[nodiscard]] double size() const;

  std::vector<WorldJoint> joints_;
  FrameRate rate_;
  int frame_count_;
  std::vector<Eigen::Quaterniond> rotations_;  // Frame-major, parent_from_joint.
  std::vector<Eigen::Vector3d> translations_;  // Frame-major.
};

}  // namespace retarget
