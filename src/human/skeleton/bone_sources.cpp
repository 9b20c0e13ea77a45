#include "human/skeleton/bone_sources.h"

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <utility>

#include "retarget/human_skeleton.h"

namespace retarget {
namespace {

using enum LimbBone;

constexpr double kForearmPerUpperArm = 0.8;
// Ankle to ball of the foot per length of thigh and shin, from LAFAN1's body.
constexpr double kFootPerLeg = 0.2;

class Sources {
 public:
  Sources(const Body& body, const JointFromBone& axes, const JointPoses& rest)
      : body_(body), axes_(axes), rest_(rest) {
    for (const Bone bone : kMappedBones) {
      if (is_mapped(bone)) {
        place(bone, body.joint(bone), body.turning_joint(bone), *axes[bone]);
      }
    }
    fill_trunk();
    for (const Side side : kSides) {
      fill_arm(side);
      fill_foot(side);
    }
  }

  BoneArray<BoneSource> take() { return std::move(sources_); }

 private:
  [[nodiscard]] bool is_mapped(Bone bone) const {
    return body_.joint(bone) >= 0 && axes_[bone].has_value();
  }

  void place(Bone bone, int position_joint, int rotation_joint, const Eigen::Matrix3d& axes) {
    sources_[bone] = {position_joint, rotation_joint, Eigen::Quaterniond(axes).normalized()};
  }

  // Attaches a bone rigidly to `like`, with their relative rotation in the T-pose.
  void turn_with(Bone bone, Bone like, int position_joint) {
    place(bone, position_joint, body_.turning_joint(like),
          *axes_[like] * canonical_t_pose(like).transpose() * canonical_t_pose(bone));
  }

  // As turn_with, at the far end of `like` or at `length` along it. Does nothing if both are
  // unknown.
  void hang_from(Bone bone, Bone like, const std::optional<double>& length = std::nullopt) {
    const Segment& end = body_.segment(like);
    if (!end.known() && !length) return;
    turn_with(bone, like, end.known() ? end.end_joint : body_.joint(like));
    sources_[bone].position_in_joint =
        end.known() ? end.offset : Eigen::Vector3d(length.value_or(0.0) * axes_[like]->col(0));
  }

  void fill_from_first(Bone bone, std::initializer_list<Bone> neighbours) {
    if (is_mapped(bone)) return;
    const auto* const found =
        std::ranges::find_if(neighbours, [this](Bone other) { return is_mapped(other); });
    if (found != neighbours.end()) turn_with(bone, *found, body_.joint(*found));
  }

  void fill_trunk() {
    fill_from_first(Bone::kSpine2, {Bone::kSpine1, Bone::kSpine, Bone::kHips});
    fill_from_first(Bone::kSpine1, {Bone::kSpine2, Bone::kSpine, Bone::kHips});
    fill_from_first(Bone::kSpine, {Bone::kSpine1, Bone::kSpine2, Bone::kHips});
    fill_from_first(Bone::kNeck, {Bone::kHead});
    if (!is_mapped(Bone::kHead) && is_mapped(Bone::kNeck)) hang_from(Bone::kHead, Bone::kNeck);
  }

  void fill_arm(Side side) {
    const Bone clavicle = side_bone(side, kShoulder), arm = side_bone(side, kArm);
    const Bone forearm = side_bone(side, kForeArm), hand = side_bone(side, kHand);
    if (!is_mapped(clavicle) && is_mapped(Bone::kSpine2) && is_mapped(arm)) {
      turn_with(clavicle, Bone::kSpine2, body_.joint(arm));
    }
    if (is_mapped(hand) || !is_mapped(forearm)) return;
    const double upper_arm = body_.skeleton().joint(body_.joint(forearm)).offset.norm();
    hang_from(hand, forearm, kForearmPerUpperArm * upper_arm);
  }

  void fill_foot(Side side) {
    const Bone foot = side_bone(side, kFoot), toe = side_bone(side, kToe);
    if (!is_mapped(foot)) return;
    turn_with(side_bone(side, kFootMod), is_mapped(toe) ? toe : foot, body_.joint(foot));
    if (is_mapped(toe)) return;
    const auto thigh = along(body_.segment(side_bone(side, kUpLeg)), rest_);
    const auto shin = along(body_.segment(side_bone(side, kLeg)), rest_);
    // Without toes or an end site, use LAFAN1's proportion.
    hang_from(
        toe, foot,
        thigh && shin ? std::optional(kFootPerLeg * (thigh->norm() + shin->norm())) : std::nullopt);
  }

  const Body& body_;
  const JointFromBone& axes_;
  const JointPoses& rest_;
  BoneArray<BoneSource> sources_;
};

}  // namespace

BoneArray<BoneSource> bone_sources(const Body& body, const JointFromBone& axes,
                                   const JointPoses& rest) {
  return Sources(body, axes, rest).take();
}

}  // namespace retarget
