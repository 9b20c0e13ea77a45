#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "human/skeleton/human_clip.h"
#include "judge/quality/body_tracks.h"
#include "judge/quality/limb_directions.h"
#include "judge/quality/posture.h"
#include "judge/quality/report_parts.h"
#include "retarget/human.h"
#include "solve/targets/trunk_lines.h"

namespace retarget {

/// Delay of the robot's limbs relative to the human's, seconds: the shift of the human's limbs,
/// within half a second either way, that maximises the correlation of the rates at which both turn.
/// Nothing if limbs hardly move, for clips of less than a second, and if the robot's motion does
/// not resemble the human's.
[[nodiscard]] std::optional<double> limb_lag(const std::vector<LimbDirections>& limbs, double fps);

/// Mean horizontal speed at which a root drifts from its target path, m/s, measured over two
/// seconds or over the whole of shorter clips. Sway of the body averages out over that time.
/// Empty for a single frame.
/// @param found, wanted  positions by frame, world, metres.
[[nodiscard]] std::optional<double> root_slide(const std::vector<Eigen::Vector3d>& found,
                                               const std::vector<Eigen::Vector3d>& wanted,
                                               double fps);

/// Share of its target's vertical movement between 2.5 and 8 Hz that a root has: steps, landings
/// and accents. 1 if the target moves less than 1 mm there. Nothing for clips of less than a second
/// and for less than 20 frames per second.
/// @param found, wanted  positions by frame, world, metres.
[[nodiscard]] std::optional<double> bounce_kept(std::span<const Eigen::Vector3d> found,
                                                std::span<const Eigen::Vector3d> wanted,
                                                double fps);

/// Measures how much faster the slowest of the source's ankles and toes is than its hips. The gate
/// on it detects a source whose planted feet move because its root does not. Adds nothing for
/// bodies without feet or hips.
void measure_source_slide(const ReportBuilder& draft, const HumanClip& human, int frames);

/// The bones that start at the hips and shoulders.
inline constexpr std::array kTrunkBones = {Bone::kLeftUpLeg, Bone::kRightUpLeg, Bone::kLeftArm,
                                           Bone::kRightArm};

/// Whether the hips, both hip joints and both shoulders exist.
[[nodiscard]] bool has_trunk(const HumanClipInfo& human);

/// Axes of the standing trunk (standing_trunk_lines); nothing without a trunk.
[[nodiscard]] std::optional<Eigen::Matrix3d> standing_trunk(const HumanClip& human);

/// Up direction of the standing pose, fixed to the trunk: R R_standing^T z.
[[nodiscard]] inline Eigen::Vector3d trunk_up(const Eigen::Matrix3d& trunk,
                                              const Eigen::Matrix3d& standing) {
  return trunk * standing.transpose() * Eigen::Vector3d::UnitZ();
}

/// A robot's hips and shoulders, in the order of kTrunkBones.
struct TrunkBodies {
  std::array<int, 4> bodies{};  ///< Indices among the kept bodies.
  std::array<Eigen::Vector3d, 4> body_from_joint;
};

/// Measures how far both trunks lean from the vertical while the body is upright, relative to their
/// standing poses. The human's standing pose comes from standing_trunk_lines, the robot's is the
/// zero configuration. Adds nothing for bodies without a trunk.
/// @param robot_from_human  a yaw.
/// @param frames            number of frames of both.
void measure_trunk_lean(const ReportBuilder& draft, const BodyTracks& tracks,
                        const TrunkBodies& trunk, const HumanClip& human,
                        const Eigen::Quaterniond& robot_from_human, const Posture& posture,
                        int frames);

}  // namespace retarget
