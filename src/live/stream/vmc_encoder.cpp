// Encodes the canonical human as a VRM avatar whose performer uses VMC: one bundle per frame.

#include <array>
#include <map>
#include <string>

#include "live/stream/human_bones.h"
#include "live/stream/osc.h"
#include "live/stream/stream_formats.h"
#include "live/stream/unity_bones.h"
#include "retarget/pose.h"

namespace retarget {
namespace {

class VmcEncoder final : public Encoder {
 public:
  std::string begin(const Clip& clip) override;
  Result<std::string> frame(const Clip& clip, int frame) override;

 private:
  [[nodiscard]] Bone bone_of(const UnityBone& bone) const;

  BonePoses bones_;
};

// Receivers know the avatar or infer it from the bones.
std::string VmcEncoder::begin(const Clip& clip) {
  bones_ = BonePoses(clip);
  return {};
}

// An avatar must have a chest but need not have an upper chest.
Bone VmcEncoder::bone_of(const UnityBone& bone) const {
  if (bones_.has(Bone::kSpine1)) return bone.bone;
  if (bone.bone == Bone::kSpine1) return Bone::kSpine2;
  return bone.bone == Bone::kSpine2 ? Bone::kSpine1 : bone.bone;
}

void add_pose(const char* address, std::string_view name, const Pose& parent_from_bone,
              OscBundle& bundle) {
  const Pose pose = mirrored_across_x(parent_from_bone);
  const Eigen::Vector3d& p = pose.translation;
  const Eigen::Quaterniond& q = pose.rotation;
  bundle.add(address, "sfffffff", name,
             std::array{p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()});
}

Result<std::string> VmcEncoder::frame(const Clip& clip, int frame) {
  bones_.set_frame(clip, frame);
  OscBundle bundle;
  bundle.add("/VMC/Ext/OK", "i", {}, std::array{1.0});
  bundle.add("/VMC/Ext/T", "f", {}, std::array{clip.rate().time_of(frame)});
  add_pose("/VMC/Ext/Root/Pos", "root", Pose{}, bundle);
  // Children of a missing bone attach to its parent.
  std::map<std::string_view, Pose> world_from_bone = {{"root", Pose{}}};
  for (const UnityBone& unity : kUnityBones) {
    const Bone bone = bone_of(unity);
    const Pose parent = world_from_bone.at(unity.parent);
    Pose& world = world_from_bone[unity.name];
    world = parent;
    if (!bones_.has(bone)) continue;
    world = in_y_up_world(with_z_ahead(bones_.world_from_bone(bone)));
    add_pose("/VMC/Ext/Bone/Pos", unity.name, parent.inverse() * world, bundle);
  }
  return bundle.bytes();
}

}  // namespace

std::unique_ptr<Encoder> make_vmc_encoder() {
  return std::make_unique<VmcEncoder>();
}

}  // namespace retarget
