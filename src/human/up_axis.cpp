#include "human/up_axis.h"

#include "human/body_axes.h"

namespace retarget {
namespace {

// mean cosines of trunk and legs to an axis along which a body plainly stands, and hardly does;
// hardly any file has up along a negative axis
constexpr double kPlainly = 0.5, kHardly = 0.3, kPlainlyNegative = 0.8, kBeyondDoubt = 0.95;

// whether a body plainly stands along another axis than all others of its kind; people who lie may
// seem to for a moment
bool stands_otherwise(const Body& body, const std::vector<JointPoses>& poses, const UpGuess& guess,
                      const SignedAxis& custom) {
  constexpr std::size_t kFewest = 15;  // one and a half seconds
  if (poses.size() < kFewest) return false;
  // who lies all the time lies on the floor
  if (is_on_floor(body, poses, custom) && !is_on_floor(body, poses, guess.axis)) return false;
  return guess.axis != custom && guess.certainty > (guess.axis.negative ? kBeyondDoubt : kPlainly);
}

// whether the lowest joint keeps to height 0 along the guessed axis alone
bool floor_speaks_for(const Body& body, const std::vector<JointPoses>& poses,
                      const SignedAxis& guessed, const SignedAxis& other) {
  constexpr double kStill = 0.1;  // of a leg
  const auto has_floor = [&](const SignedAxis& axis) {
    return is_on_floor(body, poses, axis) && floor_wander(body, poses, axis) < kStill;
  };
  return has_floor(guessed) && !has_floor(other);
}

}  // namespace

UpChoice choose_up(const Body& body, const std::vector<JointPoses>& poses, const KnownUp& known) {
  if (poses.empty()) {
    return {known.of_kind.value_or(known.of_zero_pose.value_or(SignedAxis{}))};
  }
  const UpGuess guess = guess_up(body, poses);
  if (known.of_kind && !stands_otherwise(body, poses, guess, *known.of_kind)) {
    return {*known.of_kind};
  }
  UpChoice choice{guess.axis, guess.certainty < kHardly};
  const double plainly = guess.axis.negative ? kPlainlyNegative : kPlainly;
  if (known.of_zero_pose && guess.certainty < plainly &&
      !floor_speaks_for(body, poses, guess.axis, *known.of_zero_pose)) {
    choice.axis = *known.of_zero_pose;
  }
  return choice;
}

}  // namespace retarget
