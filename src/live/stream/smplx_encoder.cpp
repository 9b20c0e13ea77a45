// Encodes motions of SMPL as lines of JSON: motions read from SMPL files unchanged, other clips as
// the canonical human, whose bones correspond to SMPL's first 22 joints.

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "live/stream/human_bones.h"
#include "live/stream/stream_formats.h"
#include "retarget/smpl.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

// Indexed like kSmplJointNames.
constexpr auto kBones = std::to_array<Bone>(
    {Bone::kHips,      Bone::kLeftUpLeg,    Bone::kRightUpLeg,    Bone::kSpine,
     Bone::kLeftLeg,   Bone::kRightLeg,     Bone::kSpine1,        Bone::kLeftFoot,
     Bone::kRightFoot, Bone::kSpine2,       Bone::kLeftToe,       Bone::kRightToe,
     Bone::kNeck,      Bone::kLeftShoulder, Bone::kRightShoulder, Bone::kHead,
     Bone::kLeftArm,   Bone::kRightArm,     Bone::kLeftForeArm,   Bone::kRightForeArm,
     Bone::kLeftHand,  Bone::kRightHand});
static_assert(kBones.size() == kSmplJointCount);

// Joints indexed like kSmplJointNames if the skeleton has all of them with SMPL's parents;
// otherwise empty.
std::vector<int> smpl_joints_of(const Skeleton& skeleton) {
  std::vector<int> joints;
  for (int i = 0; i < kSmplJointCount; ++i) {
    const auto found = skeleton.find(kSmplJointNames[static_cast<std::size_t>(i)]);
    const int parent = kSmplParents[static_cast<std::size_t>(i)];
    if (!found || skeleton.joint(*found).parent !=
                      (parent < 0 ? -1 : joints[static_cast<std::size_t>(parent)])) {
      return {};
    }
    joints.push_back(*found);
  }
  return joints;
}

std::vector<Eigen::Vector3d> offsets_of(const Skeleton& skeleton, const std::vector<int>& joints) {
  std::vector<Eigen::Vector3d> offsets;
  offsets.reserve(joints.size());
  for (const int joint : joints) offsets.push_back(skeleton.joint(joint).offset);
  return offsets;
}

// Whether the rotations are SMPL's: the zero pose is its T-pose, in metres, and the body is upright
// in a Z-up world, as in AMASS.
bool is_smpl_motion(const Clip& clip) {
  const Skeleton& skeleton = clip.skeleton();
  const std::vector<int> joints = smpl_joints_of(skeleton);
  if (joints.empty() || skeleton.translated_count() != 1 || clip.frame_count() == 0 ||
      clip.origin().metres_per_unit.value_or(1.0) != 1.0 ||
      !smpl_rest_body_of_offsets(offsets_of(skeleton, joints))) {
    return false;
  }
  double upright = 0.0;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    upright += (clip.rotations(frame)[0] * Eigen::Vector3d::UnitY()).z() / clip.frame_count();
  }
  constexpr double kUpright = 0.5;
  return upright > kUpright;
}

Json list_of(const Eigen::Vector3d& vector) {
  return Json::array({vector.x(), vector.y(), vector.z()});
}

class SmplxEncoder final : public Encoder {
 public:
  std::string begin(const Clip& clip) override;
  Result<std::string> frame(const Clip& clip, int frame) override;

 private:
  [[nodiscard]] Pose world_from_joint(int joint) const;

  std::vector<int> joints_;  // Of an SMPL motion; empty: canonical human.
  BonePoses bones_;
};

// Pose in SMPL's axes, which are those of its body in the T-pose. A missing joint moves with its
// parent.
Pose SmplxEncoder::world_from_joint(int joint) const {
  while (joint > 0 && !bones_.has(kBones[static_cast<std::size_t>(joint)])) {
    joint = kSmplParents[static_cast<std::size_t>(joint)];
  }
  const Bone bone = kBones[static_cast<std::size_t>(joint)];
  return bones_.has(bone) ? with_z_ahead(bones_.world_from_bone(bone)) : Pose{};
}

std::string SmplxEncoder::begin(const Clip& clip) {
  std::vector<Eigen::Vector3d> offsets;
  joints_.clear();
  if (is_smpl_motion(clip)) {
    joints_ = smpl_joints_of(clip.skeleton());
    offsets = offsets_of(clip.skeleton(), joints_);
  } else {
    // Before the first frame, the bones are in the T-pose.
    bones_ = BonePoses(clip);
    for (int joint = 0; joint < kSmplJointCount; ++joint) {
      const int parent = kSmplParents[static_cast<std::size_t>(joint)];
      offsets.push_back(parent < 0 ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                   : Eigen::Vector3d(world_from_joint(parent).inverse() *
                                                     world_from_joint(joint).translation));
    }
  }
  Json header = {{"up", "z"}};
  if (clip.origin().body_height) header["height"] = *clip.origin().body_height;
  header["rest_offsets"] = Json::array();
  for (const Eigen::Vector3d& offset : offsets) header["rest_offsets"].push_back(list_of(offset));
  return header.dump() + "\n";
}

Result<std::string> SmplxEncoder::frame(const Clip& clip, int frame) {
  if (joints_.empty()) bones_.set_frame(clip, frame);
  Eigen::Vector3d transl = Eigen::Vector3d::Zero();
  Json root, body = Json::array();
  for (int joint = 0; joint < kSmplJointCount; ++joint) {
    Eigen::Quaterniond rotation;
    if (!joints_.empty()) {
      rotation =
          clip.rotations(frame)[static_cast<std::size_t>(joints_[static_cast<std::size_t>(joint)])];
      if (joint == 0) transl = clip.translations(frame)[0];
    } else {
      const int parent = kSmplParents[static_cast<std::size_t>(joint)];
      const Pose world = world_from_joint(joint);
      rotation = parent < 0 ? world.rotation
                            : world_from_joint(parent).rotation.conjugate() * world.rotation;
      if (joint == 0) transl = world.translation;
    }
    const Json vector = list_of(log_so3(rotation));
    if (joint == 0) {
      root = vector;
    } else {
      body.insert(body.end(), vector.begin(), vector.end());
    }
  }
  const Json line = {{"time", clip.rate().time_of(frame)},
                     {"transl", list_of(transl)},
                     {"global_orient", root},
                     {"body_pose", std::move(body)}};
  return line.dump() + "\n";
}

}  // namespace

std::unique_ptr<Encoder> make_smplx_encoder() {
  return std::make_unique<SmplxEncoder>();
}

bool smplx_plays_human(const Clip& clip) {
  return !is_smpl_motion(clip);
}

}  // namespace retarget
