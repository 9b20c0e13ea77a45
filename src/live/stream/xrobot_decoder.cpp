// Decodes the body tracking of PICO headsets as JSON, one object per line: 24 poses in the order of
// OpenXR's XR_BD_body_tracking, as sent by XRoboToolkit's client (TrackingData.cs, "Body") and
// returned by its Python binding (get_body_joints_pose). Right-handed, Y up, metres. In a T-pose
// that faces -z all joint rotations are the identity.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "live/stream/human_bones.h"
#include "live/stream/packet_json.h"
#include "live/stream/stream_formats.h"
#include "live/stream/stream_skeleton.h"
#include "live/stream/xrobot_joints.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

constexpr const char* kXrobotLine = "the line";

using PoseNumbers = std::array<double, 7>;  // x y z, x y z w

Failure bad_xrobot_line(std::string message) {
  return input_failure({}, std::move(message));
}

const PacketJson* xrobot_member(const PacketJson& json, const char* name) {
  const auto found = json.find(name);
  return found == json.end() || found->is_null() ? nullptr : &*found;
}

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
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const auto number = parse_number<double>(text.substr(0, comma));
    // Numbers are separated by commas; the last one ends the text.
    if (!number || (comma == text.size()) != (i + 1 == numbers.size())) return std::nullopt;
    numbers[i] = *number;
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return numbers;
}

// Reads [x, y, z, x, y, z, w], or {"p": "x,y,z,x,y,z,w"}; ignores velocities.
Result<Pose> world_from_xrobot_joint(const PacketJson& json, std::string_view joint) {
  constexpr double kMaxLength = 1e4, kMinNorm = 0.1;  // metres
  std::optional<PoseNumbers> found;
  if (json.is_array()) {
    found = numbers_of_list(json);
  } else if (json.is_object()) {
    const PacketJson* pose = xrobot_member(json, "p");
    if (pose != nullptr && pose->is_string()) found = numbers_of_text(pose->get<std::string>());
  }
  // Negated, so that NaN fails.
  if (!found || !std::ranges::all_of(*found, [](double n) { return std::abs(n) < kMaxLength; })) {
    return bad_xrobot_line(
        fmt::format("{}: expected seven numbers, position x y z and rotation x y z w", joint));
  }
  const auto& [x, y, z, qx, qy, qz, qw] = *found;
  const Eigen::Quaterniond rotation(qw, qx, qy, qz);
  if (rotation.norm() < kMinNorm) {
    return bad_xrobot_line(fmt::format("{} is not tracked: its rotation is zero", joint));
  }
  return Pose{rotation.normalized(), {x, y, z}};
}

// Returns seconds; NaN: none.
double xrobot_time(const PacketJson& line, const PacketJson& body) {
  constexpr double kMaxTime = 1e12, kNanoseconds = 1e-9;
  const auto number = [](const PacketJson& json, const char* name) {
    const PacketJson* found = xrobot_member(json, name);
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
  void restart() override { is_told_ = false; }

 private:
  Result<void> take_object(const PacketJson& line, StreamSink& sink);
  Result<void> learn_skeleton(StreamSink& sink);

  bool is_told_ = false;
  std::array<Pose, kXrobotJointCount> world_from_joint_;
  StreamSkeleton skeleton_;
};

Result<void> XrobotDecoder::take(std::string_view bytes, StreamSink& sink) {
  RETARGET_TRY_ASSIGN(const PacketJson line, parse_packet_json(bytes, kXrobotLine));
  if (!line.is_object()) return bad_xrobot_line("expected a JSON object per line");
  // The service wraps the client's object in a string.
  const PacketJson* value = xrobot_member(line, "value");
  if (value == nullptr || !value->is_string()) return take_object(line, sink);
  RETARGET_TRY_ASSIGN(const PacketJson inner,
                      parse_packet_json(value->get<std::string>(), "\"value\""));
  if (!inner.is_object()) return bad_xrobot_line("\"value\" must be a JSON object");
  return take_object(inner, sink);
}

Result<void> XrobotDecoder::take_object(const PacketJson& line, StreamSink& sink) {
  const PacketJson* inner = xrobot_member(line, "Body");
  const PacketJson& body = inner != nullptr && inner->is_object() ? *inner : line;
  const PacketJson* joints = xrobot_member(body, "joints");
  if (joints == nullptr || !joints->is_array() || joints->size() != kXrobotJointCount) {
    return bad_xrobot_line(
        fmt::format("expected \"joints\", a list of {} poses, or a \"Body\" with it; is full body "
                    "tracking enabled?",
                    kXrobotJointCount));
  }
  for (std::size_t i = 0; i < kXrobotJointCount; ++i) {
    RETARGET_TRY_ASSIGN(world_from_joint_[i],
                        world_from_xrobot_joint((*joints)[i], kXrobotJoints[i].name));
  }
  if (!is_told_) RETARGET_TRY(learn_skeleton(sink));
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
    return bad_xrobot_line(fmt::format("the body is not tracked yet: {} and {} are {:.2f} m apart",
                                       joints[static_cast<std::size_t>(joints[i].parent)].name,
                                       joints[i].name, joints[i].offset.norm()));
  }
  is_told_ = true;
  skeleton_.tell(std::move(joints), Eigen::Vector3d::UnitY(), true, sink);
  return {};
}

}  // namespace

std::unique_ptr<Decoder> make_xrobot_decoder(const StreamAddress&) {
  return std::make_unique<XrobotDecoder>();
}

}  // namespace retarget
