#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/options.h"
#include "retarget/pose.h"

namespace RETARGET_API retarget {

/// The canonical human's bones: LAFAN1's, in its order, then the two synthetic feet.
///
/// `LeftFootMod` and `RightFootMod` have the position of the ankle and the rotation of the toes.
/// The published tables use them for the robot's feet, whose soles follow the ball of the human
/// foot.
enum class Bone : unsigned char {
  kHips,
  kLeftUpLeg,
  kLeftLeg,
  kLeftFoot,
  kLeftToe,
  kRightUpLeg,
  kRightLeg,
  kRightFoot,
  kRightToe,
  kSpine,
  kSpine1,
  kSpine2,
  kNeck,
  kHead,
  kLeftShoulder,
  kLeftArm,
  kLeftForeArm,
  kLeftHand,
  kRightShoulder,
  kRightArm,
  kRightForeArm,
  kRightHand,
  kLeftFootMod,
  kRightFootMod,
};

inline constexpr std::size_t kBoneCount = 24;
/// Number of bones that a source joint can be mapped to: all except the synthetic feet, which are
/// the last two.
inline constexpr std::size_t kMappedBoneCount = kBoneCount - 2;

/// The first kCount bones, in order.
template <std::size_t kCount>
[[nodiscard]] constexpr std::array<Bone, kCount> first_bones() {
  std::array<Bone, kCount> bones{};
  for (std::size_t i = 0; i < kCount; ++i) bones[i] = static_cast<Bone>(i);
  return bones;
}
inline constexpr std::array<Bone, kBoneCount> kAllBones = first_bones<kBoneCount>();
inline constexpr std::array<Bone, kMappedBoneCount> kMappedBones = first_bones<kMappedBoneCount>();

/// One value for each bone, in the order of the bones.
template <typename T>
class BoneArray {
 public:
  BoneArray() = default;
  explicit BoneArray(const T& value) { values_.fill(value); }

  [[nodiscard]] T& operator[](Bone bone) { return values_[static_cast<std::size_t>(bone)]; }
  [[nodiscard]] const T& operator[](Bone bone) const {
    return values_[static_cast<std::size_t>(bone)];
  }
  [[nodiscard]] auto begin() { return values_.begin(); }
  [[nodiscard]] auto begin() const { return values_.begin(); }
  [[nodiscard]] auto end() { return values_.end(); }
  [[nodiscard]] auto end() const { return values_.end(); }

  friend bool operator==(const BoneArray&, const BoneArray&) = default;

 private:
  std::array<T, kBoneCount> values_{};
};

/// LAFAN1's name of the bone, such as `LeftUpLeg`.
[[nodiscard]] std::string_view bone_name(Bone bone);
/// The bone with this name; also accepts `LeftToeBase` and `RightToeBase` for the toes.
[[nodiscard]] std::optional<Bone> bone_from_name(std::string_view name);
/// Names of all bones, or of kMappedBones, for messages.
[[nodiscard]] const std::vector<std::string>& bone_names();
[[nodiscard]] const std::vector<std::string>& mapped_bone_names();

enum class Side : unsigned char { kNone, kLeft, kRight };
inline constexpr std::array kSides = {Side::kLeft, Side::kRight};

/// Bones that exist on both sides of the body.
enum class LimbBone : unsigned char {
  kUpLeg,
  kLeg,
  kFoot,
  kToe,
  kShoulder,
  kArm,
  kForeArm,
  kHand,
  kFootMod,
};

/// @param side  not kNone.
[[nodiscard]] constexpr Bone side_bone(Side side, LimbBone part) {
  constexpr std::array kLeft = {Bone::kLeftUpLeg,   Bone::kLeftLeg,      Bone::kLeftFoot,
                                Bone::kLeftToe,     Bone::kLeftShoulder, Bone::kLeftArm,
                                Bone::kLeftForeArm, Bone::kLeftHand,     Bone::kLeftFootMod};
  constexpr std::array kRight = {Bone::kRightUpLeg,   Bone::kRightLeg,      Bone::kRightFoot,
                                 Bone::kRightToe,     Bone::kRightShoulder, Bone::kRightArm,
                                 Bone::kRightForeArm, Bone::kRightHand,     Bone::kRightFootMod};
  const auto index = static_cast<std::size_t>(part);
  return side == Side::kLeft ? kLeft[index] : kRight[index];
}

/// kNone for the trunk, neck and head.
[[nodiscard]] Side side_of(Bone bone);
/// Empty for the trunk, neck and head.
[[nodiscard]] std::optional<LimbBone> limb_bone(Bone bone);
/// Returns the corresponding bone on the other side; for the trunk, neck and head the bone itself.
[[nodiscard]] Bone mirrored(Bone bone);

/// Fingers of a hand, in order from the thumb.
enum class Finger : unsigned char { kThumb, kIndex, kMiddle, kRing, kLittle };
inline constexpr std::size_t kFingerCount = 5;
inline constexpr std::array kFingers = {Finger::kThumb, Finger::kIndex, Finger::kMiddle,
                                        Finger::kRing, Finger::kLittle};
/// `thumb`, `index`, `middle`, `ring`, `little`.
[[nodiscard]] std::string_view finger_name(Finger finger);

/// Properties that all files of a kind of skeleton share. Files are often converted or edited, so
/// these apply only if the clip does not contradict them.
struct SkeletonFacts {
  std::optional<double> height;           ///< Body height, metres.
  std::optional<double> metres_per_unit;  ///< Unit of lengths.
  std::optional<Eigen::Vector3d> up;      ///< Unit vector in the file's axes.
  /// Rest pose. kZero or kFirst: that pose is a T-pose. kLearned: neither is. kAuto: unknown.
  RestPose rest = RestPose::kAuto;
};

/// The joint of a source skeleton for each canonical bone.
struct BoneMap {
  std::string profile;      ///< Name of the profile file, or "names", "topology", "map file".
  double confidence = 0.0;  ///< 0..1.
  /// Joint index; -1 if the source has no such joint, and for the synthetic feet. Hips is the joint
  /// that both legs hang from. Spine2 is the torso, the last common ancestor of the arms. Spine and
  /// Spine1 are joints between them: -1 if there are fewer, chosen evenly if there are more.
  BoneArray<int> joint_of_bone = BoneArray<int>(-1);
  std::vector<std::string> notes;  ///< Human-readable: missing or folded joints, assumptions.
  bool partial = false;            ///< Legs or arms are missing.
  SkeletonFacts facts;             ///< Facts from the profile; empty if no profile was recognised.
  /// Joints whose position channels keep them at their parents in the whole clip, sorted. They may
  /// be helpers (rotation_joint), as joints without position channels and OFFSET are.
  std::vector<int> in_place;

  [[nodiscard]] int joint(Bone bone) const { return joint_of_bone[bone]; }
  [[nodiscard]] bool has(Bone bone) const { return joint(bone) >= 0; }
  /// Whether the joint is mapped to a bone.
  [[nodiscard]] bool maps(int joint) const;
  /// Number of bones that have a joint.
  [[nodiscard]] int mapped_count() const;
};

/// One end of a known sole: vectors from the origin of the bone FootMod, in its axes, metres.
struct SoleEnd {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< Middle of its corners.
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();     ///< Outermost point of the sole.
};

/// Sole of a foot. Only sources that are robots have one.
struct FootSole {
  SoleEnd heel, toe;
};

/// Dimensions of a body, metres. Lengths of limbs are the means of both sides.
struct BodyLengths {
  double leg = 0.0;  ///< Hip to knee to ankle.
  double upper_arm = 0.0;
  double forearm = 0.0;
  /// Vectors in the upright body, x forward, y left, z up. `trunk` points from the middle of the
  /// hips to the middle of the shoulders, `shoulders` from the right shoulder to the left one.
  Eigen::Vector3d trunk = Eigen::Vector3d::Zero();
  Eigen::Vector3d shoulders = Eigen::Vector3d::Zero();
};

/// The joints of a skeleton that give a canonical bone its pose.
struct BoneSource {
  int position_joint = -1;  ///< Joint at the origin of the bone; -1: the bone is missing.
  int rotation_joint = -1;  ///< Joint that rotates the bone; -1: the bone is missing.
  /// The bone's canonical axes in the frame of the rotation joint. This constant is
  /// R_joint(T)^-1 * R_canonical(T) for rotations in the T-pose T, facing x with z up, so the bone
  /// turns by R_joint(t) * R_joint(T)^-1 from its canonical T-pose. Empty: the joint's own axes.
  std::optional<Eigen::Quaterniond> joint_from_bone = std::nullopt;
  /// Origin of the bone in the frame of the position joint, in the source's unit. Empty: the origin
  /// of the joint.
  std::optional<Eigen::Vector3d> position_in_joint = std::nullopt;
  /// Joint inside the bone, between its start and the next bone, that twists the far end; -1: none.
  /// The bone then turns with this joint instead of rotation_joint, which turns its start.
  int twist_joint = -1;
  /// The bone's canonical axes in the frame of the twist joint.
  Eigen::Quaterniond twist_from_bone = Eigen::Quaterniond::Identity();
};

/// Conversion of a source skeleton to the canonical human: metres, Z up, right-handed, LAFAN1's
/// bones.
struct Calibration {
  std::string profile;  ///< Name of the skeleton profile, such as `lafan1`.
  BoneArray<BoneSource> bones;
  double metres_per_unit = 0.01;  ///< Unit of the source's lengths.
  /// Rotation (determinant +1) from the source's axes to canonical axes.
  Eigen::Matrix3d human_from_source = Eigen::Matrix3d::Identity();
  double height = 1.75;  ///< Body height, metres.
  /// Height, metres, of a body of average proportions with these legs. Comparisons of body sizes
  /// use it because feet and hips must fit the robot's legs.
  double size = 1.75;
  /// Left and right sole, for finding contacts. Empty: the ankle stands for the heel.
  std::array<std::optional<FootSole>, 2> soles;
  /// Dimensions of a robot, whose joints are hinges and which is upright in its T-pose. Empty for a
  /// human, whose dimensions are estimated from the movement.
  std::optional<BodyLengths> built;
  /// Forward bend of the upper end of the spine relative to the hips while the human stands,
  /// radians, of the whole clip. Empty: unknown, such as for a single pose.
  std::optional<double> standing_bend;
  std::string description;      ///< Human-readable: the assumptions.
  std::vector<Warning> doubts;  ///< Reasons why the result may be wrong.

  std::string unit;  ///< `m`, `dm`, `cm`, `mm`, `inch`, `CMU unit`, `given`, `scaled` (to a
                     ///< given height) or `unknown`.
  SignedAxis up;     ///< Up axis of the file.
  bool up_is_uncertain = false;  ///< A warning in `doubts` says why.
  SignedAxis forward;            ///< Axis of the file nearest to the facing in the rest pose.
  std::string rest_pose;        ///< `zero pose`, `frame 12`, `T-pose file`, `learned`, `lafan1`, or
                                ///< `lafan1 axes` for a body of another height.
  double rest_deviation = 0.0;  ///< Mean angle between limbs and trunk of that pose and the T-pose,
                                ///< degrees; for `learned`, that of the best frame.
};

/// Properties of a canonical human's motion, without its poses.
struct HumanClipInfo {
  FrameRate rate;
  int frame_count = 0;
  double height = 1.75;                          ///< Body height, metres.
  double size = 1.75;                            ///< See Calibration::size.
  std::array<std::optional<FootSole>, 2> soles;  ///< See Calibration::soles.
  std::optional<BodyLengths> built;              ///< See Calibration::built.
  std::optional<double> standing_bend;           ///< See Calibration::standing_bend.
  BoneArray<std::string> sources;                ///< Source joint of each bone; empty: missing.
  std::vector<std::string> source_joints;        ///< All joints of the source, for messages.

  [[nodiscard]] bool has(Bone bone) const { return !sources[bone].empty(); }
};

/// Frames [begin, end) in which a foot, or one end of it, is in contact.
struct ContactPhase {
  int begin = 0;
  int end = 0;
  double support = 0.0;  ///< Height of the support surface above the floor, metres.

  friend bool operator==(const ContactPhase&, const ContactPhase&) = default;
};

/// Contact phases, in order of time, of the left heel (ankle), left toe, right heel and right toe.
using SourceContacts = std::array<std::vector<ContactPhase>, 4>;

/// World poses of the canonical bones, metres, Z up. Missing bones have the identity.
using HumanPose = BoneArray<Pose>;

/// A canonical human's motion: its properties and the poses of all frames.
struct HumanClip : HumanClipInfo {
  std::vector<HumanPose> world_from_bone;  ///< One per frame.

  [[nodiscard]] const HumanPose& frame(int index) const {
    return world_from_bone[static_cast<std::size_t>(index)];
  }
};

/// Converts all frames of a clip under a calibration.
[[nodiscard]] HumanClip to_human(const Clip& clip, const Calibration& calibration);

/// Writes a bone map as JSON that a user can edit and pass to HumanOptions::map: for each canonical
/// bone the name of the source joint, or null. Does nothing if the path is empty.
[[nodiscard]] Result<void> save_bone_map(const std::string& path, const BoneMap& map,
                                         const Skeleton& skeleton);

}  // namespace retarget
