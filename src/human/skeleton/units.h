#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "human/skeleton/posed_body.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human_skeleton.h"

namespace retarget {

/// Height of the hip joint above the ball of the foot of a body standing upright, in file units. It
/// is the sum of thigh, shin, the drop of the foot (sin 25 deg of its length) and the height of the
/// hip joint above the thigh joints in `rest`. 0 without a leg.
[[nodiscard]] double standing_hip_height(const Body& body, const JointPoses& rest,
                                         const BodyFromFile& axes);

struct Unit {
  std::string name;
  double metres = 0.0;
};

/// Returns the unit in which a hip height fits a person, from a child of two to a giant: m
/// 0.46-1.4, dm 4.6-13, CMU's 0.056444 m 13-20.5, inch 20.5-46, cm 46-140, mm 460-1400. Returns
/// nothing outside these ranges.
[[nodiscard]] std::optional<Unit> guess_unit(double hip_height);

/// Known quantities about a body's size.
struct BodySize {
  double hip_height = 0.0;                ///< standing_hip_height, file units.
  double height = 0.0;                    ///< estimated_height, file units; 0: unknown.
  std::optional<double> metres_per_unit;  ///< Unit of this kind of file.
  std::optional<double> given_height;     ///< Height given by the user, metres.
};

/// Determines the unit of a file. The unit of its kind applies if the hips are then at most as high
/// as a giant's, and either as high as a child's or the body is at least 0.7 m tall. Otherwise
/// guess_unit applies. If the result contradicts a given height (by more than a factor of 1.5) or
/// there is none, the known unit that fits the given height within 15 % applies, else the previous
/// result; without one, the length that gives exactly this height (`scaled`). Returns nothing if no
/// rule applies.
[[nodiscard]] std::optional<Unit> unit_of_body(const BodySize& size);

/// Whether body height and hip height have human proportions, in any unit.
[[nodiscard]] bool has_human_proportions(double hip_height, double height);

/// Returns the unit that makes a body of this height (file units) an average person, for callers
/// that do not need a unit; assumed_unit_text is its warning, human-readable.
[[nodiscard]] Unit unit_of_average_body(double height);
[[nodiscard]] std::string assumed_unit_text(double hip_height);

/// Formats metres, for example `1.75 m`.
[[nodiscard]] std::string metres_text(double metres);

/// Whether a body, by its bones, is as tall as LAFAN1's within 3 %.
[[nodiscard]] bool is_lafan1_height(double metres);

/// Height of an average body with these legs (thigh and shin), file units; 0 without legs.
[[nodiscard]] double height_of_legs(const Body& body, const JointPoses& rest);

/// Body height in file units, estimated from bone lengths. Thigh and shin (the mean of both legs)
/// and the path from between the thigh joints along the spine to the head joint are 89.4 % of it.
/// The remainder is the ankle's height above the sole (3.9 %) and the head above its joint (6.7 %).
/// Without a head, the legs alone are 49.1 %. The ankle and leg shares are from Drillis and Contini
/// 1966, as in D. A. Winter, Biomechanics and Motor Control of Human Movement, table 4.1. The sum
/// keeps LAFAN1's skeleton at its 1.75 m. 0 without a leg.
[[nodiscard]] double estimated_height(const Body& body, const JointPoses& rest);

/// Repairs a clip whose units are inconsistent, as its feet show: a standing or walking body rests
/// on one of its ankles or toes, whose speed is measured in legs (thigh plus shin) per second.
///
/// * Rotations in radians that were read as degrees: no joint turns by more than about 2 pi of them
///   (the root by six times this), trunk and legs point apart when read as radians, and either the
///   slowest foot is less than half as fast in radians, or trunk and legs point the same way in
///   degrees. They are converted.
/// * A root translation in another unit than the OFFSETs: with the translation multiplied by the
///   ratio of two units, the slowest foot is less than 0.4 times as fast, and less than half as
///   fast as without any translation. It is converted.
///
/// A scale that is not a ratio of two units stays unchanged, and so does a clip made from joint
/// positions: it has no angles, and one unit.
/// @return one warning per change or uncertain assumption
[[nodiscard]] std::vector<Warning> repair_clip_units(Clip& clip, const BoneMap& map);

/// Returns a warning if the root of a repaired clip does not move while the feet do. Parts that are
/// lower than the feet count as feet, such as the hands of a handstand.
/// @param up  unit vector in the file's axes
[[nodiscard]] std::optional<Warning> find_missing_root(const Clip& clip, const BoneMap& map,
                                                       const Eigen::Vector3d& up);

/// Returns a warning if the feet stand still only with another horizontal path of the root: scaled
/// by a factor beyond 1.3, mirrored or turned. The slowest foot is then less than 0.4 times as fast
/// as in the clip, and less than half as fast as without a path.
/// @param up  unit vector in the file's axes
[[nodiscard]] std::optional<Warning> doubt_root_path(const Clip& clip, const BoneMap& map,
                                                     const Eigen::Vector3d& up);

}  // namespace retarget
