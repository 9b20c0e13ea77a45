#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/pose.h"

namespace retarget {

/// A segment of MVN's body, as in MVNX and the network streamer.
struct MvnSegment {
  std::string_view name;  ///< MVNX spelling.
  int parent;             ///< Index into the table; -1: none.
  Bone bone;              ///< Canonical bone that drives it in playback.
};

/// Segments ordered by ID, counted from 1 (MV0305P, 3.1): parents before children.
inline constexpr auto kMvnSegments = std::to_array<MvnSegment>({
    {"Pelvis", -1, Bone::kHips},
    {"L5", 0, Bone::kSpine},
    {"L3", 1, Bone::kSpine1},
    {"T12", 2, Bone::kSpine1},
    {"T8", 3, Bone::kSpine2},
    {"Neck", 4, Bone::kNeck},
    {"Head", 5, Bone::kHead},
    {"RightShoulder", 4, Bone::kRightShoulder},
    {"RightUpperArm", 7, Bone::kRightArm},
    {"RightForeArm", 8, Bone::kRightForeArm},
    {"RightHand", 9, Bone::kRightHand},
    {"LeftShoulder", 4, Bone::kLeftShoulder},
    {"LeftUpperArm", 11, Bone::kLeftArm},
    {"LeftForeArm", 12, Bone::kLeftForeArm},
    {"LeftHand", 13, Bone::kLeftHand},
    {"RightUpperLeg", 0, Bone::kRightUpLeg},
    {"RightLowerLeg", 15, Bone::kRightLeg},
    {"RightFoot", 16, Bone::kRightFoot},
    {"RightToe", 17, Bone::kRightToe},
    {"LeftUpperLeg", 0, Bone::kLeftUpLeg},
    {"LeftLowerLeg", 19, Bone::kLeftLeg},
    {"LeftFoot", 20, Bone::kLeftFoot},
    {"LeftToe", 21, Bone::kLeftToe},
});
inline constexpr std::size_t kMvnSegmentCount = kMvnSegments.size();

/// Index of the segment with a name, ignoring case, blanks and underscores (`Right Forearm`);
/// nothing for a prop, a finger or an unknown name.
[[nodiscard]] std::optional<std::size_t> mvn_segment(std::string_view name);

/// Offset of each segment from its parent, metres.
using MvnOffsets = std::array<Eigen::Vector3d, kMvnSegmentCount>;

/// Describes why the offsets are implausible for a person, for example because of damaged data;
/// empty if plausible.
[[nodiscard]] std::string mvn_body_fault(const MvnOffsets& offsets);

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
