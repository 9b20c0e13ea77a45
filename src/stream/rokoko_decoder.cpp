// Rokoko Studio's live data as JSON, version 3 (and 2, which differs in where actors and time are), plain or in
// frames of LZ4: poses of named bones in the world. Unity's axes, left-handed, y up, metres; a T-pose that
// faces z turns bones as rokoko_bones.h has them.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/json.h"
#include "base/suggest.h"
#include "base/try.h"
#include "stream/formats.h"
#include "stream/human_bones.h"
#include "stream/json_cutter.h"
#include "stream/local_pose.h"
#include "stream/rokoko_bones.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kRokokoPacket = "the packet";

Failure bad_packet(std::string message) {
  return input_failure({}, std::move(message));
}

// null where it is no object or has no such member
const Json& member(const Json& json, const char* name) {
  static const Json none;
  if (!json.is_object()) return none;
  const auto found = json.find(name);
  return found == json.end() ? none : *found;
}

std::optional<double> number_of(const Json& json, double limit) {
  if (!json.is_number()) return std::nullopt;
  const double number = json.get<double>();
  return std::abs(number) <= limit ? std::optional(number) : std::nullopt;
}

// of a bone in the world; right-handed, y up, and from the T-pose: with z ahead
Result<Pose> world_from_joint(const RokokoBone& bone, const Json& json) {
  constexpr double kMaxLength = 1e4, kMinNorm = 0.1;  // metres
  constexpr std::array kAxes = {"x", "y", "z", "w"};
  std::array<double, 3> at{};
  std::array<double, 4> turn{};
  bool sound = true;
  const auto read = [&](const Json& from, auto& numbers) {
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
    return bad_packet(fmt::format("\"{}\": a rotation of zeros", bone.name));
  }
  return mirrored_across_x(
      {unity.normalized() * rokoko_t_pose_of(bone).conjugate(), {at[0], at[1], at[2]}});
}

// Metres; senders of old wrote centimetres.
std::optional<double> height_of(const Json& dimensions) {
  constexpr double kMin = 0.5, kMax = 2.6, kCentimetres = 100.0;
  const auto height = number_of(member(dimensions, "totalHeight"), kMax * kCentimetres);
  if (!height) return std::nullopt;
  if (*height >= kMin && *height <= kMax) return height;
  if (*height >= kMin * kCentimetres) return *height / kCentimetres;
  return std::nullopt;
}

struct RokokoActor {
  std::string name;
  const Json* body = nullptr;
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
  [[nodiscard]] Result<RokokoActor> find_actor(const Json& actors) const;
  Result<void> learn_skeleton(const RokokoActor& actor, StreamSink& sink);
  Result<void> read_bones(const Json& body);
  void give_frame(double time, StreamSink& sink);

  std::string wanted_;  // by the user; empty: whoever comes first
  bool datagrams_;
  JsonCutter cutter_;

  std::optional<std::string> actor_;  // of the skeleton; nothing: none was told
  std::vector<std::size_t> bones_;    // of the skeleton, by joint
  std::vector<int> parents_;          // of its joints
  std::vector<Pose> world_from_joint_;
  StreamFrame frame_;
};

void RokokoDecoder::restart() {
  cutter_.clear();
  actor_.reset();
}

Result<void> RokokoDecoder::take(std::string_view bytes, StreamSink& sink) {
  Result<void> first;  // of several faults
  const auto keep = [&first](Result<void> taken) {
    if (first && !taken) first = std::move(taken);
  };
  while (!bytes.empty()) {
    auto text = cutter_.next(bytes);
    if (!text) {
      keep(failure(std::move(text.error())));
    } else if (*text) {
      keep(take_text(**text, sink));
    }
  }
  if (datagrams_ && cutter_.is_inside()) {
    cutter_.clear();
    keep(bad_packet("a packet that ends too early"));
  }
  return first;
}

Result<void> RokokoDecoder::take_text(std::string_view text, StreamSink& sink) {
  constexpr double kMaxTime = 1e12;  // seconds
  TRY_ASSIGN(const Json json, parse_json(text, kRokokoPacket));
  const Json& scene = member(json, "scene").is_object() ? json["scene"] : json;
  TRY_ASSIGN(const RokokoActor actor, find_actor(member(scene, "actors")));
  if (actor_ != actor.name) {
    TRY(learn_skeleton(actor, sink));
  } else {
    TRY(read_bones(*actor.body));
  }
  give_frame(number_of(member(scene, "timestamp"), kMaxTime)
                 .value_or(std::numeric_limits<double>::quiet_NaN()),
             sink);
  return {};
}

// The one who was asked for; else the one that the skeleton is of, and as long as there is none the first
// one with a body: others have gloves or a face alone.
Result<RokokoActor> RokokoDecoder::find_actor(const Json& actors) const {
  if (!actors.is_array()) return bad_packet("expected \"actors\", in a \"scene\" or without one");
  std::optional<RokokoActor> found;
  std::vector<std::string> names;
  for (const Json& json : actors) {
    const Json& name = member(json, "name").is_string() ? member(json, "name") : member(json, "id");
    names.push_back(name.is_string() ? name.get<std::string>() : std::string());
    // an actor of version 2 has its bones itself
    const Json& body = member(json, "body").is_object() ? member(json, "body") : json;
    if (!member(body, "hip").is_object() || member(member(json, "meta"), "hasBody") == false) {
      continue;
    }
    const RokokoActor actor = {names.back(), &body, height_of(member(json, "dimensions"))};
    if (wanted_.empty() ? actor_ == actor.name : wanted_ == actor.name) return actor;
    if (!found) found = actor;
  }
  if (found && wanted_.empty()) return *found;
  if (wanted_.empty()) return bad_packet("none of the actors has a body");
  return bad_packet(names.empty() ? fmt::format("no actor \"{}\": there is none", wanted_)
                                  : fmt::format("no actor \"{}\" with a body, but {}", wanted_,
                                                list_names(names)));
}

Result<void> RokokoDecoder::read_bones(const Json& body) {
  for (std::size_t i = 0; i < bones_.size(); ++i) {
    const RokokoBone& bone = kRokokoBones[bones_[i]];
    const Json& json = member(body, bone.name.data());
    if (json.is_null()) return bad_packet(fmt::format("\"{}\" is missing", bone.name));
    TRY_ASSIGN(world_from_joint_[i], world_from_joint(bone, json));
  }
  return {};
}

// The bones of a frame, each where it is in its parent then; without turns.
Result<void> RokokoDecoder::learn_skeleton(const RokokoActor& actor, StreamSink& sink) {
  using enum Channel;
  actor_.reset();
  bones_.clear();
  parents_.clear();
  std::array<int, kRokokoBoneCount> joint_of_bone{};
  for (std::size_t i = 0; i < kRokokoBoneCount; ++i) {
    const RokokoBone& bone = kRokokoBones[i];
    // what a body lacks hands its parent on
    const int parent = bone.parent < 0 ? -1 : joint_of_bone[static_cast<std::size_t>(bone.parent)];
    joint_of_bone[i] = parent;
    if (!bone.is_needed && member(*actor.body, bone.name.data()).is_null()) continue;
    joint_of_bone[i] = static_cast<int>(bones_.size());
    bones_.push_back(i);
    parents_.push_back(parent);
  }
  world_from_joint_.assign(bones_.size(), Pose{});
  TRY(read_bones(*actor.body));
  std::vector<Joint> joints;
  for (std::size_t i = 0; i < bones_.size(); ++i) {
    const Pose local = parent_from_joint(world_from_joint_, parents_[i], world_from_joint_[i]);
    Joint joint;
    joint.name = kRokokoBones[bones_[i]].name;
    joint.parent = parents_[i];
    joint.offset = local.translation;
    joint.channels = {kXPosition, kYPosition, kZPosition, kZRotation, kYRotation, kXRotation};
    joints.push_back(std::move(joint));
  }
  Clip clip(std::make_shared<const Skeleton>(std::move(joints)), FrameRate{}, 1);
  ClipOrigin origin;
  origin.name = "stream";
  origin.metres_per_unit = 1.0;
  origin.up = Eigen::Vector3d::UnitY();
  origin.body_height = actor.height;
  clip.set_origin(std::move(origin));
  actor_ = actor.name;
  sink.take_skeleton(std::move(clip), true);
  return {};
}

void RokokoDecoder::give_frame(double time, StreamSink& sink) {
  frame_.time = time;
  frame_.rotations.clear();
  frame_.translations.clear();
  for (std::size_t i = 0; i < bones_.size(); ++i) {
    const Pose local = parent_from_joint(world_from_joint_, parents_[i], world_from_joint_[i]);
    frame_.rotations.push_back(local.rotation.normalized());
    frame_.translations.push_back(local.translation);
  }
  sink.take_frame(frame_);
}

}  // namespace

std::unique_ptr<Decoder> make_rokoko_decoder(const StreamAddress& from) {
  return std::make_unique<RokokoDecoder>(from.extra("actor"), from.transport == Transport::kUdp);
}

}  // namespace retarget
