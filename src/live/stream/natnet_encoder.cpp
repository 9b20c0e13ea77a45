// Builds the messages that a NatNet server sends.

#include <bit>
#include <string>
#include <vector>

#include "live/stream/human_bones.h"
#include "live/stream/natnet_protocol.h"
#include "live/stream/stream_formats.h"
#include "retarget/bytes.h"
#include "retarget/clip.h"

namespace retarget {
namespace {

void append_natnet_float(std::string& bytes, double value) {
  append_little_endian(bytes, static_cast<float>(value));
}

void append_natnet_vector(std::string& bytes, const Eigen::Vector3d& vector) {
  for (const double value : vector) append_natnet_float(bytes, value);
}

void append_text(std::string& bytes, const std::string& text) {
  bytes.append(text.c_str(), text.size() + 1);
}

void append_section(std::string& bytes, NatNetVersion version, std::size_t count,
                    const std::string& items) {
  append_little_endian(bytes, count, 4);
  if (version >= kNatNetSizedSections) append_little_endian(bytes, items.size(), 4);
  bytes += items;
}

// Encodes a clip as the skeleton of a NatNet server, version 4.1: each joint is a bone, metres, Y
// up, world poses. Answers the requests of receivers.

constexpr NatNetVersion kPlayedVersion = {4, 1};

class NatNetEncoder final : public Encoder {
 public:
  std::string begin(const Clip& clip) override;
  Result<std::string> frame(const Clip& clip, int frame) override;
  std::string answer(std::string_view request) override;
  [[nodiscard]] std::size_t packet_size(std::string_view bytes) const override;

 private:
  ClipAxes axes_;
  std::string server_, models_;  // Messages that describe the server and the models.
  std::vector<Pose> world_from_joint_;
  NatNetFrame frame_;
};

std::string NatNetEncoder::begin(const Clip& clip) {
  axes_ = ClipAxes(clip, Eigen::Vector3d::UnitY());
  NatNetSkeleton skeleton{"player", 1, {}};
  frame_ = {};
  frame_.skeleton = skeleton.id;
  for (const Joint& joint : clip.skeleton().joints()) {
    const int id = static_cast<int>(skeleton.bones.size()) + 1;
    skeleton.bones.push_back({joint.name, id, joint.parent + 1, axes_.metric(joint.offset)});
    frame_.bones.push_back({id, {}, true});
  }
  world_from_joint_.resize(frame_.bones.size());
  constexpr int kDataPort = 1511;
  server_ =
      natnet_message(NatNetMessage::kServerInfo, natnet_server_payload(kPlayedVersion, kDataPort));
  models_ =
      natnet_message(NatNetMessage::kModels, natnet_skeleton_payload(skeleton, kPlayedVersion));
  return server_ + models_;
}

Result<std::string> NatNetEncoder::frame(const Clip& clip, int frame) {
  forward_kinematics(clip, frame, world_from_joint_);
  frame_.number = static_cast<std::uint32_t>(frame);
  frame_.time = clip.rate().time_of(frame);
  for (std::size_t i = 0; i < world_from_joint_.size(); ++i) {
    frame_.bones[i].pose = axes_.metric(world_from_joint_[i]);
  }
  const std::string payload = natnet_frame_payload(frame_, kPlayedVersion);
  constexpr std::size_t kMaxPayload = 65000;  // Bytes in a datagram.
  if (payload.size() > kMaxPayload) {
    return input_failure(clip.name(), "the skeleton has too many joints for a NatNet datagram");
  }
  return natnet_message(NatNetMessage::kFrame, payload);
}

std::string NatNetEncoder::answer(std::string_view request) {
  const auto type = natnet_message_type(request);
  if (!type) return {};
  switch (*type) {
    case NatNetMessage::kConnect:
      return server_;
    case NatNetMessage::kModelsRequest:
      return models_;
    case NatNetMessage::kCommand:
      // The only command that clients need to interpret the stream.
      if (request.substr(kNatNetHeaderSize).starts_with("Bitstream")) {
        return natnet_message(NatNetMessage::kResponse, "Bitstream,4.1");
      }
      return natnet_message(NatNetMessage::kUnrecognised, {});
    default:
      return {};
  }
}

std::size_t NatNetEncoder::packet_size(std::string_view bytes) const {
  return natnet_message_size(bytes).value_or(bytes.size());
}

}  // namespace

std::string natnet_message(NatNetMessage type, std::string_view payload) {
  std::string bytes;
  append_little_endian(bytes, static_cast<std::uint16_t>(type), 2);
  append_little_endian(bytes, payload.size(), 2);
  return bytes.append(payload);
}

std::optional<NatNetMessage> natnet_message_type(std::string_view bytes) {
  if (bytes.size() < kNatNetHeaderSize) return std::nullopt;
  const auto type = ByteReader<std::endian::little>(bytes).number<std::uint16_t>();
  const auto last = static_cast<std::uint16_t>(NatNetMessage::kKeepAlive);
  const auto unrecognised = static_cast<std::uint16_t>(NatNetMessage::kUnrecognised);
  if (type > last && type != unrecognised) return std::nullopt;
  return static_cast<NatNetMessage>(type);
}

std::optional<std::size_t> natnet_message_size(std::string_view header) {
  if (!natnet_message_type(header)) return std::nullopt;
  return kNatNetHeaderSize +
         ByteReader<std::endian::little>(header.substr(2)).number<std::uint16_t>();
}

std::string natnet_server_payload(NatNetVersion version, int data_port) {
  std::string bytes = "retarget";
  bytes.resize(kNatNetServerName, '\0');
  // Version of the program, then of the stream.
  for (const int number : {1, 0, 0, 0, version.major, version.minor, 0, 0}) {
    append_little_endian(bytes, static_cast<std::uint64_t>(number), 1);
  }
  append_little_endian(bytes, 1000000, 8);  // Clock ticks per second.
  append_little_endian(bytes, static_cast<std::uint64_t>(data_port), 2);
  append_little_endian(bytes, 0, 5);  // No multicast, no group address.
  return bytes;
}

std::string natnet_skeleton_payload(const NatNetSkeleton& skeleton, NatNetVersion version) {
  std::string item;
  append_text(item, skeleton.name);
  append_little_endian(item, static_cast<std::uint32_t>(skeleton.id), 4);
  append_little_endian(item, skeleton.bones.size(), 4);
  for (const NatNetBone& bone : skeleton.bones) {
    append_text(item, bone.name);
    append_little_endian(item, static_cast<std::uint32_t>(bone.id), 4);
    append_little_endian(item, static_cast<std::uint32_t>(bone.parent), 4);
    append_natnet_vector(item, bone.offset);
    if (version >= kNatNetBoneRotations) {
      for (const double value : {0.0, 0.0, 0.0, 1.0}) append_natnet_float(item, value);
    }
    append_little_endian(item, 0, 4);  // Number of markers.
  }
  std::string bytes;
  append_little_endian(bytes, 1, 4);
  append_little_endian(bytes, kNatNetSkeletonType, 4);
  if (version >= kNatNetSizedSections) append_little_endian(bytes, item.size(), 4);
  return bytes + item;
}

std::string natnet_frame_payload(const NatNetFrame& frame, NatNetVersion version) {
  const auto id = static_cast<std::uint32_t>(frame.skeleton.value_or(0));
  std::string skeleton;
  append_little_endian(skeleton, id, 4);
  append_little_endian(skeleton, frame.bones.size(), 4);
  for (const NatNetBonePose& bone : frame.bones) {
    append_little_endian(skeleton, id << 16U | static_cast<std::uint32_t>(bone.id), 4);
    append_natnet_vector(skeleton, bone.pose.translation);
    append_natnet_vector(skeleton, bone.pose.rotation.vec());
    append_natnet_float(skeleton, bone.pose.rotation.w());
    append_natnet_float(skeleton, 0.0);
    append_little_endian(skeleton, bone.is_tracked ? 1 : 0, 2);
  }
  std::string bytes;
  append_little_endian(bytes, frame.number, 4);
  for (int i = 0; i < 3; ++i) append_section(bytes, version, 0, {});
  append_section(bytes, version, 1, skeleton);
  // Empty sections: labelled markers, force plates, devices, and, since 4.1, assets before them.
  for (int i = version >= kNatNetSizedSections ? 0 : 1; i < 4; ++i)
    append_section(bytes, version, 0, {});
  append_little_endian(bytes, 0, 8);  // Time code.
  append_little_endian(bytes, std::bit_cast<std::uint64_t>(frame.time), 8);
  append_little_endian(bytes, 0, 8);
  append_little_endian(bytes, 0, 8);
  append_little_endian(bytes, 0, 8);
  if (version >= kNatNetSizedSections) append_little_endian(bytes, 0, 8);
  append_little_endian(bytes, frame.models_changed ? 2 : 0, 2);
  append_little_endian(bytes, 0, 4);  // End marker.
  return bytes;
}

std::unique_ptr<Encoder> make_natnet_encoder() {
  return std::make_unique<NatNetEncoder>();
}

}  // namespace retarget
