#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "formats/smpl/joint_motion.h"
#include "retarget/human.h"

namespace retarget {

/// A body tree for joints of which only positions are known.
struct JointTree {
  std::vector<std::string> names;
  std::vector<int> parents;  ///< -1: the root, which is the hips.
  BoneArray<int> joint_of_bone = BoneArray<int>(-1);
  std::vector<std::vector<Eigen::Vector3d>> tracks;  ///< Positions by joint and frame.
  std::vector<std::string>
      made;  ///< Joints absent from the file, placed midway between two others.

  [[nodiscard]] int frame_count() const { return static_cast<int>(tracks.front().size()); }
};

/// Finds the body from words in the joint names: limbs from hip to toe and from collar bone to
/// hand, the trunk in the order of its joints' distances. Missing hips, chest and head are placed
/// midway between hips, shoulders and ears. Fingers and other joints hang from the joint with the
/// next lower number, or from the nearest body joint.
/// @return nothing if there are neither legs nor arms
[[nodiscard]] std::optional<JointTree> joint_tree(const JointMotion& motion,
                                                  const std::vector<std::string>& names);

/// Misfit of the positions to the body that the tree describes: the sum of length changes of the
/// limbs and of differences between left and right, as shares of their lengths.
/// @return nothing if they do not fit at all: limbs are out of proportion or change too much, or
///   knees bend and toes point backwards
[[nodiscard]] std::optional<double> misfit_of_body(const JointTree& tree);

/// Largest standard deviation of a limb's length, as a share of this length.
[[nodiscard]] double limb_length_change(const JointTree& tree);

}  // namespace retarget
