// Encodes the canonical human as poses of XRoboToolkit's body tracking, in lines as its Python
// binding returns them.

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "live/stream/human_bones.h"
#include "live/stream/stream_formats.h"
#include "live/stream/xrobot_joints.h"
#include "retarget/pose.h"

namespace retarget {
namespace {

class XrobotEncoder final : public Encoder {
 public:
  std::string begin(const Clip& clip) override;
  Result<std::string> frame(const Clip& clip, int frame) override;

 private:
  BonePoses bones_;
};

// No header: each frame has all joints.
std::string XrobotEncoder::begin(const Clip& clip) {
  bones_ = BonePoses(clip);
  return {};
}

// Joint rotations that are the identity in a T-pose that faces -z: those of with_z_ahead turned
// half a turn about y.
Pose with_z_behind(const Pose& world_from_bone) {
  const Pose ahead = with_z_ahead(world_from_bone);
  return {ahead.rotation * Eigen::Quaterniond(0.0, 0.0, 1.0, 0.0), ahead.translation};
}

Result<std::string> XrobotEncoder::frame(const Clip& clip, int frame) {
  constexpr double kWristToHand = 0.09;  // Metres, to the middle of the hand.
  bones_.set_frame(clip, frame);
  nlohmann::ordered_json joints = nlohmann::ordered_json::array();
  std::array<Pose, kXrobotJointCount> world_from_joint;
  for (std::size_t i = 0; i < kXrobotJointCount; ++i) {
    const XrobotJoint& joint = kXrobotJoints[i];
    Pose& pose = world_from_joint[i];
    // A joint that the clip lacks moves with its parent.
    if (bones_.has(joint.bone)) {
      pose = in_y_up_world(with_z_behind(bones_.world_from_bone(joint.bone)));
    } else if (joint.parent >= 0) {
      pose = world_from_joint[static_cast<std::size_t>(joint.parent)];
    }
    if (joint.is_end) {
      const double outwards = side_of(joint.bone) == Side::kLeft ? -kWristToHand : kWristToHand;
      pose.translation += pose.rotation * Eigen::Vector3d(outwards, 0.0, 0.0);
    }
    const auto& p = pose.translation;
    const auto& q = pose.rotation;
    joints.push_back({p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()});
  }
  const nlohmann::ordered_json line = {{"time", clip.rate().time_of(frame)},
                                       {"joints", std::move(joints)}};
  return line.dump() + "\n";
}

}  // namespace

std::unique_ptr<Encoder> make_xrobot_encoder() {
  return std::make_unique<XrobotEncoder>();
}

}  // namespace retarget
