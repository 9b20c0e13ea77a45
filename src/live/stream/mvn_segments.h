#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "retarget/human.h"

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

}  // namespace retarget
