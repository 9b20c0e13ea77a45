// Encodes the canonical human as an actor of Rokoko Studio: JSON, version 3, one object and a line
// end per frame.

#include <nlohmann/json.hpp>
#include <string>

#include "live/stream/human_bones.h"
#include "live/stream/rokoko_bones.h"
#include "live/stream/stream_formats.h"
#include "retarget/pose.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

class RokokoEncoder final : public Encoder {
 public:
  std::string begin(const Clip& clip) override;
  Result<std::string> frame(const Clip& clip, int frame) override;

 private:
  BonePoses bones_;
  double hip_height_ = 0.0;  // Metres, in the T-pose.
};

// No header: each frame contains the complete actor.
std::string RokokoEncoder::begin(const Clip& clip) {
  bones_ = BonePoses(clip);
  // Before the first frame, the bones are in the T-pose.
  if (bones_.has(Bone::kHips) && bones_.has(Bone::kLeftFoot)) {
    hip_height_ = bones_.world_from_bone(Bone::kHips).translation.z() -
                  bones_.world_from_bone(Bone::kLeftFoot).translation.z();
  }
  return {};
}

Json bone_of(const RokokoBone& bone, const Pose& world_from_bone) {
  const Pose unity = mirrored_across_x(in_y_up_world(with_z_ahead(world_from_bone)));
  const Eigen::Vector3d& p = unity.translation;
  const Eigen::Quaterniond q = unity.rotation * rokoko_t_pose_of(bone);
  return {{"position", {{"x", p.x()}, {"y", p.y()}, {"z", p.z()}}},
          {"rotation", {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}}};
}

Result<std::string> RokokoEncoder::frame(const Clip& clip, int frame) {
  bones_.set_frame(clip, frame);
  Json body = Json::object();
  std::array<Pose, kRokokoBoneCount> world_from_bone;
  for (std::size_t i = 0; i < kRokokoBoneCount; ++i) {
    const RokokoBone& bone = kRokokoBones[i];
    if (bone.is_end) continue;
    // Receivers expect every bone, so a missing one moves with its parent.
    if (bones_.has(bone.bone)) {
      world_from_bone[i] = bones_.world_from_bone(bone.bone);
    } else if (bone.parent >= 0) {
      world_from_bone[i] = world_from_bone[static_cast<std::size_t>(bone.parent)];
    }
    body[std::string(bone.name)] = bone_of(bone, world_from_bone[i]);
  }
  Json actor = {
      {"name", "retarget"},
      {"color", {255, 255, 255}},
      {"meta",
       {{"hasGloves", false},
        {"hasLeftGlove", false},
        {"hasRightGlove", false},
        {"hasBody", true},
        {"hasFace", false}}},
      {"dimensions",
       {{"totalHeight", clip.origin().body_height.value_or(0.0)}, {"hipHeight", hip_height_}}},
      {"body", std::move(body)}};
  const Json packet = {{"version", 3},
                       {"fps", clip.rate().fps()},
                       {"scene",
                        {{"timestamp", clip.rate().time_of(frame)},
                         {"actors", Json::array({std::move(actor)})},
                         {"characters", Json::array()},
                         {"props", Json::array()}}}};
  return packet.dump() + "\n";
}

}  // namespace

std::unique_ptr<Encoder> make_rokoko_encoder() {
  return std::make_unique<RokokoEncoder>();
}

}  // namespace retarget
