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
/// `LeftFootMod` and `RightFootMod` stand at the ankle and are turned like the toes: the published
/// tables use them for the robot's feet, whose soles follow the ball of the human foot.
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
/// Bones a source joint can stand for: all but the two synthetic feet, which are the last.
inline constexpr std::size_t kMappedBoneCount = kBoneCount - 2;

/// The first bones, in their order.
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

/// LAFAN1's name: `LeftUpLeg`.
[[nodiscard]] std::string_view bone_name(Bone bone);
/// The bone of a name; `LeftToeBase` and `RightToeBase` count as the toes.
[[nodiscard]] std::optional<Bone> bone_from_name(std::string_view name);
/// Names of all bones, or of kMappedBones, for messages.
[[nodiscard]] const std::vector<std::string>& bone_names();
[[nodiscard]] const std::vector<std::string>& mapped_bone_names();

enum class Side : unsigned char { kNone, kLeft, kRight };
inline constexpr std::array kSides = {Side::kLeft, Side::kRight};

/// The bones that a human has on both sides.
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
/// The same bone on the other side; for the trunk, neck and head the bone itself.
[[nodiscard]] Bone mirrored(Bone bone);

/// A finger of a hand, from the thumb's side on.
enum class Finger : unsigned char { kThumb, kIndex, kMiddle, kRing, kLittle };
inline constexpr std::size_t kFingerCount = 5;
inline constexpr std::array kFingers = {Finger::kThumb, Finger::kIndex, Finger::kMiddle,
                                        Finger::kRing, Finger::kLittle};
/// `thumb`, `index`, `middle`, `ring`, `little`.
[[nodiscard]] std::string_view finger_name(Finger finger);

/// What all files of a kind of skeleton have in common. As files get converted and edited, these
/// apply only where the clip itself does not contradict them.
struct SkeletonFacts {
  std::optional<double> height;           ///< Of every body of this kind, metres.
  std::optional<double> metres_per_unit;  ///< Of lengths.
  std::optional<Eigen::Vector3d> up;      ///< Unit vector, file axes.
  /// What is known of the rest pose: kZero or kFirst is a T-pose; kLearned: no pose of it is one;
  /// kAuto: nothing.
  RestPose rest = RestPose::kAuto;
};

/// Which joint of a source skeleton stands for each canonical bone.
struct BoneMap {
  std::string profile;      ///< Name of the profile file, or "names", "topology", "map file".
  double confidence = 0.0;  ///< 0..1.
  /// -1: the source has none; also for the synthetic feet. The spine: Hips is the joint both legs
  /// hang from, Spine2 the torso, i.e. the last common ancestor of the arms; Spine and Spine1 the
  /// joints between (fewer: -1; more: chosen evenly, the rest folded).
  BoneArray<int> joint_of_bone = BoneArray<int>(-1);
  std::vector<std::string> notes;  ///< Human-readable: what is missing, folded, assumed.
  bool partial = false;            ///< Legs or arms are missing.
  SkeletonFacts facts;             ///< Of the profile; empty where none was recognised.

  [[nodiscard]] int joint(Bone bone) const { return joint_of_bone[bone]; }
  [[nodiscard]] bool has(Bone bone) const { return joint(bone) >= 0; }
  /// Whether a joint stands for any bone.
  [[nodiscard]] bool maps(int joint) const;
  /// How many bones have a joint.
  [[nodiscard]] int mapped_count() const;
};

/// One end of a sole that is known, in the axes of the bone FootMod from where it stands, metres.
struct SoleEnd {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< Of its corners.
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();     ///< How far the sole reaches, beyond them.
};

/// What a foot stands on, where that is known: of robots.
struct FootSole {
  SoleEnd heel, toe;
};

/// A body as it is built, metres; of limbs the mean of both sides.
struct BodyLengths {
  double leg = 0.0;  ///< Hip to knee to ankle.
  double upper_arm = 0.0;
  double forearm = 0.0;
  /// As it stands straight, x forward, y left, z up: from the middle of the hips to the middle of the
  /// shoulders, and from the right shoulder to the left one.
  Eigen::Vector3d trunk = Eigen::Vector3d::Zero();
  Eigen::Vector3d shoulders = Eigen::Vector3d::Zero();
};

/// The joints of a skeleton that give a canonical bone its pose.
struct BoneSource {
  int position_joint = -1;  ///< Joint whose origin is the bone's; -1: the bone is missing.
  int rotation_joint = -1;  ///< Joint whose rotation is the bone's; -1: the bone is missing.
  /// The bone's canonical axes seen from the rotation joint, a constant: with rotations in the
  /// T-pose, facing x with z up, it is R_joint(T)^-1 * R_canonical(T), so that the bone turns by
  /// R_joint(t) * R_joint(T)^-1 from its canonical T-pose. Empty: the joint's own axes.
  std::optional<Eigen::Quaterniond> joint_from_bone = std::nullopt;
  /// Where the bone begins, in the position joint's frame and the source's unit. Empty: at the
  /// joint's origin.
  std::optional<Eigen::Vector3d> position_in_joint = std::nullopt;
};

/// How a source skeleton becomes the canonical human: metres, Z up, right-handed, LAFAN1's bones.
struct Calibration {
  std::string profile;  ///< Name of the kind of skeleton, such as `lafan1`.
  BoneArray<BoneSource> bones;
  double metres_per_unit = 0.01;  ///< Of the source's lengths.
  /// Turns the source's axes into canonical ones; a rotation (determinant +1).
  Eigen::Matrix3d human_from_source = Eigen::Matrix3d::Identity();
  double height = 1.75;  ///< Of the body, metres.
  /// Height of a body of average proportions with legs like these, metres: used to compare bodies
  /// of different sizes, since feet and hips must fit the robot's legs.
  double size = 1.75;
  /// Left, right: contacts are found by them. Empty: a heel goes as its ankle goes.
  std::array<std::optional<FootSole>, 2> soles;
  /// Of a robot, whose joints are hinges and which stands straight in its T-pose. Empty: a human, of
  /// whom all of that is found in the movement.
  std::optional<BodyLengths> built;
  std::string description;      ///< What was assumed, human-readable.
  std::vector<Warning> doubts;  ///< Why the result may be wrong; empty: no doubts.

  std::string unit;       ///< `m`, `dm`, `cm`, `mm`, `inch`, `CMU unit`; `given`; `scaled` to a
                          ///< given height; `unknown`.
  SignedAxis up;          ///< In the file's axes.
  SignedAxis forward;     ///< Nearest axis to the facing in the rest pose.
  std::string rest_pose;  ///< `zero pose`, `frame 12`, `T-pose file`, `learned`; `lafan1`, or
                          ///< `lafan1 axes` of a body that is not as tall.
  double rest_deviation = 0.0;  ///< Mean angle of the limbs and trunk of that pose from the
                                ///< T-pose, degrees; of `learned`, that of the best frame.
};

/// A canonical human's motion without its poses.
struct HumanClipInfo {
  FrameRate rate;
  int frame_count = 0;
  double height = 1.75;                          ///< Of the body, metres.
  double size = 1.75;                            ///< As in Calibration.
  std::array<std::optional<FootSole>, 2> soles;  ///< The same.
  std::optional<BodyLengths> built;              ///< The same.
  BoneArray<std::string> sources;                ///< The joint each bone came from; empty: missing.
  std::vector<std::string> source_joints;        ///< All joints of the source, for messages.

  [[nodiscard]] bool has(Bone bone) const { return !sources[bone].empty(); }
};

/// Frames [begin, end) in which a foot, or one end of it, is in contact.
struct ContactPhase {
  int begin = 0;
  int end = 0;
  double support = 0.0;  ///< Height of what is under it above the floor, metres; 0: the floor.

  friend bool operator==(const ContactPhase&, const ContactPhase&) = default;
};

/// When heels (ankles) and toes of a human stand, in order of time: left heel, left toe, right heel,
/// right toe.
using SourceContacts = std::array<std::vector<ContactPhase>, 4>;

/// World poses of the canonical bones, metres, Z up. Missing bones: identity.
using HumanPose = BoneArray<Pose>;

/// A canonical human's poses, frame by frame.
struct HumanClip : HumanClipInfo {
  std::vector<HumanPose> world_from_bone;  ///< One per frame.

  [[nodiscard]] const HumanPose& frame(int index) const {
    return world_from_bone[static_cast<std::size_t>(index)];
  }
};

}  // namespace retarget
