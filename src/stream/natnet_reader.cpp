// What a NatNet server sends, by version. From 4.1 on a section says how long it is; before that, what nobody wants
// must be read to be passed over.

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "base/byte_order.h"
#include "base/number_text.h"
#include "base/try.h"
#include "stream/natnet_protocol.h"

namespace retarget {
namespace {

using NatNetReader = ByteReader<std::endian::little>;

constexpr NatNetVersion kFirstRead = {3, 0};
constexpr NatNetVersion kMarkerNames = {4, 0};

Failure cut_off(const char* what) {
  return input_failure({}, std::string(what) + " of NatNet that is cut off or of another version");
}

std::size_t read_count(NatNetReader& reader) {
  return reader.number<std::uint32_t>();
}

Eigen::Vector3d read_natnet_vector(NatNetReader& reader) {
  Eigen::Vector3d vector;
  for (double& value : vector) value = static_cast<double>(reader.number<float>());
  return vector;
}

// passes over so many items of a size
void skip(NatNetReader& reader, std::size_t count, std::size_t size) {
  if (reader.may_hold(count, size)) {
    reader.bytes(count * size);
  } else {
    reader.bytes(std::numeric_limits<std::size_t>::max());
  }
}

// passes over so many items, each by a function
template <typename SkipItem>
void skip_each(NatNetReader& reader, std::size_t count, SkipItem skip_item) {
  for (std::size_t i = 0; i < count && reader.ok(); ++i) skip_item();
}

void skip_texts(NatNetReader& reader) {
  skip_each(reader, read_count(reader), [&] { reader.text(); });
}

// A count and what it counts: passed over by its size, where it has one.
template <typename SkipItem>
void skip_section(NatNetReader& reader, NatNetVersion version, SkipItem skip_item) {
  const std::size_t count = read_count(reader);
  if (version >= kNatNetSizedSections) {
    reader.bytes(read_count(reader));
  } else {
    skip_each(reader, count, skip_item);
  }
}

// numbers of force plates and other devices: channels of samples
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
  // markers: places, labels, names
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

// @return whether it is known how long it is
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
      // size, origin, calibration of 12 by 12, corners, two kinds
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
  // the skeleton's ID may be in the upper half
  bone.id = reader.number<std::int32_t>() & 0xFFFF;
  bone.pose.translation = read_natnet_vector(reader);
  for (double& value : bone.pose.rotation.coeffs()) {
    value = static_cast<double>(reader.number<float>());
  }
  reader.bytes(4);  // the mean distance of markers
  bone.is_tracked = (reader.number<std::uint16_t>() & 1U) != 0;
  return bone;
}

// written so that a value that is no number is none
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
  if (version >= kNatNetSizedSections) skip_section(reader, version, [] {});  // assets
  constexpr std::size_t kLabelledMarker = 26;
  skip_section(reader, version, [&] { reader.bytes(kLabelledMarker); });
  skip_section(reader, version, [&] { skip_channels(reader); });  // force plates
  skip_section(reader, version, [&] { skip_channels(reader); });  // devices
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
  reader.bytes(kNatNetServerName + 4);  // and the version of the program
  const NatNetVersion version = {reader.number<std::uint8_t>(), reader.number<std::uint8_t>()};
  if (!reader.ok()) return cut_off("a server's description");
  if (version < kFirstRead) {
    return input_failure({}, "the server speaks NatNet before 3.0, which is not read",
                         "Motive 2.0 or later speaks it");
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
      if (!item.ok()) return cut_off("a skeleton's description");
    } else if (version < kNatNetSizedSections && !skip_description(item, type, version)) {
      break;
    }
    if (version < kNatNetSizedSections) reader = item;
  }
  if (!reader.ok()) return cut_off("a description");
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
  skip_section(reader, version, [&] { reader.bytes(12); });  // markers without a name
  skip_section(reader, version, [&] { read_bone_pose(reader); });
  read_skeletons_of_frame(reader, version, skeleton, frame);
  skip_rest_of_frame(reader, version);
  reader.bytes(8);  // time code
  frame.time = reader.number<double>();
  if (!reader.ok()) return cut_off("a frame");
  if (!std::isfinite(frame.time)) frame.time = std::numeric_limits<double>::quiet_NaN();
  reader.bytes(24);  // stamps of cameras and of sending
  constexpr std::size_t kEnd = 6, kOtherStamp = 8;
  if (version.major >= 4 && reader.left() >= kOtherStamp + kEnd) reader.bytes(kOtherStamp);
  frame.models_changed = (reader.number<std::uint16_t>() & 2U) != 0;
  const bool sound =
      std::ranges::all_of(frame.bones, [](NatNetBonePose& bone) { return make_sound(bone.pose); });
  if (!sound) return input_failure({}, "a frame of NatNet with a pose that is none");
  return {};
}

}  // namespace retarget
