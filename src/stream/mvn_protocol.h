#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "retarget/error.h"
#include "retarget/pose.h"

namespace retarget {

// Xsens's MVN real-time network streaming protocol (document MV0305P): messages of a header and a
// payload, numbers with their most significant byte first.

inline constexpr std::size_t kMvnHeaderSize = 24;  // bytes

/// The messages that matter here.
enum class MvnType : int {
  kEuler = 1,  ///< Poses in other forms than the one below.
  kQuaternion = 2,
  kUnity = 5,
  kScale = 13,
};

/// What a message says of itself (2.4.1).
struct MvnHeader {
  int type = 0;
  std::uint32_t sample = 0;  ///< The frame; its messages have the same one.
  int part = 0;              ///< Of a frame in several messages: 0, 1, ...
  bool is_last = true;       ///< Of these.
  int items = 0;
  std::uint32_t milliseconds = 0;  ///< By the sender's clock.
  int actor = 0;                   ///< Whose body it is.
  std::size_t payload_size = 0;
};

/// A message's header; nothing: none begins so. Before MVN 2019 poses had no size: their number
/// tells it.
/// @param bytes  kMvnHeaderSize at least.
[[nodiscard]] std::optional<MvnHeader> read_mvn_header(std::string_view bytes);

/// The size of a message in bytes, as for MessageCutter.
[[nodiscard]] std::optional<std::size_t> mvn_message_size(std::string_view header);

/// A message of type kScale: where the 23 segments begin in the T-pose, metres, Z up.
[[nodiscard]] std::string mvn_scale_message(std::uint32_t sample, std::uint32_t milliseconds,
                                            std::span<const Eigen::Vector3d> places);
/// A message of type kQuaternion: the poses of the 23 segments, metres, Z up.
[[nodiscard]] std::string mvn_pose_message(std::uint32_t sample, std::uint32_t milliseconds,
                                           std::span<const Pose> world_from_segment);

}  // namespace retarget
