#include "live/stream/mvn_protocol.h"

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "retarget/bytes.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// The corresponding segment of the other side; the same index if there is none.
std::size_t mirrored_segment(std::size_t segment) {
  constexpr std::string_view kRight = "Right", kLeft = "Left";
  const std::string_view name = kMvnSegments[segment].name;
  if (!name.starts_with(kRight)) return segment;
  const auto other = mvn_segment(std::string(kLeft).append(name.substr(kRight.size())));
  return other.value_or(segment);
}

constexpr std::string_view kMvnMagic = "MXTP";
constexpr std::size_t kMvnPoseSize = 32;  // Bytes per segment.
constexpr int kMvnLastPart = 0x80;

bool is_mvn_digit(char c) {
  return c >= '0' && c <= '9';
}

void append_mvn_float(std::string& bytes, double value) {
  append_big_endian(bytes, static_cast<float>(value));
}

void append_mvn_vector(std::string& bytes, const Eigen::Vector3d& vector) {
  for (const double value : vector) append_mvn_float(bytes, value);
}

// Builds a message with all segments of a frame, for the first actor.
std::string mvn_message(MvnType type, std::uint32_t sample, std::uint32_t milliseconds,
                        const std::string& payload) {
  std::string bytes = fmt::format("{}{:02}", kMvnMagic, static_cast<int>(type));
  append_big_endian(bytes, sample, 4);
  append_big_endian(bytes, kMvnLastPart, 1);
  append_big_endian(bytes, type == MvnType::kScale ? 1 : kMvnSegmentCount, 1);
  append_big_endian(bytes, milliseconds, 4);
  append_big_endian(bytes, 0, 1);
  append_big_endian(bytes, kMvnSegmentCount, 1);
  append_big_endian(bytes, 0, 4);  // No props, no fingers, two reserved bytes.
  append_big_endian(bytes, payload.size(), 2);
  return bytes + payload;
}

}  // namespace

std::string mvn_body_fault(const MvnOffsets& offsets) {
  constexpr double kLongest = 1.0;  // metres
  constexpr double kDifference = 0.03,
                   kPerLength = 0.3;  // Side tolerance: metres, fraction of the length.
  for (std::size_t i = 1; i < kMvnSegmentCount; ++i) {
    const double length = offsets[i].norm();
    // Negated, so that NaN is a fault.
    if (!(length <= kLongest)) {
      return fmt::format("segment {}: {:.2f} m from its parent", kMvnSegments[i].name, length);
    }
    const double other = offsets[mirrored_segment(i)].norm();
    if (std::abs(length - other) > kDifference + kPerLength * std::max(length, other)) {
      return fmt::format("segment {}: {:.2f} m from its parent, on the other side {:.2f} m",
                         kMvnSegments[i].name, length, other);
    }
  }
  return {};
}

std::optional<std::size_t> mvn_segment(std::string_view name) {
  const auto plain = [](std::string_view text) {
    std::string letters;
    for (const char c : text) {
      if (c != ' ' && c != '_') letters += c;
    }
    return lower_case(std::move(letters));
  };
  const std::string wanted = plain(name);
  const auto* const found = std::ranges::find_if(
      kMvnSegments, [&](const MvnSegment& segment) { return plain(segment.name) == wanted; });
  if (found == kMvnSegments.end()) return std::nullopt;
  return static_cast<std::size_t>(found - kMvnSegments.begin());
}

std::optional<MvnHeader> read_mvn_header(std::string_view bytes) {
  if (bytes.size() < kMvnHeaderSize || !bytes.starts_with(kMvnMagic) || !is_mvn_digit(bytes[4]) ||
      !is_mvn_digit(bytes[5])) {
    return std::nullopt;
  }
  ByteReader<std::endian::big> reader(bytes.substr(kMvnMagic.size() + 2));
  MvnHeader header;
  header.type = (bytes[4] - '0') * 10 + (bytes[5] - '0');
  header.sample = reader.number<std::uint32_t>();
  const int part = reader.number<std::uint8_t>();
  header.part = part & ~kMvnLastPart;
  header.is_last = (part & kMvnLastPart) != 0;
  header.items = reader.number<std::uint8_t>();
  header.milliseconds = reader.number<std::uint32_t>();
  header.actor = reader.number<std::uint8_t>();
  reader.bytes(5);  // Counts of segments, props and fingers, which also follow from the IDs.
  header.payload_size = reader.number<std::uint16_t>();
  if (header.payload_size == 0 && header.type == static_cast<int>(MvnType::kQuaternion)) {
    header.payload_size = kMvnPoseSize * static_cast<std::size_t>(header.items);
  }
  return header;
}

std::optional<std::size_t> mvn_message_size(std::string_view header) {
  const auto read = read_mvn_header(header);
  if (!read) return std::nullopt;
  return kMvnHeaderSize + read->payload_size;
}

std::string mvn_scale_message(std::uint32_t sample, std::uint32_t milliseconds,
                              std::span<const Eigen::Vector3d> places) {
  std::string payload;
  append_big_endian(payload, kMvnSegmentCount, 4);
  for (std::size_t i = 0; i < kMvnSegmentCount; ++i) {
    const std::string_view name = kMvnSegments[i].name;
    append_big_endian(payload, name.size(), 4);
    payload.append(name);
    append_mvn_vector(payload, places[i]);
  }
  append_big_endian(payload, 0, 4);  // Number of points.
  return mvn_message(MvnType::kScale, sample, milliseconds, payload);
}

std::string mvn_pose_message(std::uint32_t sample, std::uint32_t milliseconds,
                             std::span<const Pose> world_from_segment) {
  std::string payload;
  payload.reserve(kMvnPoseSize * kMvnSegmentCount);
  for (std::size_t i = 0; i < kMvnSegmentCount; ++i) {
    const Pose& pose = world_from_segment[i];
    append_big_endian(payload, i + 1, 4);
    append_mvn_vector(payload, pose.translation);
    append_mvn_float(payload, pose.rotation.w());
    append_mvn_vector(payload, pose.rotation.vec());
  }
  return mvn_message(MvnType::kQuaternion, sample, milliseconds, payload);
}

}  // namespace retarget
