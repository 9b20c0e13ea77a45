#include "human/bone_sources.h"

#include <array>
#include <charconv>
#include <initializer_list>

#include "human/canonical_pose.h"

namespace retarget {
namespace {

constexpr double kForearmPerUpperArm = 0.8;
// ankle to ball of the foot by thigh and shin, as LAFAN1's body has them
constexpr double kFootPerLeg = 0.2;

int index_of(const std::string& bone) {
  return find_bone(bone).value();
}

class Sources {
 public:
  Sources(const Body& body, const JointFromBone& axes, const JointPoses& rest)
      : body_(body), axes_(axes), rest_(rest) {
    sources_.resize(kBoneCount);
    for (int bone = 0; bone < kMappedBoneCount; ++bone) {
      if (const int joint = body.joint(bone); joint >= 0 && axes[bone]) {
        place(bone, joint, body.turning_joint(bone), *axes[bone]);
      }
    }
    fill_trunk();
    for (const std::string side : {"Left", "Right"}) {
      fill_arm(side);
      fill_foot(side);
    }
  }

  std::vector<BoneSource> take() { return std::move(sources_); }

 private:
  BoneSource& of(const std::string& bone) {
    return sources_[static_cast<std::size_t>(index_of(bone))];
  }
  [[nodiscard]] bool is_mapped(const std::string& bone) const {
    const int index = index_of(bone);
    return body_.joint(index) >= 0 && axes_[static_cast<std::size_t>(index)].has_value();
  }

  void place(int bone, int position_joint, int rotation_joint, const Eigen::Matrix3d& axes) {
    BoneSource& source = sources_[static_cast<std::size_t>(bone)];
    source.position_joint = position_joint;
    source.rotation_joint = rotation_joint;
    source.joint_from_bone = Eigen::Quaterniond(axes).normalized();
  }

  // turned like `like`, stiffly, as both are in the T-pose
  void turn_with(const std::string& bone, const std::string& like, int position_joint) {
    const int index = index_of(bone), model = index_of(like);
    place(index, position_joint, body_.turning_joint(model),
          *axes_[static_cast<std::size_t>(model)] * canonical_t_pose(model).transpose() *
              canonical_t_pose(index));
  }

  void fill_from_first(const std::string& bone, std::initializer_list<const char*> neighbours) {
    if (is_mapped(bone)) return;
    for (const char* neighbour : neighbours) {
      if (!is_mapped(neighbour)) continue;
      turn_with(bone, neighbour, body_.joint(neighbour));
      return;
    }
  }

  void fill_trunk() {
    fill_from_first("Spine2", {"Spine1", "Spine", "Hips"});
    fill_from_first("Spine1", {"Spine2", "Spine", "Hips"});
    fill_from_first("Spine", {"Spine1", "Spine2", "Hips"});
    if (!is_mapped("Neck") && is_mapped("Head")) turn_with("Neck", "Head", body_.joint("Head"));
    if (is_mapped("Head") || !is_mapped("Neck")) return;
    const Segment& neck = body_.segment("Neck");
    if (!neck.known()) return;
    turn_with("Head", "Neck", neck.end_joint);
    of("Head").position_in_joint = neck.offset;
  }

  void fill_arm(const std::string& side) {
    if (!is_mapped(side + "Shoulder") && is_mapped("Spine2") && is_mapped(side + "Arm")) {
      turn_with(side + "Shoulder", "Spine2", body_.joint(side + "Arm"));
    }
    if (is_mapped(side + "Hand") || !is_mapped(side + "ForeArm")) return;
    const int forearm = body_.joint(side + "ForeArm");
    turn_with(side + "Hand", side + "ForeArm", forearm);
    const Segment& end = body_.segment(side + "ForeArm");
    if (end.known()) {
      of(side + "Hand").position_joint = end.end_joint;
      of(side + "Hand").position_in_joint = end.offset;
      return;
    }
    const double length = kForearmPerUpperArm * body_.skeleton().joint(forearm).offset.norm();
    of(side + "Hand").position_in_joint =
        length * axes_[static_cast<std::size_t>(index_of(side + "ForeArm"))]->col(0);
  }

  void fill_foot(const std::string& side) {
    if (!is_mapped(side + "Foot")) return;
    const int foot = body_.joint(side + "Foot");
    if (is_mapped(side + "Toe")) {
      turn_with(side + "FootMod", side + "Toe", foot);
      return;
    }
    turn_with(side + "FootMod", side + "Foot", foot);
    const Segment& end = body_.segment(side + "Foot");
    const auto thigh = along(body_.segment(side + "UpLeg"), rest_);
    const auto shin = along(body_.segment(side + "Leg"), rest_);
    if (!end.known() && !(thigh && shin)) return;
    turn_with(side + "Toe", side + "Foot", end.known() ? end.end_joint : foot);
    // an ankle alone has the foot of a common body
    of(side + "Toe").position_in_joint =
        end.known()
            ? end.offset
            : Eigen::Vector3d(kFootPerLeg * (thigh->norm() + shin->norm()) *
                              axes_[static_cast<std::size_t>(index_of(side + "Foot"))]->col(0));
  }

  const Body& body_;
  const JointFromBone& axes_;
  const JointPoses& rest_;
  std::vector<BoneSource> sources_;
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

std::vector<BoneSource> bone_sources(const Body& body, const JointFromBone& axes,
                                     const JointPoses& rest) {
  return Sources(body, axes, rest).take();
}

namespace {

void complete_lafan1_toe(const Body& body, const std::string& side,
                         std::vector<BoneSource>& bones) {
  const int foot = body.joint(side + "Foot"), turning = body.turning_joint(side + "Foot");
  if (foot < 0 || body.turning_joint(side + "Toe") >= 0) return;
  const Eigen::Quaterniond foot_from_toe(
      Eigen::Matrix3d(canonical_t_pose(index_of(side + "Foot")).transpose() *
                      canonical_t_pose(index_of(side + "Toe"))));
  const Segment& end = body.segment(side + "Foot");
  const double leg =
      length_by_offsets(body, side + "UpLeg") + length_by_offsets(body, side + "Leg");
  BoneSource& toe = bones[static_cast<std::size_t>(index_of(side + "Toe"))];
  toe = {end.known() ? end.end_joint : turning, turning, foot_from_toe,
         end.known() ? end.offset : Eigen::Vector3d(kFootPerLeg * leg, 0.0, 0.0)};
  bones[static_cast<std::size_t>(index_of(side + "FootMod"))] = {foot, turning, foot_from_toe};
}

// hands have the axes of their forearms
void complete_lafan1_hand(const Body& body, const std::string& side,
                          std::vector<BoneSource>& bones) {
  const int forearm = body.joint(side + "ForeArm"), turning = body.turning_joint(side + "ForeArm");
  if (forearm < 0 || body.has(side + "Hand")) return;
  const Segment& end = body.segment(side + "ForeArm");
  const double length = kForearmPerUpperArm * length_by_offsets(body, side + "Arm");
  bones[static_cast<std::size_t>(index_of(side + "Hand"))] = {
      end.known() ? end.end_joint : turning, turning, std::nullopt,
      end.known() ? end.offset : Eigen::Vector3d(length, 0.0, 0.0)};
}

}  // namespace

void complete_lafan1_ends(const Body& body, std::vector<BoneSource>& bones) {
  for (const std::string side : {"Left", "Right"}) {
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
