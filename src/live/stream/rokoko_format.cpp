// Decodes Rokoko Studio's live data: JSON version 3 (and 2, which has actors and time in other
// members), plain or in LZ4 frames. It contains world poses of named bones in Unity's axes:
// left-handed, Y up, metres. kRokokoBones has the bone rotations in a T-pose that faces z.

#include <fmt/format.h>
#include <Eigen/Geometry>
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

/// A bone of Rokoko Studio's streams, with its name in JSON.
struct RokokoBone {
  std::string_view name;
  int parent;      ///< Index into kRokokoBones; -1: none.
  Bone bone;       ///< Canonical bone; for toe ends, the toe.
  bool is_needed;  ///< A body must have it.
  bool is_end;     ///< An end without a bone of its own.
  /// Rotation in a T-pose that faces z, in Unity's left-handed world: x y z w. All bones extend
  /// along their -y axis.
  std::array<double, 4> unity_t_pose;
};

constexpr double kRokokoHalfTurn = 0.70710678118654752;  // sin(pi / 4)

// Names, T-pose and world follow Rokoko's own plugins (rokoko-studio-live-unity's
// JsonLiveSerializerV3 and Actor, rokoko-studio-live-blender's animation_lists). In that T-pose the
// left arm points to -x and the toes to z, so the world is left-handed.
namespace rokoko_t_pose {
constexpr double kS = kRokokoHalfTurn;
constexpr std::array<double, 4> kHip = {0, 0, 0, 1}, kTrunk = {0, 0, 1, 0},
                                kLeftShoulder = {0, 0, kS, -kS}, kRightShoulder = {0, 0, kS, kS},
                                kLeftArm = {-0.5, -0.5, 0.5, -0.5},
                                kRightArm = {0.5, -0.5, 0.5, 0.5}, kLeftLeg = {0, kS, 0, kS},
                                kRightLeg = {0, -kS, 0, kS}, kLeftFoot = {0, kS, -kS, 0},
                                kRightFoot = {0, -kS, kS, 0};
}  // namespace rokoko_t_pose

/// Parents precede children; fingers are omitted because they move no robot.
constexpr auto kRokokoBones = std::to_array<RokokoBone>({
    {"hip", -1, Bone::kHips, true, false, rokoko_t_pose::kHip},
    {"spine", 0, Bone::kSpine, true, false, rokoko_t_pose::kTrunk},
    {"chest", 1, Bone::kSpine2, true, false, rokoko_t_pose::kTrunk},
    {"neck", 2, Bone::kNeck, false, false, rokoko_t_pose::kTrunk},
    {"head", 3, Bone::kHead, false, false, rokoko_t_pose::kTrunk},
    {"leftShoulder", 2, Bone::kLeftShoulder, false, false, rokoko_t_pose::kLeftShoulder},
    {"leftUpperArm", 5, Bone::kLeftArm, true, false, rokoko_t_pose::kLeftArm},
    {"leftLowerArm", 6, Bone::kLeftForeArm, true, false, rokoko_t_pose::kLeftArm},
    {"leftHand", 7, Bone::kLeftHand, true, false, rokoko_t_pose::kLeftArm},
    {"rightShoulder", 2, Bone::kRightShoulder, false, false, rokoko_t_pose::kRightShoulder},
    {"rightUpperArm", 9, Bone::kRightArm, true, false, rokoko_t_pose::kRightArm},
    {"rightLowerArm", 10, Bone::kRightForeArm, true, false, rokoko_t_pose::kRightArm},
    {"rightHand", 11, Bone::kRightHand, true, false, rokoko_t_pose::kRightArm},
    {"leftUpLeg", 0, Bone::kLeftUpLeg, true, false, rokoko_t_pose::kLeftLeg},
    {"leftLeg", 13, Bone::kLeftLeg, true, false, rokoko_t_pose::kLeftLeg},
    {"leftFoot", 14, Bone::kLeftFoot, true, false, rokoko_t_pose::kLeftFoot},
    {"leftToe", 15, Bone::kLeftToe, false, false, rokoko_t_pose::kLeftFoot},
    {"leftToeEnd", 16, Bone::kLeftToe, false, true, rokoko_t_pose::kLeftFoot},
    {"rightUpLeg", 0, Bone::kRightUpLeg, true, false, rokoko_t_pose::kRightLeg},
    {"rightLeg", 18, Bone::kRightLeg, true, false, rokoko_t_pose::kRightLeg},
    {"rightFoot", 19, Bone::kRightFoot, true, false, rokoko_t_pose::kRightFoot},
    {"rightToe", 20, Bone::kRightToe, false, false, rokoko_t_pose::kRightFoot},
    {"rightToeEnd", 21, Bone::kRightToe, false, true, rokoko_t_pose::kRightFoot},
});
constexpr std::size_t kRokokoBoneCount = kRokokoBones.size();

/// The T-pose rotation in Unity's coordinates.
[[nodiscard]] inline Eigen::Quaterniond rokoko_t_pose_of(const RokokoBone& bone) {
  const auto& [x, y, z, w] = bone.unity_t_pose;
  return {w, x, y, z};
}

constexpr const char* kRokokoPacket = "the packet";
// Maximum unpacked size of a datagram and of one read of a connection (64 KiB, possibly
// compressed).
constexpr std::size_t kMostOfDatagram = std::size_t{1} << 19, kMostOfPiece = std::size_t{1} << 21;
constexpr int kMostObjects = 64;
constexpr std::size_t kMostActors = 64;

// Returns null if the value is not an object or has no such member.
const PacketJson& member(const PacketJson& json, const char* name) {
  static const PacketJson none;
  if (!json.is_object()) return none;
  const auto found = json.find(name);
  return found == json.end() ? none : *found;
}

std::optional<double> number_of(const PacketJson& json, double limit) {
  if (!json.is_number()) return std::nullopt;
  const double number = json.get<double>();
  return std::abs(number) <= limit ? std::optional(number) : std::nullopt;
}

// World pose of a bone; right-handed, Y up, rotation relative to the T-pose that faces z.
Result<Pose> world_from_joint(const RokokoBone& bone, const PacketJson& json) {
  constexpr double kMaxLength = 1e4, kMinNorm = 0.1;  // metres
  constexpr std::array kAxes = {"x", "y", "z", "w"};
  std::array<double, 3> at{};
  std::array<double, 4> turn{};
  bool sound = true;
  const auto read = [&](const PacketJson& from, auto& numbers) {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const auto number = number_of(member(from, kAxes[i]), kMaxLength);
      sound = sound && number;
      numbers[i] = number.value_or(0.0);
    }
  };
  read(member(json, "position"), at);
  read(member(json, "rotation"), turn);
  if (!sound) {
    return bad_packet(fmt::format(
        "\"{}\": expected a position of x, y, z and a rotation of x, y, z, w", bone.name));
  }
  const Eigen::Quaterniond unity(turn[3], turn[0], turn[1], turn[2]);
  if (unity.norm() < kMinNorm) {
    return bad_packet(fmt::format("\"{}\": the rotation is zero", bone.name));
  }
  return mirrored_across_x(
      {unity.normalized() * rokoko_t_pose_of(bone).conjugate(), {at[0], at[1], at[2]}});
}

// Returns metres; old senders use centimetres.
std::optional<double> height_of(const PacketJson& dimensions) {
  constexpr double kMin = 0.5, kMax = 2.6, kCentimetres = 100.0;
  const auto height = number_of(member(dimensions, "totalHeight"), kMax * kCentimetres);
  if (!height) return std::nullopt;
  if (*height >= kMin && *height <= kMax) return height;
  if (*height >= kMin * kCentimetres) return *height / kCentimetres;
  return std::nullopt;
}

struct RokokoActor {
  std::string name;
  const PacketJson* body = nullptr;
  std::optional<double> height;
};

class RokokoDecoder final : public Decoder {
 public:
  RokokoDecoder(std::string actor, bool datagrams)
      : wanted_(std::move(actor)), datagrams_(datagrams) {}
  Result<void> take(std::string_view bytes, StreamSink& sink) override;
  void restart() override;

 private:
  Result<void> take_text(std::string_view text, StreamSink& sink);
  [[nodiscard]] Result<RokokoActor> find_actor(const PacketJson& actors);
  Result<void> learn_skeleton(const RokokoActor& actor, StreamSink& sink);
  Result<void> read_bones(const PacketJson& body);

  std::string wanted_;  // Actor selected by the user; empty: the first one.
  bool datagrams_;
  JsonCutter cutter_;

  std::optional<std::string> actor_;  // Actor of the skeleton; nothing: no skeleton yet.
  int missed_ = 0;                    // Consecutive packets without this actor.
  std::vector<std::size_t> bones_;    // Bones of the skeleton, by joint.
  std::vector<Pose> world_from_joint_;
  StreamSkeleton skeleton_;
};

void RokokoDecoder::restart() {
  cutter_.clear();
  actor_.reset();
  missed_ = 0;
}

Result<void> RokokoDecoder::take(std::string_view bytes, StreamSink& sink) {
  Result<void> first;  // First of several errors.
  const auto keep = [&first](Result<void> taken) {
    if (first && !taken) first = std::move(taken);
  };
  cutter_.begin_packet(datagrams_ ? kMostOfDatagram : kMostOfPiece);
  for (int objects = 0; !bytes.empty(); ++objects) {
    if (objects == kMostObjects) {
      cutter_.clear();
      return bad_packet(fmt::format("more than {} objects in one packet", kMostObjects));
    }
    auto text = cutter_.next(bytes);
    if (!text) {
      keep(failure(std::move(text.error())));
    } else if (*text) {
      keep(take_text(**text, sink));
    }
  }
  if (datagrams_ && cutter_.is_inside()) {
    cutter_.clear();
    keep(bad_packet("truncated packet"));
  }
  return first;
}

Result<void> RokokoDecoder::take_text(std::string_view text, StreamSink& sink) {
  constexpr double kMaxTime = 1e12;  // seconds
  RETARGET_TRY_ASSIGN(const PacketJson json, parse_packet_json(text, kRokokoPacket));
  const PacketJson& scene = member(json, "scene").is_object() ? json["scene"] : json;
  RETARGET_TRY_ASSIGN(const RokokoActor actor, find_actor(member(scene, "actors")));
  if (actor_ != actor.name) {
    RETARGET_TRY(learn_skeleton(actor, sink));
  } else {
    RETARGET_TRY(read_bones(*actor.body));
  }
  skeleton_.give(number_of(member(scene, "timestamp"), kMaxTime)
                     .value_or(std::numeric_limits<double>::quiet_NaN()),
                 world_from_joint_, sink);
  return {};
}

// Selects the requested actor; otherwise the actor of the current skeleton; otherwise the first one
// with a body, since others may have only gloves or a face. Rejects packets without the actor of the
// current skeleton before it follows another one, because Studio loses people for moments, and the
// robot would run to another person.
Result<RokokoActor> RokokoDecoder::find_actor(const PacketJson& actors) {
  constexpr int kPatience = 100;  // Packets: one second at Studio's usual rate.
  if (!actors.is_array() || actors.size() > kMostActors)
    return bad_packet("expected \"actors\", in a \"scene\" or without one");
  std::optional<RokokoActor> found;
  std::vector<std::string> names;
  for (const PacketJson& json : actors) {
    const PacketJson& name =
        member(json, "name").is_string() ? member(json, "name") : member(json, "id");
    names.push_back(name.is_string() ? name.get<std::string>() : std::string());
    // In version 2 the actor contains its bones directly.
    const PacketJson& body = member(json, "body").is_object() ? member(json, "body") : json;
    if (!member(body, "hip").is_object() || member(member(json, "meta"), "hasBody") == false) {
      continue;
    }
    const RokokoActor actor = {names.back(), &body, height_of(member(json, "dimensions"))};
    if (wanted_.empty() ? actor_ == actor.name : wanted_ == actor.name) {
      missed_ = 0;
      return actor;
    }
    if (!found) found = actor;
  }
  if (actor_) missed_ = std::min(missed_ + 1, kPatience + 1);
  if (found && wanted_.empty() && actor_ && missed_ <= kPatience) {
    return bad_packet(fmt::format("no actor \"{}\", whom the robot follows; found {}", *actor_,
                                  list_names(names)));
  }
  if (found && wanted_.empty()) {
    missed_ = 0;
    return *found;
  }
  if (wanted_.empty()) return bad_packet("no actor has a body");
  return bad_packet(names.empty() ? fmt::format("no actor \"{}\": there are no actors", wanted_)
                                  : fmt::format("no actor \"{}\" with a body; found {}", wanted_,
                                                list_names(names)));
}

Result<void> RokokoDecoder::read_bones(const PacketJson& body) {
  for (std::size_t i = 0; i < bones_.size(); ++i) {
    const RokokoBone& bone = kRokokoBones[bones_[i]];
    const PacketJson& json = member(body, bone.name.data());
    if (json.is_null()) return bad_packet(fmt::format("\"{}\" is missing", bone.name));
    RETARGET_TRY_ASSIGN(world_from_joint_[i], world_from_joint(bone, json));
  }
  return {};
}

// Builds the skeleton from one frame: each bone has its current offset from its parent and no
// rotation.
Result<void> RokokoDecoder::learn_skeleton(const RokokoActor& actor, StreamSink& sink) {
  actor_.reset();
  bones_.clear();
  std::vector<StreamJoint> joints;
  std::array<int, kRokokoBoneCount> joint_of_bone{};
  for (std::size_t i = 0; i < kRokokoBoneCount; ++i) {
    const RokokoBone& bone = kRokokoBones[i];
    // Children of a missing bone attach to its parent.
    const int parent = bone.parent < 0 ? -1 : joint_of_bone[static_cast<std::size_t>(bone.parent)];
    joint_of_bone[i] = parent;
    if (!bone.is_needed && member(*actor.body, bone.name.data()).is_null()) continue;
    joint_of_bone[i] = static_cast<int>(bones_.size());
    bones_.push_back(i);
    joints.push_back({std::string(bone.name), parent, Eigen::Vector3d::Zero()});
  }
  world_from_joint_.assign(bones_.size(), Pose{});
  RETARGET_TRY(read_bones(*actor.body));
  for (std::size_t i = 0; i < joints.size(); ++i) {
    joints[i].offset =
        parent_from_joint(world_from_joint_, joints[i].parent, world_from_joint_[i]).translation;
  }
  actor_ = actor.name;
  skeleton_.set_joints(std::move(joints), Eigen::Vector3d::UnitY(), true, sink, actor.height);
  return {};
}

// Encodes the canonical human as an actor of Rokoko Studio: JSON, version 3, one object and a line
// end per frame.

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
  const std::vector<Pose> world_from_bone = bones_.poses_of(kRokokoBones);
  for (std::size_t i = 0; i < kRokokoBoneCount; ++i) {
    const RokokoBone& bone = kRokokoBones[i];
    if (!bone.is_end) body[std::string(bone.name)] = bone_of(bone, world_from_bone[i]);
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

StreamFormat rokoko_format() {
  static constexpr std::array kExtras = {
      StreamExtra{"actor", "NAME", [](const std::string&) { return true; }}};
  return {.name = "rokoko",
          .description = "Rokoko Studio's custom streaming, JSON v3; ?actor=NAME selects an actor",
          .port = 14043,
          .is_text = false,
          .decoder = [](const StreamAddress& from) -> std::unique_ptr<Decoder> {
            return std::make_unique<RokokoDecoder>(from.extra("actor"),
                                                   from.transport == Transport::kUdp);
          },
          .encoder = make_encoder<RokokoEncoder>,
          .plays_human = [](const Clip&) { return true; },
          .extras = kExtras};
}

}  // namespace retarget
