#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"

namespace retarget {

/// The same movement with other local axes in the joints: joint_from_new per joint. World positions
/// do not change; world rotations become world_from_joint * joint_from_new.
inline Clip with_other_axes(const Clip& clip, const std::vector<Eigen::Quaterniond>& turns) {
  std::vector<Joint> joints = clip.skeleton().joints();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i].parent >= 0)
      joints[i].offset = turns[joints[i].parent].inverse() * joints[i].offset;
    for (Eigen::Vector3d& site : joints[i].end_sites) site = turns[i].inverse() * site;
  }
  Clip twin(std::make_shared<const Skeleton>(joints), clip.rate(), clip.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const int parent = joints[i].parent;
      const Eigen::Quaterniond before =
          parent >= 0 ? turns[parent].inverse() : Eigen::Quaterniond::Identity();
      twin.rotations(frame)[i] = (before * clip.rotations(frame)[i] * turns[i]).normalized();
    }
    twin.translations(frame)[0] = clip.translations(frame)[0];
  }
  return twin;
}

/// The twin of a LAFAN1-shaped clip whose zero pose is the T-pose (y up, facing x), its arms
/// lowered about the forward axis by `lowered` rad.
inline Clip with_t_pose_as_zero(const Clip& clip, double lowered = 0.0) {
  const Eigen::Quaterniond file_from_human(Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX()));
  std::vector<Eigen::Quaterniond> turns;
  for (const Joint& joint : clip.skeleton().joints()) {
    const Bone bone = bone_from_name(joint.name).value();
    const bool is_arm = joint.name.ends_with("Arm") || joint.name.ends_with("Hand");
    const double angle = !is_arm ? 0.0 : joint.name.starts_with("Left") ? -lowered : lowered;
    const Eigen::Quaterniond lowering(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()));
    const Eigen::Quaterniond axes(canonical_t_pose(bone));
    turns.push_back((file_from_human * lowering * axes).inverse());
  }
  return with_other_axes(clip, turns);
}

/// In another unit, and rotated as a whole.
inline Clip scaled_and_turned(const Clip& clip, double scale, const Eigen::Quaterniond& turn) {
  std::vector<Joint> joints = clip.skeleton().joints();
  for (Joint& joint : joints) {
    joint.offset *= scale;
    for (Eigen::Vector3d& site : joint.end_sites) site *= scale;
  }
  Clip twin(std::make_shared<const Skeleton>(joints), clip.rate(), clip.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (std::size_t i = 0; i < joints.size(); ++i) {
      twin.rotations(frame)[i] = clip.rotations(frame)[i];
    }
    twin.rotations(frame)[0] = turn * clip.rotations(frame)[0];
    twin.translations(frame)[0] = scale * (turn * clip.translations(frame)[0]);
  }
  return twin;
}

/// The clip with position channels of all joints.
/// @param noise  size of changes of the translations of all joints but the root, file units.
inline Clip with_position_channels(const Clip& clip, double noise = 0.0) {
  std::vector<Joint> joints = clip.skeleton().joints();
  for (Joint& joint : joints) {
    if (joint.has_position_channels()) continue;
    joint.channels.insert(joint.channels.begin(),
                          {Channel::kXPosition, Channel::kYPosition, Channel::kZPosition});
  }
  Clip twin(std::make_shared<const Skeleton>(joints), clip.rate(), clip.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    std::ranges::copy(clip.rotations(frame), twin.rotations(frame).begin());
    for (int joint = 0; joint < twin.skeleton().joint_count(); ++joint) {
      const double moved = joint == 0 ? 0.0 : noise * (frame % 3 - 1);
      twin.translations(frame)[joint] =
          clip.translation(frame, joint) + Eigen::Vector3d(moved, -moved, moved);
    }
  }
  return twin;
}

/// Every n-th frame, at a rate divided by n.
inline Clip every_nth(const Clip& clip, int n) {
  const int count = (clip.frame_count() + n - 1) / n;
  Clip twin(clip.shared_skeleton(), {clip.rate().frames, clip.rate().seconds * n}, count);
  for (int frame = 0; frame < count; ++frame) {
    std::ranges::copy(clip.rotations(frame * n), twin.rotations(frame).begin());
    std::ranges::copy(clip.translations(frame * n), twin.translations(frame).begin());
  }
  return twin;
}

/// Children in the opposite order, a zero-length joint before every thigh, one halfway along every
/// upper arm, and a still joint above the root.
inline Clip with_extra_joints(const Clip& clip) {
  const std::vector<Joint>& old = clip.skeleton().joints();
  std::vector<Joint> joints(1);
  joints[0].name = "Reference";
  std::vector<int> source = {-1};
  const std::function<void(int, int)> add = [&](int index, int parent) {
    Joint joint = old[index];
    const auto helper = [&](const Eigen::Vector3d& offset) {
      Joint extra;
      extra.name = joint.name + "Helper";
      extra.parent = parent;
      extra.offset = offset;
      joints.push_back(extra);
      source.push_back(-1);
      parent = static_cast<int>(joints.size()) - 1;
      joint.offset -= offset;
    };
    if (joint.name.ends_with("UpLeg")) helper(Eigen::Vector3d::Zero());
    if (joint.name.ends_with("ForeArm")) helper(0.5 * joint.offset);
    joint.parent = parent;
    joints.push_back(joint);
    source.push_back(index);
    const int self = static_cast<int>(joints.size()) - 1;
    for (int child = static_cast<int>(old.size()) - 1; child > index; --child) {
      if (old[child].parent == index) add(child, self);
    }
  };
  add(0, 0);
  Clip twin(std::make_shared<const Skeleton>(joints), clip.rate(), clip.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (source[i] >= 0) twin.rotations(frame)[i] = clip.rotations(frame)[source[i]];
    }
    twin.translations(frame)[0] = clip.translations(frame)[0];
  }
  return twin;
}

/// Largest difference of two humans in any coordinate or quaternion component (up to sign).
inline double largest_difference(const HumanClip& a, const HumanClip& b) {
  if (a.frame_count != b.frame_count) return std::numeric_limits<double>::infinity();
  double largest = std::abs(a.height - b.height);
  for (int frame = 0; frame < a.frame_count; ++frame) {
    for (const Bone bone : kAllBones) {
      const Pose &p = a.frame(frame)[bone], &q = b.frame(frame)[bone];
      const double sign = p.rotation.dot(q.rotation) < 0.0 ? -1.0 : 1.0;
      largest = std::max(largest, (p.translation - q.translation).cwiseAbs().maxCoeff());
      largest = std::max(largest,
                         (p.rotation.coeffs() - sign * q.rotation.coeffs()).cwiseAbs().maxCoeff());
    }
  }
  return largest;
}

/// The same movement with the file's root at the head, as headsets record it: the trunk runs from
/// Head down to Hips, and each of its joints rotates the part below it. The rotation of the head
/// itself is lost. For skeletons with LAFAN1's names.
inline Clip rooted_at_head(const Clip& clip) {
  const std::vector<std::string> trunk = {"Head", "Neck", "Spine2", "Spine1", "Spine", "Hips"};
  const Skeleton& old = clip.skeleton();
  const auto old_joint = [&](const std::string& name) { return old.find(name).value(); };
  // The joint of the old skeleton that rotates the part of a joint of the new one.
  std::vector<int> turned_by;
  std::vector<Joint> joints;
  for (std::size_t i = 0; i < trunk.size(); ++i) {
    Joint joint;
    joint.name = trunk[i];
    joint.parent = static_cast<int>(i) - 1;
    joint.channels = old.joint(i == 0 ? old_joint("Hips") : old_joint("Spine")).channels;
    if (i > 0) joint.offset = -old.joint(old_joint(trunk[i - 1])).offset;
    turned_by.push_back(old_joint(trunk[std::min(i + 1, trunk.size() - 1)]));
    joints.push_back(joint);
  }
  const auto place_of = [&](int old_index) {
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (joints[i].name == old.joint(old_index).name) return static_cast<int>(i);
    }
    return -1;
  };
  for (int i = 0; i < old.joint_count(); ++i) {
    if (place_of(i) >= 0) continue;
    Joint joint = old.joint(i);
    joint.parent = place_of(joint.parent);
    // Children of a joint of the trunk move to the new joint that rotates the same part.
    if (joint.name == "LeftShoulder" || joint.name == "RightShoulder") {
      joint.parent = 1;  // The neck now turns the part that the torso turned.
      joint.offset -= old.joint(old_joint("Neck")).offset;
    }
    joints.push_back(joint);
    turned_by.push_back(i);
  }
  Clip twin(std::make_shared<const Skeleton>(joints), clip.rate(), clip.frame_count());
  std::vector<Pose> world(static_cast<std::size_t>(old.joint_count()));
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, world);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const Eigen::Quaterniond above = joints[i].parent < 0
                                           ? Eigen::Quaterniond::Identity()
                                           : world[turned_by[joints[i].parent]].rotation;
      twin.rotations(frame)[i] = (above.conjugate() * world[turned_by[i]].rotation).normalized();
    }
    twin.translations(frame)[0] = world[old_joint("Head")].translation;
  }
  return twin;
}

}  // namespace retarget
