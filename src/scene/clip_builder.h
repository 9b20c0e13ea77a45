#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/pose.h"

namespace retarget {

/// A joint of a skeleton that is known by its places in the world.
struct WorldJoint {
  std::string name;
  int parent = -1;  ///< Smaller than its own index.
  Pose world_from_rest;
};

/// Makes a clip of poses in the world.
///
/// Joints get axes along the world's in the rest pose, whatever axes they had: with all rotations identity
/// the skeleton stands in it. Lengths are those of the motion, not those of the rest pose; joints whose
/// translation stays the same in all frames have it as their offset.
class ClipBuilder {
 public:
  /// Bytes that a frame of so many joints takes while a clip is built.
  [[nodiscard]] static std::size_t frame_bytes(std::size_t joints);

  ClipBuilder(std::vector<WorldJoint> joints, FrameRate rate, int frame_count);

  void set_frame(int frame, std::span<const Pose> world_from_joint);

  [[nodiscard]] Clip build() const;

 private:
  // whether a joint moves against its parent by more than rounding
  [[nodiscard]] bool is_translated(std::size_t joint, double tolerance) const;
  [[nodiscard]] double size() const;

  std::vector<WorldJoint> joints_;
  FrameRate rate_;
  int frame_count_;
  std::vector<Eigen::Quaterniond> rotations_;  // frame-major, parent_from_joint
  std::vector<Eigen::Vector3d> translations_;  // likewise
};

/// Names that a BVH can hold: no control bytes, none empty, no blanks at the ends.
[[nodiscard]] std::vector<std::string> plain_joint_names(std::vector<std::string> names);

}  // namespace retarget
