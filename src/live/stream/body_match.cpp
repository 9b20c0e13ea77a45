#include "live/stream/body_match.h"

#include <array>
#include <cmath>
#include <utility>

namespace retarget {
namespace {

constexpr double kMuch = 0.12;  // Relative difference; limbs of noisy positions vary less.
constexpr double kUnit = 2.0;   // Ratio; persons differ less.
constexpr int kFrames = 20;     // Consecutive frames; single ones may be wrong.

}  // namespace

BodyMatch::BodyMatch(const Calibration& calibration, const HumanPose& body) {
  constexpr double kLeast = 0.1;  // Metres; a shorter body has no pose.
  using enum LimbBone;
  constexpr std::array kParts = {std::pair{kUpLeg, kLeg}, std::pair{kLeg, kFoot},
                                 std::pair{kArm, kForeArm}, std::pair{kForeArm, kHand}};
  const auto is_known = [&](Bone bone) { return calibration.bones[bone].position_joint >= 0; };
  for (const Side side : kSides) {
    for (const auto& [upper, lower] : kParts) {
      const Bone from = side_bone(side, upper), to = side_bone(side, lower);
      if (is_known(from) && is_known(to)) segments_.emplace_back(from, to);
    }
  }
  const double length = length_of(body);
  if (length > kLeast) length_ = length;
}

double BodyMatch::length_of(const HumanPose& human) const {
  double length = 0.0;
  for (const auto& [from, to] : segments_) {
    length += (human[to].translation - human[from].translation).norm();
  }
  return length;
}

BodyMatch::Fit BodyMatch::add(const HumanPose& human) {
  if (length_ == 0.0) return Fit::kSame;
  const double ratio = length_of(human) / length_;
  // The solver rejects frames that are not finite.
  if (!std::isfinite(ratio)) return Fit::kSame;
  ratio_ = ratio;
  if (ratio > kUnit || ratio * kUnit < 1.0) {
    others_ = 0;
    return Fit::kNoPerson;
  }
  const bool is_other = ratio > 1.0 + kMuch || ratio * (1.0 + kMuch) < 1.0;
  others_ = is_other ? others_ + 1 : 0;
  if (others_ < kFrames || std::exchange(is_reported_, true)) return Fit::kSame;
  return Fit::kOther;
}

}  // namespace retarget
