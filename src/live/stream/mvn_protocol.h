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

// Xsens's MVN real-time network streaming protocol (document MV0305P): each message has a header
// and a payload, big-endian.

inline constexpr std::size_t kMvnHeaderSize = 24;  // bytes

/// The message types that matter here.
enum class MvnType : int {
  kEuler = 1,  ///< Poses in formats other than kQuaternion.
  kQuaternion = 2,
  kUnity = 5,
  kScale = 13,
};

/// A message header (2.4.1).
struct MvnHeader {
  int type = 0;
  std::uint32_t sample = 0;  ///< Frame number, shared by its messages.
  int part = 0;              ///< Index of this message within its frame: 0, 1, ...
  bool is_last = true;       ///< Last message of its frame.
  int items = 0;
  std::uint32_t milliseconds = 0;  ///< Sender's clock.
  int actor = 0;                   ///< ID of the performer.
  std::size_t payload_size = 0;
};

/// Reads a message's header; nothing if invalid. Before MVN 2019, pose messages had no size field,
/// so the size follows from the number of items.
/// @param bytes  at least kMvnHeaderSize.
[[nodiscard]] std::optional<MvnHeader> read_mvn_header(std::string_view bytes);

/// The size of a message in bytes, for MessageCutter.
[[nodiscard]] std::optional<std::size_t> mvn_message_size(std::string_view header);

/// Builds a kScale message: origins of the 23 segments in the T-pose, metres, Z up.
[[nodiscard]] std::string mvn_scale_message(std::uint32_t sample, std::uint32_t milliseconds,
                                            std::span<const Eigen::Vector3d> places);
/// Builds a kQuaternion message: poses of the 23 segments, metres, Z up.
[[nodiscard]] std::string mvn_pose_message(std::uint32_t sample, std::uint32_t milliseconds,
                                           std::span<const Pose> world_from_segment);

}  // namespace retarget
