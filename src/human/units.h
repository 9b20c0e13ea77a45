#pragma once

#include <optional>
#include <string>

#include "human/body_axes.h"
#include "human/posed_body.h"

namespace retarget {

/// Height of the hips' joint over the ball of the foot of a body that stands upright, in the
/// file's unit, from bone lengths: thigh, shin, the foot's drop (sin 25 deg of its length) and
/// how far the hips' joint lies above those of the thighs in `rest`. 0 without a leg.
[[nodiscard]] double standing_hip_height(const Body& body, const JointPoses& rest,
                                         const BodyFromFile& axes);

struct Unit {
  std::string name;
  double metres = 0.0;
};

/// The unit in which a hip height is that of a person, a child of two to a giant:
/// m 0.46-1.4, dm 4.6-13, CMU's 0.056444 m 13-20.5, inch 20.5-46, cm 46-140, mm 460-1400.
/// Nothing in between.
[[nodiscard]] std::optional<Unit> guess_unit(double hip_height);

/// What is known of a body's size.
struct BodySize {
  double hip_height = 0.0;                ///< standing_hip_height, file units.
  double height = 0.0;                    ///< estimated_height, file units; 0: unknown.
  std::optional<double> metres_per_unit;  ///< In all files of its kind.
  std::optional<double> told_height;      ///< Metres.
};

/// The unit of a file: that of its kind where the hips are then a person's or the body is at least
/// 0.7 m tall, else the known one in which they are a person's. Where a told height is far off, or
/// neither is so, the known unit in which the body has about that height; where there is none such
/// and no other, the length in which it has just that (`scaled`). Nothing where nothing tells.
[[nodiscard]] std::optional<Unit> unit_of_body(const BodySize& size);

/// The unit in which a body of this height (file units) is an average person, for what needs none;
/// its doubt, for people.
[[nodiscard]] Unit unit_of_average_body(double height);
[[nodiscard]] std::string assumed_unit_text(double hip_height);

/// `1.75 m`.
[[nodiscard]] std::string metres_text(double metres);

/// Whether a body is as tall as LAFAN1's, by its bones, within 3 %.
[[nodiscard]] bool is_lafan1_height(double metres);

/// Height of a body of average proportions that has these legs (thigh and shin), file units; 0
/// without legs.
[[nodiscard]] double height_of_legs(const Body& body, const JointPoses& rest);

/// Body height in the file's unit from bone lengths: thigh and shin (the mean of both legs) and the
/// way from between the thighs' joints along the spine to the head joint are 89.4 % of it; what
/// remains is the ankle's height over the sole and the head above its joint (3.9 % and 6.7 %; the
/// former and the legs' 49.1 %, which serve alone where there is no head, from Drillis and Contini
/// 1966 as in D. A. Winter, Biomechanics and Motor Control of Human Movement, table 4.1; the
/// sum holds LAFAN1's skeleton at its 1.75 m). 0 without a leg.
[[nodiscard]] double estimated_height(const Body& body, const JointPoses& rest);

}  // namespace retarget
