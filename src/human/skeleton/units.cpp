#include "human/skeleton/units.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>

#include "retarget/human.h"

namespace retarget {
namespace {

using enum LimbBone;

constexpr double kFootDrop = 0.42261826174069944;  // Sine of 25 degrees.
constexpr double kLegShare = 0.491;                // Thigh .245 and shank .246 of body height.
constexpr double kLegAndTrunkShare = 0.894;

constexpr double kAverageHeight = 1.7;  // Metres.

// Range of human hip heights in a unit.
struct UnitRange {
  const char* name;
  double metres, low, high;
};
// A profile's unit is plausible for bodies down to this height in metres. An adult of 1.75 m in
// inches would have 0.69 m in centimetres.
constexpr double kMinOfKind = 0.7;
// 46 units are the border between a child of two in centimetres and a man of 2.2 m in inches.
constexpr std::array<UnitRange, 6> kRanges = {{{"m", 1.0, 0.46, 1.4},
                                               {"dm", 0.1, 4.6, 13.0},
                                               {"CMU unit", 0.056444, 13.0, 20.5},
                                               {"inch", 0.0254, 20.5, 46.0},
                                               {"cm", 0.01, 46.0, 140.0},
                                               {"mm", 0.001, 460.0, 1400.0}}};

// Total length of these bones, averaged over the sides that have all of them; 0 if neither has.
double mean_length(const Body& body, const JointPoses& rest,
                   std::initializer_list<LimbBone> parts) {
  double sum = 0.0;
  int sides = 0;
  for (const Side side : kSides) {
    double length = 0.0;
    bool whole = true;
    for (const LimbBone part : parts) {
      const auto way = along(body.segment(side_bone(side, part)), rest);
      whole = whole && way.has_value() && (part != kFoot || body.has(side_bone(side, kToe)));
      if (way) length += way->norm();
    }
    if (!whole) continue;
    sum += length;
    ++sides;
  }
  return sides == 0 ? 0.0 : sum / sides;
}

std::optional<Eigen::Vector3d> between_thighs(const Body& body, const JointPoses& rest) {
  if (!body.has(Bone::kLeftUpLeg) || !body.has(Bone::kRightUpLeg)) return std::nullopt;
  return 0.5 * (rest[body.joint(Bone::kLeftUpLeg)].translation +
                rest[body.joint(Bone::kRightUpLeg)].translation);
}

// Returns the unit with this length, and its name if it is known.
Unit unit_of_length(double metres) {
  for (const UnitRange& range : kRanges) {
    if (range.metres == metres) return {range.name, range.metres};
  }
  return {"given", metres};
}

}  // namespace

double standing_hip_height(const Body& body, const JointPoses& rest, const BodyFromFile& axes) {
  const double leg = mean_length(body, rest, {kUpLeg, kLeg});
  if (leg <= 0.0) return 0.0;
  double rise = 0.0;
  if (const auto thighs = between_thighs(body, rest)) {
    rise = axes.row(2).dot(rest[body.joint(Bone::kHips)].translation - *thighs);
  }
  return leg + kFootDrop * mean_length(body, rest, {kFoot}) + rise;
}

std::optional<Unit> guess_unit(double hip_height) {
  for (const UnitRange& range : kRanges) {
    if (hip_height >= range.low && hip_height < range.high) return Unit{range.name, range.metres};
  }
  return std::nullopt;
}

std::optional<Unit> unit_of_body(const BodySize& size) {
  // Largest deviations from a given height. Height estimates are accurate to a few percent.
  constexpr double kAbout = 1.15, kFar = 1.5;
  std::optional<Unit> unit = guess_unit(size.hip_height);
  if (size.metres_per_unit) {
    const double hips = size.hip_height * *size.metres_per_unit;
    const bool is_tall_enough =
        hips >= kRanges[0].low || size.height * *size.metres_per_unit >= kMinOfKind;
    if (is_tall_enough && hips < kRanges[0].high) {
      unit = unit_of_length(*size.metres_per_unit);
    }
  }
  if (!size.given_height || size.height <= 0.0) return unit;
  const double exact = *size.given_height / size.height;
  const auto off = [exact](double metres) { return std::max(metres / exact, exact / metres); };
  if (unit && off(unit->metres) <= kFar) return unit;
  const auto nearest = std::ranges::min_element(
      kRanges, {}, [&](const UnitRange& range) { return off(range.metres); });
  if (off(nearest->metres) <= kAbout) return Unit{nearest->name, nearest->metres};
  return unit ? unit : Unit{"scaled", exact};
}

bool has_human_proportions(double hip_height, double height) {
  // Adults have 1.75 to 1.95, children of two 2.2, characters with long legs 1.6.
  constexpr double kLeast = 1.4, kMost = 2.4;
  return hip_height > 0.0 && height > kLeast * hip_height && height < kMost * hip_height;
}

Unit unit_of_average_body(double height) {
  return {"unknown", height > 0.0 ? kAverageHeight / height : 1.0};
}

std::string assumed_unit_text(double hip_height) {
  return "hips " + std::to_string(hip_height) +
         " units above the floor match a person in no known unit: scaled to a body height of " +
         metres_text(kAverageHeight);
}

std::string metres_text(double metres) {
  return fmt::format("{:.2f} m", metres);
}

bool is_lafan1_height(double metres) {
  constexpr double kHeight = 1.75, kMaxOff = 0.03;
  return std::abs(metres / kHeight - 1.0) <= kMaxOff;
}

double height_of_legs(const Body& body, const JointPoses& rest) {
  return mean_length(body, rest, {kUpLeg, kLeg}) / kLegShare;
}

double estimated_height(const Body& body, const JointPoses& rest) {
  const double leg = mean_length(body, rest, {kUpLeg, kLeg});
  if (leg <= 0.0) return 0.0;
  const auto start = between_thighs(body, rest);
  if (!start || !body.has(Bone::kHead)) return leg / kLegShare;
  double trunk = 0.0;
  Eigen::Vector3d at = *start;
  for (const Bone bone : {Bone::kSpine, Bone::kSpine1, Bone::kSpine2, Bone::kNeck, Bone::kHead}) {
    if (!body.has(bone)) continue;
    const Eigen::Vector3d& next = rest[body.joint(bone)].translation;
    trunk += (next - at).norm();
    at = next;
  }
  return (leg + trunk) / kLegAndTrunkShare;
}

}  // namespace retarget
