// Decodes the body tracking of PICO headsets as JSON, one object per line: 24 poses in the order of
// OpenXR's XR_BD_body_tracking, as sent by XRoboToolkit's client (TrackingData.cs, "Body") and
// returned by its Python binding (get_body_joints_pose). Right-handed, Y up, metres. In a T-pose
// that faces -z all joint rotations are the identity.

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "live/stream/human_bones.h"
#include "live/stream/message_cutter.h"
#include "live/stream/stream_formats.h"
#include "live/stream/stream_skeleton.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

/// A joint of the body tracking of PICO headsets, numbered as in OpenXR's XR_BD_body_tracking
/// (XrBodyJointBD) and sent by XRoboToolkit: SMPL's joints, and a hand beyond each wrist.
struct XrobotJoint {
  std::string_view name;
  int parent;           ///< Index into kXrobotJoints; -1: none.
  Bone bone;            ///< Canonical bone; for a hand, that of its wrist.
  bool is_end = false;  ///< An end without a bone of its own.
};

/// Joints in the order of the poses; parents precede children.
constexpr auto kXrobotJoints = std::to_array<XrobotJoint>({
    {"Pelvis", -1, Bone::kHips},
    {"Left_Hip", 0, Bone::kLeftUpLeg},
    {"Right_Hip", 0, Bone::kRightUpLeg},
    {"Spine1", 0, Bone::kSpine},
    {"Left_Knee", 1, Bone::kLeftLeg},
    {"Right_Knee", 2, Bone::kRightLeg},
    {"Spine2", 3, Bone::kSpine1},
    {"Left_Ankle", 4, Bone::kLeftFoot},
    {"Right_Ankle", 5, Bone::kRightFoot},
    {"Spine3", 6, Bone::kSpine2},
    {"Left_Foot", 7, Bone::kLeftToe},
    {"Right_Foot", 8, Bone::kRightToe},
    {"Neck", 9, Bone::kNeck},
    {"Left_Collar", 9, Bone::kLeftShoulder},
    {"Right_Collar", 9, Bone::kRightShoulder},
    {"Head", 12, Bone::kHead},
    {"Left_Shoulder", 13, Bone::kLeftArm},
    {"Right_Shoulder", 14, Bone::kRightArm},
    {"Left_Elbow", 16, Bone::kLeftForeArm},
    {"Right_Elbow", 17, Bone::kRightForeArm},
    {"Left_Wrist", 18, Bone::kLeftHand},
    {"Right_Wrist", 19, Bone::kRightHand},
    {"Left_Hand", 20, Bone::kLeftHand, true},
    {"Right_Hand", 21, Bone::kRightHand, true},
});
constexpr std::size_t kXrobotJointCount = kXrobotJoints.size();

using PoseNumbers = std::array<double, 7>;  // x y z, x y z w

std::optional<PoseNumbers> numbers_of_list(const PacketJson& json) {
  PoseNumbers numbers{};
  if (json.size() != numbers.size()) return std::nullopt;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!json[i].is_number()) return std::nullopt;
    numbers[i] = json[i].get<double>();
  }
  return numbers;
}

std::optional<PoseNumbers> numbers_of_text(std::string_view text) {
  PoseNumbers numbers{};
  const auto found = numbers_from_text(text, ',');
  if (!found || found->size() != numbers.size()) return std::nullopt;
  std::ranges::copy(*found, numbers.begin());
  return numbers;
}

// Reads [x, y, z, x, y, z, w], or {"p": "x,y,z,x,y,z,w"}; ignores velocities.
Result<Pose> world_from_xrobot_joint(const PacketJson& json, std::string_view joint) {
  constexpr double kMaxLength = 1e4, kMinNorm = 0.1;  // metres
  std::optional<PoseNumbers> found;
  if (json.is_array()) {
    found = numbers_of_list(json);
  } else if (json.is_object()) {
    const PacketJson* pose = find_member(json, {"p"});
    if (pose != nullptr && pose->is_string()) found = numbers_of_text(pose->get<std::string>());
  }
  // Negated, so that NaN fails.
  if (!found || !std::ranges::all_of(*found, [](double n) { return std::abs(n) < kMaxLength; })) {
    return bad_packet(
        fmt::format("{}: expected seven numbers, position x y z and rotation x y z w", joint));
  }
  const auto& [x, y, z, qx, qy, qz, qw] = *found;
  const Eigen::Quaterniond rotation(qw, qx, qy, qz);
  if (rotation.norm() < kMinNorm) {
    return bad_packet(fmt::format("{} is not tracked: its rotation is zero", joint));
  }
  return Pose{rotation.normalized(), {x, y, z}};
}

// Returns seconds; NaN: none.
double xrobot_time(const PacketJson& line, const PacketJson& body) {
  constexpr double kMaxTime = 1e12, kNanoseconds = 1e-9;
  const auto number = [](const PacketJson& json, const char* name) {
    const PacketJson* found = find_member(json, {name});
    return found != nullptr && found->is_number() ? std::optional(found->get<double>())
                                                  : std::nullopt;
  };
  std::optional<double> time = number(line, "time");
  if (!time) {
    auto nanoseconds = number(body, "timeStampNs");
    if (!nanoseconds) nanoseconds = number(line, "timeStampNs");
    if (nanoseconds) time = kNanoseconds * *nanoseconds;
  }
  return time && std::abs(*time) < kMaxTime ? *time : std::numeric_limits<double>::quiet_NaN();
}

class XrobotDecoder final : public Decoder {
 public:
  Result<void> take(std::string_view bytes, StreamSink& sink) override;
  void know_skeleton(const std::shared_ptr<const Skeleton>& skeleton) override {
    skeleton_.know(skeleton);
  }
  void know_up(const Eigen::Vector3d& up) override { skeleton_.know_up(up); }
  void restart() override { has_skeleton_ = false; }

 private:
  Result<void> take_object(const PacketJson& line, StreamSink& sink);
  Result<void> learn_skeleton(StreamSink& sink);

  bool has_skeleton_ = false;
  std::array<Pose, kXrobotJointCount> world_from_joint_;
  StreamSkeleton skeleton_;
};

Result<void> XrobotDecoder::take(std::string_view bytes, StreamSink& sink) {
  RETARGET_TRY_ASSIGN(const PacketJson line, parse_json_line(bytes));
  // The service wraps the client's object in a string.
  const PacketJson* value = find_member(line, {"value"});
  if (value == nullptr || !value->is_string()) return take_object(line, sink);
  RETARGET_TRY_ASSIGN(const PacketJson inner,
                      parse_packet_json(value->get<std::string>(), "\"value\""));
  if (!inner.is_object()) return bad_packet("\"value\" must be a JSON object");
  return take_object(inner, sink);
}

Result<void> XrobotDecoder::take_object(const PacketJson& line, StreamSink& sink) {
  const PacketJson* inner = find_member(line, {"Body"});
  const PacketJson& body = inner != nullptr && inner->is_object() ? *inner : line;
  const PacketJson* joints = find_member(body, {"joints"});
  if (joints == nullptr || !joints->is_array() || joints->size() != kXrobotJointCount) {
    return bad_packet(
        fmt::format("expected \"joints\", a list of {} poses, or a \"Body\" with it; is full body "
                    "tracking enabled?",
                    kXrobotJointCount));
  }
  for (std::size_t i = 0; i < kXrobotJointCount; ++i) {
    RETARGET_TRY_ASSIGN(world_from_joint_[i],
                        world_from_xrobot_joint((*joints)[i], kXrobotJoints[i].name));
  }
  if (!has_skeleton_) RETARGET_TRY(learn_skeleton(sink));
  skeleton_.give(xrobot_time(line, body), world_from_joint_, sink);
  return {};
}

// Builds the skeleton from a frame: each joint has its current offset from its parent. Rejects
// frames without plausible bone lengths, because all joints may coincide before tracking starts.
Result<void> XrobotDecoder::learn_skeleton(StreamSink& sink) {
  constexpr double kShortest = 0.1;  // Metres, of a thigh, a shank and an upper arm.
  constexpr std::array<std::size_t, 6> kLongBones = {4, 5, 7, 8, 18, 19};
  std::vector<StreamJoint> joints;
  for (std::size_t i = 0; i < kXrobotJointCount; ++i) {
    const auto& [name, parent, bone, is_end] = kXrobotJoints[i];
    joints.push_back(
        {std::string(name), parent,
         parent_from_joint(world_from_joint_, parent, world_from_joint_[i]).translation});
  }
  for (const std::size_t i : kLongBones) {
    if (joints[i].offset.norm() > kShortest) continue;
    return bad_packet(fmt::format("the body is not tracked yet: {} and {} are {:.2f} m apart",
                                  joints[static_cast<std::size_t>(joints[i].parent)].name,
                                  joints[i].name, joints[i].offset.norm()));
  }
  has_skeleton_ = true;
  skeleton_.set_joints(std::move(joints), Eigen::Vector3d::UnitY(), true, sink);
  return {};
}

// Encodes the canonical human as poses of XRoboToolkit's body tracking, in lines as its Python
// binding returns them.

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
  const std::vector<Pose> world_from_bone = bones_.poses_of(kXrobotJoints);
  for (std::size_t i = 0; i < kXrobotJointCount; ++i) {
    const XrobotJoint& joint = kXrobotJoints[i];
    Pose pose = in_y_up_world(with_z_behind(world_from_bone[i]));
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

StreamFormat xrobot_format() {
  return {.name = "xrobot",
          .description =
              "body tracking of PICO and Quest headsets by XRoboToolkit: 24 poses, "
              "JSON, one object per line",
          .decoder = make_decoder<XrobotDecoder>,
          .encoder = make_encoder<XrobotEncoder>,
          .plays_human = [](const Clip&) { return true; }};
}

}  // namespace retarget
