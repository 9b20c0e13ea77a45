#pragma once

#include <Eigen/Geometry>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/pose.h"

namespace retarget {

// OptiTrack's NatNet, versions 3.0 to 4.x, as its direct depacketisation clients read it: messages of
// a number, a size and a payload, numbers with their least significant byte first.

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
  auto operator<=>(const NatNetVersion&) const = default;
};

/// From here on a section says how long it is, there are assets, and stamps are of one clock for all.
inline constexpr NatNetVersion kNatNetSizedSections = {4, 1};
/// From here on bones are described with a rotation.
inline constexpr NatNetVersion kNatNetBoneRotations = {4, 2};
inline constexpr std::size_t kNatNetServerName = 256;    ///< Bytes of the program's name.
inline constexpr std::uint32_t kNatNetSkeletonType = 2;  ///< Of what is described.

/// `4.1`; nothing: it is none that can be read.
[[nodiscard]] std::optional<NatNetVersion> natnet_version(std::string_view text);

/// A bone as it is described once.
struct NatNetBone {
  std::string name;
  int id = 0;                                        ///< In its skeleton.
  int parent = 0;                                    ///< The ID of its parent; 0: none.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< In the parent's axes, metres.
};

struct NatNetSkeleton {
  std::string name;
  int id = 0;
  std::vector<NatNetBone> bones;
};

/// A bone in a frame: metres; against its parent or in the world, as the server is set.
struct NatNetBonePose {
  int id = 0;
  Pose pose;
  bool is_tracked = true;
};

/// What a frame has of a skeleton.
struct NatNetFrame {
  std::uint32_t number = 0;
  double time = 0.0;  ///< Of the server, s; NaN: it is not there.
  bool models_changed = false;
  std::optional<int> skeleton;        ///< Nothing: it is not in the frame.
  std::vector<NatNetBonePose> bones;  ///< In the order of the frame.
};

/// A message with its header.
[[nodiscard]] std::string natnet_message(NatNetMessage type, std::string_view payload);
/// The kind of a message, by its header; nothing: it is none.
[[nodiscard]] std::optional<NatNetMessage> natnet_message_type(std::string_view bytes);
/// The size of a message in bytes, as for MessageCutter.
[[nodiscard]] std::optional<std::size_t> natnet_message_size(std::string_view header);

// Payloads. Errors (kInput): what is cut off or has numbers that are none.

/// The version of the stream, of a server's description of itself.
[[nodiscard]] Result<NatNetVersion> read_natnet_server(std::string_view payload);
/// The skeletons of a description of all that is streamed.
[[nodiscard]] Result<std::vector<NatNetSkeleton>> read_natnet_skeletons(std::string_view payload,
                                                                        NatNetVersion version);
/// @param skeleton  which one is wanted; nothing: the first one of the frame.
/// @param frame     filled; its memory serves again.
[[nodiscard]] Result<void> read_natnet_frame(std::string_view payload, NatNetVersion version,
                                             std::optional<int> skeleton, NatNetFrame& frame);

[[nodiscard]] std::string natnet_server_payload(NatNetVersion version, int data_port);
[[nodiscard]] std::string natnet_skeleton_payload(const NatNetSkeleton& skeleton,
                                                  NatNetVersion version);
/// @param frame  with the skeleton's ID and all bones.
[[nodiscard]] std::string natnet_frame_payload(const NatNetFrame& frame, NatNetVersion version);

}  // namespace retarget
