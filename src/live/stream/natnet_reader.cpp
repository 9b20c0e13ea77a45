// Reads NatNet messages by version. Since 4.1, a section contains its size; in older versions,
// unneeded data must be parsed to be skipped.

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "live/stream/natnet_protocol.h"
#include "retarget/bytes.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using NatNetReader = ByteReader<std::endian::little>;

constexpr NatNetVersion kFirstRead = {3, 0};
constexpr NatNetVersion kMarkerNames = {4, 0};

Failure cut_off(const char* what) {
  return input_failure({}, "truncated NatNet " + std::string(what) + ", or another NatNet version");
}

std::size_t read_count(NatNetReader& reader) {
  return reader.number<std::uint32_t>();
}

Eigen::Vector3d read_natnet_vector(NatNetReader& reader) {
  Eigen::Vector3d vector;
  for (double& value : vector) value = static_cast<double>(reader.number<float>());
  return vector;
}

// Skips a number of items of fixed size.
void skip(NatNetReader& reader, std::size_t count, std::size_t size) {
  if (reader.may_hold(count, size)) {
    reader.bytes(count * size);
  } else {
    reader.bytes(std::numeric_limits<std::size_t>::max());
  }
}

// Skips a number of items with a function.
template <typename SkipItem>
void skip_each(NatNetReader& reader, std::size_t count, SkipItem skip_item) {
  for (std::size_t i = 0; i < count && reader.ok(); ++i) skip_item();
}

void skip_texts(NatNetReader& reader) {
  skip_each(reader, read_count(reader), [&] { reader.text(); });
}

// Skips a section: a count and its items. Uses the section's size if present.
template <typename SkipItem>
void skip_section(NatNetReader& reader, NatNetVersion version, SkipItem skip_item) {
  const std::size_t count = read_count(reader);
  if (version >= kNatNetSizedSections) {
    reader.bytes(read_count(reader));
  } else {
    skip_each(reader, count, skip_item);
  }
}

// Skips the channels of samples of force plates and other devices.
void skip_channels(NatNetReader& reader) {
  reader.bytes(4);
  skip_each(reader, read_count(reader), [&] { skip(reader, read_count(reader), 4); });
}

NatNetBone read_bone(NatNetReader& reader, NatNetVersion version) {
  NatNetBone bone;
  bone.name = reader.text();
  bone.id = reader.number<std::int32_t>();
  bone.parent = reader.number<std::int32_t>();
  bone.offset = read_natnet_vector(reader);
  if (version >= kNatNetBoneRotations) reader.bytes(16);
  // Skip the markers: positions, labels, names.
  const std::size_t markers = read_count(reader);
  skip(reader, markers, 16);
  if (version >= kMarkerNames) skip_each(reader, markers, [&] { reader.text(); });
  return bone;
}

NatNetSkeleton read_skeleton(NatNetReader& reader, NatNetVersion version) {
  NatNetSkeleton skeleton;
  skeleton.name = reader.text();
  skeleton.id = reader.number<std::int32_t>();
  const std::size_t count = read_count(reader);
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    skeleton.bones.push_back(read_bone(reader, version));
  }
  return skeleton;
}

enum DescriptionType : std::uint32_t {
  kMarkerSet = 0,
  kRigidBody = 1,
  kSkeletonType = 2,
  kForcePlate = 3,
  kDevice = 4,
  kCamera = 5,
};

// @return whether the description's size is known, so that it could be skipped
bool skip_description(NatNetReader& reader, std::uint32_t type, NatNetVersion version) {
  switch (type) {
    case kMarkerSet:
      reader.text();
      skip_texts(reader);
      return true;
    case kRigidBody:
      read_bone(reader, version);
      return true;
    case kForcePlate:
      reader.bytes(4);
      reader.text();
      // Size, origin, 12 x 12 calibration matrix, corners, two type fields.
      reader.bytes((2 + 3 + 144 + 12 + 2) * std::size_t{4});
      skip_texts(reader);
      return true;
    case kDevice:
      reader.bytes(4);
      reader.text();
      reader.text();
      reader.bytes(8);
      skip_texts(reader);
      return true;
    case kCamera:
      reader.text();
      reader.bytes(28);
      return true;
    default:
      return false;
  }
}

NatNetBonePose read_bone_pose(NatNetReader& reader) {
  NatNetBonePose bone;
  // The upper half may contain the skeleton's ID.
  bone.id = reader.number<std::int32_t>() & 0xFFFF;
  bone.pose.translation = read_natnet_vector(reader);
  for (double& value : bone.pose.rotation.coeffs()) {
    value = static_cast<double>(reader.number<float>());
  }
  reader.bytes(4);  // Mean marker distance.
  bone.is_tracked = (reader.number<std::uint16_t>() & 1U) != 0;
  return bone;
}

// Normalises the rotation. The comparisons are negated so that NaN fails.
// @return whether the pose is valid
bool make_sound(Pose& pose) {
  constexpr double kMaxDistance = 1e4, kMinNorm = 0.1;  // metres
  const double norm = pose.rotation.norm();
  if (!(norm > kMinNorm) || !(norm < 1.0 / kMinNorm)) return false;
  pose.rotation.normalize();
  return (pose.translation.array().abs() < kMaxDistance).all();
}

void read_skeletons_of_frame(NatNetReader& reader, NatNetVersion version, std::optional<int> wanted,
                             NatNetFrame& frame) {
  const std::size_t count = read_count(reader);
  if (version >= kNatNetSizedSections) reader.bytes(4);
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    const int id = reader.number<std::int32_t>();
    const std::size_t bones = read_count(reader);
    const bool is_wanted = !frame.skeleton && (!wanted || *wanted == id);
    if (is_wanted) frame.skeleton = id;
    for (std::size_t bone = 0; bone < bones && reader.ok(); ++bone) {
      const NatNetBonePose pose = read_bone_pose(reader);
      if (is_wanted) frame.bones.push_back(pose);
    }
  }
}

void skip_rest_of_frame(NatNetReader& reader, NatNetVersion version) {
  if (version >= kNatNetSizedSections) skip_section(reader, version, [] {});  // Assets.
  constexpr std::size_t kLabelledMarker = 26;
  skip_section(reader, version, [&] { reader.bytes(kLabelledMarker); });
  skip_section(reader, version, [&] { skip_channels(reader); });  // Force plates.
  skip_section(reader, version, [&] { skip_channels(reader); });  // Devices.
}

}  // namespace

std::optional<NatNetVersion> natnet_version(std::string_view text) {
  const std::size_t dot = std::min(text.find('.'), text.size());
  const auto major = parse_number<int>(text.substr(0, dot));
  const auto minor = dot < text.size() ? parse_number<int>(text.substr(dot + 1)) : 0;
  if (!major || !minor || NatNetVersion{*major, *minor} < kFirstRead) return std::nullopt;
  return NatNetVersion{*major, *minor};
}

Result<NatNetVersion> read_natnet_server(std::string_view payload) {
  NatNetReader reader(payload);
  reader.bytes(kNatNetServerName + 4);  // Includes the program's version.
  const NatNetVersion version = {reader.number<std::uint8_t>(), reader.number<std::uint8_t>()};
  if (!reader.ok()) return cut_off("server description");
  if (version < kFirstRead) {
    return input_failure({}, "the server uses a NatNet version before 3.0, which is not supported",
                         "Motive 2.0 or later supports it");
  }
  return version;
}

Result<std::vector<NatNetSkeleton>> read_natnet_skeletons(std::string_view payload,
                                                          NatNetVersion version) {
  NatNetReader reader(payload);
  std::vector<NatNetSkeleton> skeletons;
  const std::size_t count = read_count(reader);
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    const auto type = reader.number<std::uint32_t>();
    NatNetReader item = reader;
    if (version >= kNatNetSizedSections) {
      item = NatNetReader(reader.bytes(read_count(reader)));
    }
    if (type == kSkeletonType) {
      skeletons.push_back(read_skeleton(item, version));
      if (!item.ok()) return cut_off("skeleton description");
    } else if (version < kNatNetSizedSections && !skip_description(item, type, version)) {
      break;
    }
    if (version < kNatNetSizedSections) reader = item;
  }
  if (!reader.ok()) return cut_off("description");
  return skeletons;
}

Result<void> read_natnet_frame(std::string_view payload, NatNetVersion version,
                               std::optional<int> skeleton, NatNetFrame& frame) {
  frame.skeleton.reset();
  frame.bones.clear();
  frame.models_changed = false;
  NatNetReader reader(payload);
  frame.number = reader.number<std::uint32_t>();
  skip_section(reader, version, [&] {
    reader.text();
    skip(reader, read_count(reader), 12);
  });
  skip_section(reader, version, [&] { reader.bytes(12); });  // Unlabelled markers.
  skip_section(reader, version, [&] { read_bone_pose(reader); });
  read_skeletons_of_frame(reader, version, skeleton, frame);
  skip_rest_of_frame(reader, version);
  reader.bytes(8);  // Time code.
  frame.time = reader.number<double>();
  if (!reader.ok()) return cut_off("frame");
  if (!std::isfinite(frame.time)) frame.time = std::numeric_limits<double>::quiet_NaN();
  reader.bytes(24);  // Camera and transmission timestamps.
  constexpr std::size_t kEnd = 6, kOtherStamp = 8;
  if (version.major >= 4 && reader.left() >= kOtherStamp + kEnd) reader.bytes(kOtherStamp);
  frame.models_changed = (reader.number<std::uint16_t>() & 2U) != 0;
  const bool sound =
      std::ranges::all_of(frame.bones, [](NatNetBonePose& bone) { return make_sound(bone.pose); });
  if (!sound) return input_failure({}, "the NatNet frame contains an invalid pose");
  return {};
}

}  // namespace retarget
