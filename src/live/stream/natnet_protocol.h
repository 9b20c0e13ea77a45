#pragma once

#include <Eigen/Geometry>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/pose.h"

namespace retarget {

class Encoder;

// OptiTrack's NatNet protocol, versions 3.0 to 4.x, as direct depacketisation clients read it: each
// message has a number, a size and a payload, little-endian.

inline constexpr std::size_t kNatNetHeaderSize = 4;  // bytes

enum class NatNetMessage : std::uint16_t {
  kConnect = 0,
  kServerInfo = 1,
  kCommand = 2,
  kResponse = 3,
  kModelsRequest = 4,
  kModels = 5,
  kFrameRequest = 6,
  kFrame = 7,
  kText = 8,
  kDisconnect = 9,
  kKeepAlive = 10,
  kUnrecognised = 100,
};

struct NatNetVersion {
  int major = 0;
  int minor = 0;
  // NOLINTNEXTLINE(modernize-use-nullptr): the check takes the comparison with 0 for a pointer
  auto operator<=>(const NatNetVersion&) const = default;
};

/// Since this version, sections start with their size, there are assets, and all timestamps share
/// one clock.
inline constexpr NatNetVersion kNatNetSizedSections = {4, 1};
/// Since this version, bone descriptions contain a rotation.
inline constexpr NatNetVersion kNatNetBoneRotations = {4, 2};
inline constexpr std::size_t kNatNetServerName = 256;    ///< Size of the program name, bytes.
inline constexpr std::uint32_t kNatNetSkeletonType = 2;  ///< Type of a skeleton description.

/// Parses a version such as `4.1`; nothing if it is invalid or unsupported.
[[nodiscard]] std::optional<NatNetVersion> natnet_version(std::string_view text);

/// Description of a bone, sent once.
struct NatNetBone {
  std::string name;
  int id = 0;                                        ///< ID within its skeleton.
  int parent = 0;                                    ///< ID of the parent; 0: none.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< Offset in the parent's axes, metres.
};

struct NatNetSkeleton {
  std::string name;
  int id = 0;
  std::vector<NatNetBone> bones;
};

/// Pose of a bone in a frame, metres; relative to its parent or in the world, depending on the
/// server's settings.
struct NatNetBonePose {
  int id = 0;
  Pose pose;
  bool is_tracked = true;
};

/// The data of a frame for one skeleton.
struct NatNetFrame {
  std::uint32_t number = 0;
  double time = 0.0;  ///< Server time, s; NaN: missing.
  bool models_changed = false;
  std::optional<int> skeleton;        ///< Empty: the frame does not contain it.
  std::vector<NatNetBonePose> bones;  ///< Poses in the order of the frame.
};

/// Builds a message with its header.
[[nodiscard]] std::string natnet_message(NatNetMessage type, std::string_view payload);
/// The type of a message according to its header; nothing if invalid.
[[nodiscard]] std::optional<NatNetMessage> natnet_message_type(std::string_view bytes);
/// The size of a message in bytes, for MessageCutter.
[[nodiscard]] std::optional<std::size_t> natnet_message_size(std::string_view header);

// Payloads. Errors (kInput): truncated data, invalid numbers.

[[nodiscard]] Result<NatNetVersion> read_natnet_server(std::string_view payload);
/// Reads the skeletons from a description of all streamed models.
[[nodiscard]] Result<std::vector<NatNetSkeleton>> read_natnet_skeletons(std::string_view payload,
                                                                        NatNetVersion version);
/// @param skeleton  ID of the wanted skeleton; nothing: the first one of the frame.
/// @param frame     output; reuses its memory.
[[nodiscard]] Result<void> read_natnet_frame(std::string_view payload, NatNetVersion version,
                                             std::optional<int> skeleton, NatNetFrame& frame);

[[nodiscard]] std::string natnet_server_payload(NatNetVersion version, int data_port);
[[nodiscard]] std::string natnet_skeleton_payload(const NatNetSkeleton& skeleton,
                                                  NatNetVersion version);
/// @param frame  contains the skeleton's ID and all bones.
[[nodiscard]] std::string natnet_frame_payload(const NatNetFrame& frame, NatNetVersion version);

[[nodiscard]] std::unique_ptr<Encoder> make_natnet_encoder();

}  // namespace retarget
