// Builds the messages that a NatNet server sends.

#include <algorithm>
#include <bit>

#include "live/stream/natnet_protocol.h"
#include "retarget/bytes.h"

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

}  // namespace retarget
