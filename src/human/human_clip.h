#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "human/bone_map.h"
#include "human/bones.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/pose.h"

namespace retarget {

/// The joints of a skeleton that give a canonical bone its pose.
struct BoneSource {
  int position_joint = -1;  ///< Joint whose origin is the bone's; -1: the bone is missing.
  int rotation_joint = -1;  ///< Joint whose rotation is the bone's; -1: the bone is missing.
  /// The bone's canonical axes seen from the rotation joint, a constant: with rotations in the
  /// T-pose, facing x with z up, it is R_joint(T)^-1 * R_canonical(T), so that the bone turns by
  /// R_joint(t) * R_joint(T)^-1 from its canonical T-pose. Without: the joint's own axes.
  std::optional<Eigen::Quaterniond> joint_from_bone = std::nullopt;
  /// Where the bone begins, in the position joint's frame and the source's unit. Without: at the
  /// joint's origin.
  std::optional<Eigen::Vector3d> position_in_joint = std::nullopt;
};

/// How a source skeleton becomes the canonical human: metres, Z up, right-handed, LAFAN1's bones.
struct HumanMapping {
  std::string dialect;            ///< Name of the kind of skeleton, such as `lafan1`.
  std::vector<BoneSource> bones;  ///< One per canonical bone.
  double metres_per_unit = 0.01;  ///< Of the source's lengths.
  /// Turns the source's axes into canonical ones; a rotation (determinant +1).
  Eigen::Matrix3d human_from_source = Eigen::Matrix3d::Identity();
  double height = 1.75;  ///< Of the body, metres.
  /// Height of a body of average proportions with legs like these, metres: what bodies of
  /// different sizes are compared by, since feet and hips must fit the robot's legs.
  double size = 1.75;
  std::string description;      ///< What was taken for granted, for people.
  std::vector<Warning> doubts;  ///< Why the result may be wrong; empty: nothing speaks against it.
};

/// What a canonical human in motion is, but for its poses.
struct HumanClipInfo {
  FrameRate rate;
  int frame_count = 0;
  double height = 1.75;                    ///< Of the body, metres.
  double size = 1.75;                      ///< As in HumanMapping.
  std::vector<std::string> sources;        ///< Per bone, the joint it came from; empty: missing.
  std::vector<std::string> source_joints;  ///< All joints of the source, for messages.

  [[nodiscard]] bool has(int bone) const { return !sources[bone].empty(); }
};

/// World poses of the canonical bones, frame by frame.
struct HumanClip : HumanClipInfo {
  /// World poses, metres, Z up; frame-major, kBoneCount a frame. Missing bones: identity.
  std::vector<Pose> world_from_bone;

  [[nodiscard]] std::span<const Pose> frame(int index) const {
    return {world_from_bone.data() + static_cast<std::size_t>(index) * kBoneCount, kBoneCount};
  }
};

/// The mapping of a skeleton with LAFAN1's joint names, as the published method takes it: file
/// units are centimetres, Y is up, the body 1.75 m high whatever its bones say. Further joints
/// (also above Hips) are allowed. Bones whose joints are not there are left out; a bone's name on
/// two joints is a kInput error.
/// @param file  where the skeleton comes from, for messages.
[[nodiscard]] Result<HumanMapping> lafan1_mapping(const Skeleton& skeleton,
                                                  const std::string& file);

/// The same for bones that were found by recognition, whatever their names.
[[nodiscard]] HumanMapping lafan1_mapping(const BoneMap& map);

/// Poses of a clip's frames under a mapping, one at a time: long clips need not be held as human
/// poses, which take more memory than what they come from. Refers to its clip and mapping.
class HumanPoser {
 public:
  HumanPoser(const Clip& clip, const HumanMapping& mapping);

  [[nodiscard]] HumanClipInfo info() const;

  /// @param world_from_bone  kBoneCount poses, metres, Z up; filled. Missing bones: identity.
  void pose(int frame, std::span<Pose> world_from_bone);

 private:
  const Clip& clip_;
  const HumanMapping& mapping_;
  Eigen::Quaterniond turn_;
  std::vector<Pose> world_from_joint_;
};

/// Poses of all frames under a mapping.
[[nodiscard]] HumanClip to_human(const Clip& clip, const HumanMapping& mapping);

}  // namespace retarget
