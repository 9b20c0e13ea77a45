#include "human/bone_sources.h"

#include <array>
#include <charconv>
#include <initializer_list>

#include "human/canonical_pose.h"

namespace retarget {
namespace {

using enum LimbBone;

constexpr double kForearmPerUpperArm = 0.8;
// ankle to ball of the foot by thigh and shin, as LAFAN1's body has them
constexpr double kFootPerLeg = 0.2;

class Sources {
 public:
  Sources(const Body& body, const JointFromBone& axes, const JointPoses& rest)
      : body_(body), axes_(axes), rest_(rest) {
    for (const Bone bone : kMappedBones) {
      if (const int joint = body.joint(bone); joint >= 0 && axes[bone]) {
        place(bone, joint, body.turning_joint(bone), *axes[bone]);
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
  BoneSource& of(Bone bone) { return sources_[bone]; }
  [[nodiscard]] bool is_mapped(Bone bone) const {
    return body_.joint(bone) >= 0 && axes_[bone].has_value();
  }

  void place(Bone bone, int position_joint, int rotation_joint, const Eigen::Matrix3d& axes) {
    BoneSource& source = sources_[bone];
    source.position_joint = position_joint;
    source.rotation_joint = rotation_joint;
    source.joint_from_bone = Eigen::Quaterniond(axes).normalized();
  }

  // turned like `like`, stiffly, as both are in the T-pose
  void turn_with(Bone bone, Bone like, int position_joint) {
    place(bone, position_joint, body_.turning_joint(like),
          *axes_[like] * canonical_t_pose(like).transpose() * canonical_t_pose(bone));
  }

  void fill_from_first(Bone bone, std::initializer_list<Bone> neighbours) {
    if (is_mapped(bone)) return;
    for (const Bone neighbour : neighbours) {
      if (!is_mapped(neighbour)) continue;
      turn_with(bone, neighbour, body_.joint(neighbour));
      return;
    }
  }

  void fill_trunk() {
    fill_from_first(Bone::kSpine2, {Bone::kSpine1, Bone::kSpine, Bone::kHips});
    fill_from_first(Bone::kSpine1, {Bone::kSpine2, Bone::kSpine, Bone::kHips});
    fill_from_first(Bone::kSpine, {Bone::kSpine1, Bone::kSpine2, Bone::kHips});
    if (!is_mapped(Bone::kNeck) && is_mapped(Bone::kHead)) {
      turn_with(Bone::kNeck, Bone::kHead, body_.joint(Bone::kHead));
    }
    if (is_mapped(Bone::kHead) || !is_mapped(Bone::kNeck)) return;
    const Segment& neck = body_.segment(Bone::kNeck);
    if (!neck.known()) return;
    turn_with(Bone::kHead, Bone::kNeck, neck.end_joint);
    of(Bone::kHead).position_in_joint = neck.offset;
  }

  void fill_arm(Side side) {
    if (!is_mapped(side_bone(side, kShoulder)) && is_mapped(Bone::kSpine2) &&
        is_mapped(side_bone(side, kArm))) {
      turn_with(side_bone(side, kShoulder), Bone::kSpine2, body_.joint(side_bone(side, kArm)));
    }
    if (is_mapped(side_bone(side, kHand)) || !is_mapped(side_bone(side, kForeArm))) return;
    const int forearm = body_.joint(side_bone(side, kForeArm));
    turn_with(side_bone(side, kHand), side_bone(side, kForeArm), forearm);
    const Segment& end = body_.segment(side_bone(side, kForeArm));
    if (end.known()) {
      of(side_bone(side, kHand)).position_joint = end.end_joint;
      of(side_bone(side, kHand)).position_in_joint = end.offset;
      return;
    }
    const double length = kForearmPerUpperArm * body_.skeleton().joint(forearm).offset.norm();
    of(side_bone(side, kHand)).position_in_joint =
        length * axes_[side_bone(side, kForeArm)]->col(0);
  }

  void fill_foot(Side side) {
    if (!is_mapped(side_bone(side, kFoot))) return;
    const int foot = body_.joint(side_bone(side, kFoot));
    if (is_mapped(side_bone(side, kToe))) {
      turn_with(side_bone(side, kFootMod), side_bone(side, kToe), foot);
      return;
    }
    turn_with(side_bone(side, kFootMod), side_bone(side, kFoot), foot);
    const Segment& end = body_.segment(side_bone(side, kFoot));
    const auto thigh = along(body_.segment(side_bone(side, kUpLeg)), rest_);
    const auto shin = along(body_.segment(side_bone(side, kLeg)), rest_);
    if (!end.known() && !(thigh && shin)) return;
    turn_with(side_bone(side, kToe), side_bone(side, kFoot), end.known() ? end.end_joint : foot);
    // an ankle alone has the foot of a common body
    of(side_bone(side, kToe)).position_in_joint =
        end.known() ? end.offset
                    : Eigen::Vector3d(kFootPerLeg * (thigh->norm() + shin->norm()) *
                                      axes_[side_bone(side, kFoot)]->col(0));
  }

  const Body& body_;
  const JointFromBone& axes_;
  const JointPoses& rest_;
  BoneArray<BoneSource> sources_;
};

std::string fixed(double value, int decimals) {
  std::array<char, 400> text;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value,
                                          std::chars_format::fixed, decimals);
  return {text.data(), end};
}

// as few digits as tell it from others
std::string shortest(double value) {
  std::array<char, 40> text;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end};
}

}  // namespace

std::string metres_text(double metres) {
  return fixed(metres, 2) + " m";
}

BoneArray<BoneSource> bone_sources(const Body& body, const JointFromBone& axes,
                                   const JointPoses& rest) {
  return Sources(body, axes, rest).take();
}

namespace {

void complete_lafan1_toe(const Body& body, Side side, BoneArray<BoneSource>& bones) {
  const int foot = body.joint(side_bone(side, kFoot)),
            turning = body.turning_joint(side_bone(side, kFoot));
  if (foot < 0 || body.turning_joint(side_bone(side, kToe)) >= 0) return;
  const Eigen::Quaterniond foot_from_toe(
      Eigen::Matrix3d(canonical_t_pose(side_bone(side, kFoot)).transpose() *
                      canonical_t_pose(side_bone(side, kToe))));
  const Segment& end = body.segment(side_bone(side, kFoot));
  const double leg = length_by_offsets(body, side_bone(side, kUpLeg)) +
                     length_by_offsets(body, side_bone(side, kLeg));
  BoneSource& toe = bones[side_bone(side, kToe)];
  toe = {end.known() ? end.end_joint : turning, turning, foot_from_toe,
         end.known() ? end.offset : Eigen::Vector3d(kFootPerLeg * leg, 0.0, 0.0)};
  bones[side_bone(side, kFootMod)] = {foot, turning, foot_from_toe};
}

// hands have the axes of their forearms
void complete_lafan1_hand(const Body& body, Side side, BoneArray<BoneSource>& bones) {
  const int forearm = body.joint(side_bone(side, kForeArm)),
            turning = body.turning_joint(side_bone(side, kForeArm));
  if (forearm < 0 || body.has(side_bone(side, kHand))) return;
  const Segment& end = body.segment(side_bone(side, kForeArm));
  const double length = kForearmPerUpperArm * length_by_offsets(body, side_bone(side, kArm));
  bones[side_bone(side, kHand)] = {end.known() ? end.end_joint : turning, turning, std::nullopt,
                                   end.known() ? end.offset : Eigen::Vector3d(length, 0.0, 0.0)};
}

}  // namespace

void complete_lafan1_ends(const Body& body, BoneArray<BoneSource>& bones) {
  for (const Side side : kSides) {
    complete_lafan1_toe(body, side, bones);
    complete_lafan1_hand(body, side, bones);
  }
}

std::string describe_calibration(const Calibration& calibration) {
  const std::string height = metres_text(calibration.mapping.height);
  if (calibration.rest_pose.starts_with("lafan1")) {
    return "LAFAN1 skeleton, unit " + calibration.unit + ", up " + to_text(calibration.up) +
           ", body height " + height;
  }
  return calibration.mapping.dialect + " skeleton, unit " + calibration.unit + " (" +
         shortest(calibration.mapping.metres_per_unit) + " m), up " + to_text(calibration.up) +
         ", facing " + to_text(calibration.forward) + ", body height " + height + ", T-pose " +
         (calibration.rest_pose == "learned"
              ? "learned from the movement"
              : "from " + calibration.rest_pose + " (" + fixed(calibration.rest_deviation, 0) +
                    " degrees off)");
}

}  // namespace retarget
