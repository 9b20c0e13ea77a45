#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "judge/quality/body_tracks.h"
#include "judge/quality/limb_directions.h"
#include "judge/quality/posture.h"
#include "judge/quality/report_parts.h"
#include "retarget/human.h"
#include "solve/targets/trunk_lines.h"

namespace retarget {

/// Delay of the robot's limbs behind the human's, seconds: the shift of at most half a second that
/// maximises the correlation of the limbs' angular rates. Empty if the limbs hardly move, if the
/// clip is shorter than a second, or if the motions do not correlate.
[[nodiscard]] std::optional<double> limb_lag(const std::vector<LimbDirections>& limbs, double fps);

/// Ratio of the robot's angular speed to the human's, for arms or legs without the lines of the
/// trunk: that of both sides together, or the lower one of a single side whose limbs are faster than
/// 2 rad/s for 0.2 s. Speeds are over 0.1 s, in the fastest 2 % of the frames of each human limb,
/// without frames in which the floor may constrain the limb. Empty for clips shorter than a second and if the
/// frames with limbs faster than 2 rad/s make less than 0.1 s.
[[nodiscard]] std::optional<double> fast_speed_kept(std::span<const LimbDirections> limbs,
                                                    bool of_legs, double fps);

/// Mean horizontal speed at which a root deviates from its target path, m/s, from displacements
/// over two seconds (or the whole clip if it is shorter). The sway of the body averages out over
/// that time. Empty for a single frame.
/// @param found, wanted  positions of the root and of its target by frame, world, metres.
[[nodiscard]] std::optional<double> root_slide(const std::vector<Eigen::Vector3d>& found,
                                               const std::vector<Eigen::Vector3d>& wanted,
                                               double fps);

/// Ratio of a root's vertical motion between 2.5 and 8 Hz (steps, landings, accents) to that of its
/// target, root mean square. 1 if that of the target is at most 1 mm. Empty for clips shorter than
/// a second and for rates below 20 frames per second.
/// @param found, wanted  positions of the root and of its target by frame, world, metres.
[[nodiscard]] std::optional<double> bounce_kept(std::span<const Eigen::Vector3d> found,
                                                std::span<const Eigen::Vector3d> wanted,
                                                double fps);

/// Measures `source_slide_mean`: the excess of the speed of the source's slowest ankle or toe over
/// the speed of its hips. Its gate detects a source whose root does not travel, so that planted
/// feet move. Adds no metric for bodies without feet or hips.
void measure_source_slide(const ReportBuilder& draft, const HumanClip& human, int frames);

/// The bones that start at the hips and shoulders.
inline constexpr std::array kTrunkBones = {Bone::kLeftUpLeg, Bone::kRightUpLeg, Bone::kLeftArm,
                                           Bone::kRightArm};

/// Axes of the standing trunk (standing_trunk_lines()); empty without a trunk.
[[nodiscard]] std::optional<Eigen::Matrix3d> standing_trunk(const HumanClip& human);

/// The trunk-fixed direction that is vertical in the standing pose: R R_standing^T z, world.
/// @param trunk, standing  axes of the trunk in a frame and in the standing pose.
[[nodiscard]] inline Eigen::Vector3d trunk_up(const Eigen::Matrix3d& trunk,
                                              const Eigen::Matrix3d& standing) {
  return trunk * standing.transpose() * Eigen::Vector3d::UnitZ();
}

/// Hip and shoulder joints of a robot, in the order of kTrunkBones.
struct TrunkBodies {
  std::array<int, 4> bodies{};                     ///< Indices into BodyTracks::kept_bodies.
  std::array<Eigen::Vector3d, 4> body_from_joint;  ///< Positions in the body frames, metres.
};

/// Measures the lean of both trunks from the vertical, relative to their standing poses, in upright
/// frames. The human's standing pose is that of standing_trunk_lines(), the robot's is the zero
/// configuration. Adds no metric for bodies without a trunk.
/// @param robot_from_human  constant yaw that aligns the human with the robot.
/// @param frames            number of frames that motion and source share.
void measure_trunk_lean(const ReportBuilder& draft, const BodyTracks& tracks,
                        const TrunkBodies& trunk, const HumanClip& human,
                        const Eigen::Quaterniond& robot_from_human, const Posture& posture,
                        int frames);

}  // namespace retarget
