// Decodes VMC (Virtual Motion Capture protocol), the messages from a performer to a marionette:
// protocol.vmc.info/marionette-spec. They contain poses of Unity's human bones relative to their
// parents, in Unity's axes: left-handed, Y up, metres. In its T-pose, the bones of a VRM avatar
// have no rotation.

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "live/stream/human_bones.h"
#include "live/stream/osc.h"
#include "live/stream/stream_formats.h"
#include "live/stream/stream_skeleton.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "retarget/try.h"

namespace retarget {
namespace {

/// A bone of Unity's HumanBodyBones, as in VRM avatars.
struct UnityBone {
  std::string_view name, parent;
  Bone bone;  ///< Canonical bone.
};

/// Parents precede children; fingers, eyes and jaw are omitted because they move no robot.
constexpr auto kUnityBones = std::to_array<UnityBone>({
    {"Hips", "root", Bone::kHips},
    {"Spine", "Hips", Bone::kSpine},
    {"Chest", "Spine", Bone::kSpine1},
    {"UpperChest", "Chest", Bone::kSpine2},
    {"Neck", "UpperChest", Bone::kNeck},
    {"Head", "Neck", Bone::kHead},
    {"LeftShoulder", "UpperChest", Bone::kLeftShoulder},
    {"LeftUpperArm", "LeftShoulder", Bone::kLeftArm},
    {"LeftLowerArm", "LeftUpperArm", Bone::kLeftForeArm},
    {"LeftHand", "LeftLowerArm", Bone::kLeftHand},
    {"RightShoulder", "UpperChest", Bone::kRightShoulder},
    {"RightUpperArm", "RightShoulder", Bone::kRightArm},
    {"RightLowerArm", "RightUpperArm", Bone::kRightForeArm},
    {"RightHand", "RightLowerArm", Bone::kRightHand},
    {"LeftUpperLeg", "Hips", Bone::kLeftUpLeg},
    {"LeftLowerLeg", "LeftUpperLeg", Bone::kLeftLeg},
    {"LeftFoot", "LeftLowerLeg", Bone::kLeftFoot},
    {"LeftToes", "LeftFoot", Bone::kLeftToe},
    {"RightUpperLeg", "Hips", Bone::kRightUpLeg},
    {"RightLowerLeg", "RightUpperLeg", Bone::kRightLeg},
    {"RightFoot", "RightLowerLeg", Bone::kRightFoot},
    {"RightToes", "RightFoot", Bone::kRightToe},
});
constexpr std::size_t kUnityBoneCount = kUnityBones.size();

/// Index of a bone in kUnityBones; kUnityBoneCount if the name is unknown.
[[nodiscard]] constexpr std::size_t unity_bone_index(std::string_view name) {
  return static_cast<std::size_t>(std::ranges::find(kUnityBones, name, &UnityBone::name) -
                                  kUnityBones.begin());
}

// Reads x y z, x y z w relative to a left-handed parent and mirrors them across x.
Result<Pose> mirrored_pose(const OscMessage& message) {
  constexpr double kMaxLength = 1e4, kMinNorm = 0.1;  // metres
  const auto& n = message.numbers;
  const bool sound = n.size() >= 7 && std::all_of(n.begin(), n.begin() + 7, [](double number) {
                       return std::abs(number) < kMaxLength;
                     });
  if (!sound) return input_failure({}, fmt::format("{}: expected seven numbers", message.address));
  const Eigen::Quaterniond rotation(n[6], n[3], n[4], n[5]);
  if (rotation.norm() < kMinNorm) {
    return input_failure({}, fmt::format("{}: the rotation is zero", message.address));
  }
  return mirrored_across_x({rotation.normalized(), {n[0], n[1], n[2]}});
}

class VmcDecoder final : public Decoder {
 public:
  Result<void> take(std::string_view bytes, StreamSink& sink) override;
  void restart() override { *this = VmcDecoder(); }

 private:
  Result<void> take_message(const OscMessage& message, StreamSink& sink);
  void learn_skeleton(StreamSink& sink);
  void give_frame(StreamSink& sink);
  [[nodiscard]] bool is_whole() const { return std::ranges::equal(seen_, is_there_); }

  Pose root_;
  std::array<Pose, kUnityBoneCount> parent_from_bone_;
  std::array<bool, kUnityBoneCount> seen_{};      // Since the last frame.
  std::array<bool, kUnityBoneCount> is_there_{};  // In the skeleton.
  bool learned_ = false;
  double time_before_ = std::numeric_limits<double>::quiet_NaN();  // Time before this packet.
  int frames_ = 0;                                                 // In this packet.
  StreamFrame frame_;
};

Result<void> VmcDecoder::take(std::string_view bytes, StreamSink& sink) {
  RETARGET_TRY_ASSIGN(const auto messages, read_osc(bytes));
  const auto is_of_others = [](const OscMessage& message) {
    return !message.address.starts_with("/VMC/");
  };
  if (!messages.empty() && std::ranges::all_of(messages, is_of_others)) {
    return input_failure({}, fmt::format("expected messages such as /VMC/Ext/Bone/Pos, found {}",
                                         messages.front().address));
  }
  time_before_ = frame_.time;
  frames_ = 0;
  for (const OscMessage& message : messages) RETARGET_TRY(take_message(message, sink));
  // A complete frame does not wait for the next packet.
  if (learned_ && is_whole()) give_frame(sink);
  return {};
}

Result<void> VmcDecoder::take_message(const OscMessage& message, StreamSink& sink) {
  if (message.address == "/VMC/Ext/T" && !message.numbers.empty()) {
    if (std::isfinite(message.numbers[0])) frame_.time = message.numbers[0];
    return {};
  }
  if (message.address == "/VMC/Ext/Root/Pos") {
    RETARGET_TRY_ASSIGN(root_, mirrored_pose(message));
    return {};
  }
  if (message.address != "/VMC/Ext/Bone/Pos" || message.texts.empty()) return {};
  const std::size_t bone = unity_bone_index(message.texts[0]);
  if (bone == kUnityBoneCount) return {};
  RETARGET_TRY_ASSIGN(const Pose pose, mirrored_pose(message));
  if (seen_[bone]) {
    // A repeated bone starts the next frame.
    constexpr int kMostPerPacket = 8;
    if (++frames_ > kMostPerPacket) return input_failure({}, "too many frames in one packet");
    if (!learned_) learn_skeleton(sink);
    if (learned_) {
      // The timestamp in this packet belongs to the next frame.
      const double time = std::exchange(frame_.time, time_before_);
      give_frame(sink);
      frame_.time = time;
    }
    seen_.fill(false);
  }
  // A bone that the skeleton lacks belongs to another avatar.
  if (learned_ && !is_there_[bone]) learned_ = false;
  seen_[bone] = true;
  parent_from_bone_[bone] = pose;
  return {};
}

// Builds the skeleton from the first complete frame: each bone has its current offset from its
// parent and no rotation.
void VmcDecoder::learn_skeleton(StreamSink& sink) {
  if (!seen_[unity_bone_index("Hips")]) return;
  using enum Channel;
  const std::vector<Channel> turns = {kZRotation, kYRotation, kXRotation};
  std::vector<Joint> joints = {{"root", -1, Eigen::Vector3d::Zero(), {}, all_channels()}};
  std::map<std::string_view, int> index = {{"root", 0}};
  for (std::size_t bone = 0; bone < kUnityBoneCount; ++bone) {
    // Children of a missing bone attach to its parent.
    const int parent = index.at(kUnityBones[bone].parent);
    index[kUnityBones[bone].name] = seen_[bone] ? static_cast<int>(joints.size()) : parent;
    if (!seen_[bone]) continue;
    joints.push_back({std::string(kUnityBones[bone].name),
                      parent,
                      parent_from_bone_[bone].translation,
                      {},
                      bone == 0 ? all_channels() : turns});
  }
  is_there_ = seen_;
  learned_ = true;
  Clip clip(std::make_shared<const Skeleton>(std::move(joints)), FrameRate{}, 1);
  ClipOrigin origin;
  origin.name = "stream";
  origin.metres_per_unit = 1.0;
  origin.up = Eigen::Vector3d::UnitY();
  clip.set_origin(std::move(origin));
  sink.take_skeleton(std::move(clip), true);
}

void VmcDecoder::give_frame(StreamSink& sink) {
  frame_.rotations.assign(1, root_.rotation);
  for (std::size_t bone = 0; bone < kUnityBoneCount; ++bone) {
    if (is_there_[bone]) frame_.rotations.push_back(parent_from_bone_[bone].rotation);
  }
  frame_.translations.assign({root_.translation, parent_from_bone_[0].translation});
  seen_.fill(false);
  sink.take_frame(frame_);
}

// Encodes the canonical human as a VRM avatar whose performer uses VMC: one bundle per frame.

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

StreamFormat vmc_format() {
  return {.name = "vmc",
          .description =
              "VMC over OSC: bones of a VRM avatar, from Virtual Motion Capture, "
              "Waidayo, ...",
          .port = 39539,
          .is_text = false,
          .decoder = make_decoder<VmcDecoder>,
          .encoder = make_encoder<VmcEncoder>,
          .plays_human = [](const Clip&) { return true; },
          .needs_packets = true};
}

}  // namespace retarget
