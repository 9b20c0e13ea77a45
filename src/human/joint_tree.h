#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "retarget/human.h"
#include "smpl/joint_motion.h"

namespace retarget {

/// Joints whose places alone are known, as the tree of a body.
struct JointTree {
  std::vector<std::string> names;
  std::vector<int> parents;  ///< -1: the root, the hips.
  BoneArray<int> joint_of_bone = BoneArray<int>(-1);
  std::vector<std::vector<Eigen::Vector3d>> tracks;  ///< Of each joint its places, by frame.
  std::vector<std::string>
      made;  ///< Joints that the file has not: in the middle between two others.

  [[nodiscard]] int frame_count() const { return static_cast<int>(tracks.front().size()); }
};

/// Finds the body by the words in the joints' names: limbs from hip to toe and from collar to hand,
/// the trunk in the order in which its joints stand. Hips, chest and head are put in the middle
/// between hips, shoulders and ears where there is no joint of that name. Fingers and whatever else
/// there is hang from the joint before by their number, or from the nearest one of the body.
/// @return nothing where neither legs nor arms are found.
[[nodiscard]] std::optional<JointTree> joint_tree(const JointMotion& motion,
                                                  const std::vector<std::string>& names);

/// How badly the places fit a body of which the tree knows the joints: the sum of what limbs change
/// in length and of what left and right differ, as shares of their lengths.
/// @return nothing where they fit none: limbs out of proportion, or that change; knees that bend and
/// toes that point backwards.
[[nodiscard]] std::optional<double> misfit_of_body(const JointTree& tree);

/// By how much the limbs change in length, as a share of it: of the one that changes most its standard
/// deviation.
[[nodiscard]] double limb_length_change(const JointTree& tree);

}  // namespace retarget
