#include "human/skeleton/up_axis.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "base/option_name.h"
#include "human/skeleton/up_evidence.h"
#include "human/skeleton/up_guess.h"
#include "retarget/human.h"
#include "retarget/pose.h"

namespace retarget {
namespace {

// Mean cosines of trunk and legs to an axis: clearly standing, hardly standing, and the bounds for
// negative axes, which files rarely use as up, for squats, and for bodies that are always upright.
constexpr double kPlainly = 0.5, kMinCertainty = 0.3, kPlainlyNegative = 0.8, kMostly = 0.8,
                 kBeyondDoubt = 0.95;

// The hips of a lying body are lower than those of a standing one, by this share of a leg.
constexpr double kLowerHips = 0.2;

// Up axes of files.
constexpr std::array kCommonAxes = {SignedAxis{1, false}, SignedAxis{2, false}};

// A declared up axis and its source.
struct Declared {
  SignedAxis axis;
  std::string_view source;
};

std::string taken_text(const SignedAxis& axis) {
  return "using " + to_text(axis) + " as the up axis; override it with " OPTION("up");
}

SignedAxis opposite(const SignedAxis& axis) {
  return {axis.axis, !axis.negative};
}

class UpChooser {
 public:
  UpChooser(const Body& body, const std::vector<JointPoses>& poses, const KnownUp& known)
      : body_(body), poses_(poses), known_(known), guess_(guess_up(body, poses)) {}

  [[nodiscard]] UpChoice choose() const {
    constexpr std::string_view kFile = "the file", kKind = "this kind of skeleton",
                               kZero = "the zero pose";
    if (known_.of_file) return by_file({*known_.of_file, kFile});
    const auto &kind = known_.of_kind, &zero = known_.of_zero_pose;
    if (kind && zero && *kind != *zero) return between({*kind, kKind}, {*zero, kZero});
    if (kind) return by_kind({*kind, kKind});
    return zero ? by_zero_pose({*zero, kZero}) : by_movement();
  }

 private:
  [[nodiscard]] FloorEvidence floor(const SignedAxis& axis) const {
    return floor_evidence(body_, poses_, axis);
  }

  // Whether trunk and legs clearly point along the guessed axis, for longer than a moment.
  [[nodiscard]] bool is_plain() const {
    constexpr std::size_t kMinFrames = 15;  // One and a half seconds.
    return poses_.size() >= kMinFrames &&
           guess_.certainty > (guess_.axis.negative ? kBeyondDoubt : kPlainly);
  }

  [[nodiscard]] bool stands_rather_than(const SignedAxis& other) const {
    if (known_.of_fall) return *known_.of_fall == guess_.axis;
    return guess_.certainty > kPlainly && clearly_stands(floor(guess_.axis), floor(other));
  }

  // Whether the body is on a floor at height 0, or may rest on one.
  [[nodiscard]] bool may_have_floor(const SignedAxis& axis) const {
    const FloorEvidence along = floor(axis);
    return along.on_floor() || along.may_rest();
  }

  // Whether the lowest joint stays at height 0 along the first axis, and the body cannot rest on a
  // floor along the other one.
  [[nodiscard]] bool has_floor_rather_than(const SignedAxis& axis, const SignedAxis& other) const {
    return floor(axis).on_floor() && !may_have_floor(other);
  }

  // Whether the body travels along an axis, and much less along the other two. On stairs and slopes
  // it also travels horizontally.
  [[nodiscard]] bool rises_most_along(const SignedAxis& up) const {
    const FloorEvidence along = floor(up);
    return climbs_along(along, floor({(up.axis + 1) % 3, false})) &&
           climbs_along(along, floor({(up.axis + 2) % 3, false}));
  }

  // Whether the line of the hips is vertical, and the body neither stands nor is on a floor.
  [[nodiscard]] bool floats_on_side(const SignedAxis& up) const {
    constexpr double kVertical = 0.8;
    const int left = body_.joint(Bone::kLeftUpLeg), right = body_.joint(Bone::kRightUpLeg);
    if (left < 0 || right < 0) return false;
    Eigen::Vector3d across = Eigen::Vector3d::Zero();
    for (const JointPoses& pose : poses_) {
      across += (pose[left].translation - pose[right].translation).normalized();
    }
    const double vertical = std::abs(across.dot(up.direction()));
    if (!(vertical > kVertical * static_cast<double>(poses_.size()))) return false;
    const FloorEvidence along = floor(up);
    return !along.on_floor() && !along.standing();
  }

  // A common axis with floor evidence that the other axis lacks.
  [[nodiscard]] std::optional<SignedAxis> axis_of_floor(const SignedAxis& other) const {
    for (const SignedAxis& axis : kCommonAxes) {
      if (axis != other && has_floor_rather_than(axis, other)) return axis;
    }
    return std::nullopt;
  }

  [[nodiscard]] UpChoice standing_against(const Declared& declared) const {
    return {guess_.axis,
            fmt::format("{} has {} up, but the body stands on a floor perpendicular to {}: {}",
                        declared.source, to_text(declared.axis), to_text(guess_.axis),
                        taken_text(guess_.axis))};
  }

  // Whether the body, which seems to stand along an axis, may lie or crawl along the other one.
  [[nodiscard]] bool may_lie_along(const SignedAxis& other, const SignedAxis& axis) const {
    const FloorEvidence along = floor(axis), rival = floor(other);
    const bool is_lower = rival.hips < along.hips - kLowerHips;
    if (along.on_floor()) {
      return rival.resting() && is_lower && guess_.certainty < kBeyondDoubt;
    }
    // A clip that was raised has a steady floor at another height.
    if (along.is_steady() && !is_lower) return false;
    return rival.resting() || (along.is_far() && rival.may_rest());
  }

  // A common axis along which the body may lie or crawl instead.
  [[nodiscard]] std::optional<SignedAxis> rival_of(const SignedAxis& axis) const {
    for (const SignedAxis& other : kCommonAxes) {
      if (other != axis && may_lie_along(other, axis)) return other;
    }
    return std::nullopt;
  }

  [[nodiscard]] UpChoice standing_or_lying(const SignedAxis& standing, const SignedAxis& lying,
                                           const SignedAxis& taken) const {
    return {taken,
            fmt::format("the body stands along {} or lies on a floor perpendicular to {}: {}",
                        to_text(standing), to_text(lying), taken_text(taken))};
  }

  [[nodiscard]] bool guesses_common_axis() const {
    return std::ranges::count(kCommonAxes, guess_.axis) > 0;
  }

  // The common axis with a floor, if the body seems to stand along an axis that files rarely use.
  // A body that is clearly upright on a floor there must rest on the other one.
  [[nodiscard]] std::optional<UpChoice> lying_rather(const SignedAxis& known) const {
    if (guesses_common_axis() || known_.of_fall) return std::nullopt;
    const auto lying = may_have_floor(known) ? std::optional(known) : axis_of_floor(known);
    if (!lying) return std::nullopt;
    const bool stands = floor(guess_.axis).on_floor() && guess_.certainty > kBeyondDoubt;
    if (stands && !floor(*lying).resting()) return std::nullopt;
    return standing_or_lying(guess_.axis, *lying, *lying);
  }

  [[nodiscard]] UpChoice moving_against(const Declared& declared, const SignedAxis& other,
                                        const SignedAxis& taken) const {
    return {taken, fmt::format(
                       "{} has {} up, but the body moves on a floor perpendicular to {}: {}",
                       declared.source, to_text(declared.axis), to_text(other), taken_text(taken))};
  }

  // Keeps the declared axis. Adds a warning if the floor is evidence for another axis, or if posture
  // is and no floor shows that the body lies.
  [[nodiscard]] UpChoice keep(const Declared& declared) const {
    const SignedAxis& up = declared.axis;
    const auto kept = [&](const std::string& why) {
      return UpChoice{up, why + ": " + taken_text(up)};
    };
    // Gravity confirms the axis, for example of a body that jumps again and again and therefore
    // seems to climb.
    if (known_.of_fall == up) return {up, {}};
    if (known_.of_fall) {
      return kept(fmt::format("{} has {} up, but the body falls along {}", declared.source,
                              to_text(up), to_text(opposite(*known_.of_fall))));
    }
    if (rises_most_along(up)) {
      return kept(fmt::format("the body climbs along {}, or swims or crawls", to_text(up)));
    }
    const bool agrees = guess_.axis == up, on_floor = floor(up).on_floor();
    const auto rival = agrees || !on_floor ? rival_of(up) : std::nullopt;
    if (rival && on_floor) return standing_or_lying(up, *rival, up);
    if (rival) return moving_against(declared, *rival, up);
    if (agrees && floor(up).standing()) return {up, {}};
    if (const auto other = axis_of_floor(up)) return moving_against(declared, *other, up);
    if (!agrees && is_plain() && !has_floor_rather_than(up, guess_.axis)) {
      return kept(
          fmt::format("trunk and legs point along {}, but {} has {} up, so the body lies or hangs",
                      to_text(guess_.axis), declared.source, to_text(up)));
    }
    if (floats_on_side(up)) {
      return kept(fmt::format("{} has {} up, but then the body lies on its side without a floor",
                              declared.source, to_text(up)));
    }
    return {up, {}};
  }

  [[nodiscard]] UpChoice by_file(const Declared& file) const {
    const bool is_false =
        guess_.axis != file.axis && stands_rather_than(file.axis) && !may_have_floor(file.axis);
    return is_false ? standing_against(file) : keep(file);
  }

  // Whether the body stands along the guessed axis. A body that is on a floor at height 0 along the
  // kind's axis, too, lies or crawls there, unless it falls.
  [[nodiscard]] bool stands_against_kind(const SignedAxis& kind) const {
    return stands_rather_than(kind) && (known_.of_fall || !floor(kind).on_floor());
  }

  // The axis along which the body rests in a file that was rotated away from the kind's axis: the
  // body neither stands nor climbs along that one.
  [[nodiscard]] std::optional<SignedAxis> rotated_axis(const SignedAxis& kind) const {
    const FloorEvidence along = floor(kind);
    const auto other = axis_of_floor(kind);
    if (!other || known_.of_fall || rises_most_along(kind) || along.standing()) return std::nullopt;
    return along.is_far() && floor(*other).resting() ? other : std::nullopt;
  }

  // Converters rotate files, so the floor outweighs the skeleton's kind.
  [[nodiscard]] UpChoice by_kind(const Declared& kind) const {
    if (const auto other = rotated_axis(kind.axis)) return moving_against(kind, *other, *other);
    if (guess_.axis == kind.axis) return keep(kind);
    if (stands_against_kind(kind.axis)) {
      return lying_rather(kind.axis).value_or(standing_against(kind));
    }
    if (is_plain() && has_floor_rather_than(guess_.axis, kind.axis)) return standing_against(kind);
    return keep(kind);
  }

  [[nodiscard]] UpChoice by_zero_pose(const Declared& zero) const {
    const double plainly = guess_.axis.negative ? kPlainlyNegative : kPlainly;
    if (guess_.certainty < kMinCertainty) {
      const bool turned = has_floor_rather_than(guess_.axis, zero.axis);
      const SignedAxis axis = turned ? guess_.axis : zero.axis;
      return {axis, "the body is rarely upright: " + taken_text(axis)};
    }
    if (guess_.axis == zero.axis) return keep(zero);
    const bool is_upright = guess_.certainty >= plainly;
    if (is_upright && stands_rather_than(zero.axis)) {
      if (auto lying = lying_rather(zero.axis)) return *lying;
      if (!floor(zero.axis).resting()) return {guess_.axis, {}};
      return standing_or_lying(guess_.axis, zero.axis, guess_.axis);
    }
    return has_floor_rather_than(guess_.axis, zero.axis) ? standing_against(zero) : keep(zero);
  }

  // Whether the floor shows that a file was rotated from its kind's axis to that of its zero pose.
  [[nodiscard]] bool is_turned(const SignedAxis& kind, const SignedAxis& zero) const {
    return has_floor_rather_than(zero, kind) || climbs_along(floor(kind), floor(zero));
  }

  // Chooses between a file that was rotated as a whole and one whose zero pose has other axes.
  [[nodiscard]] UpChoice between(const Declared& kind, const Declared& zero) const {
    for (const auto& [one, other] : {std::pair(kind, zero), std::pair(zero, kind)}) {
      if (guess_.axis == one.axis && stands_rather_than(other.axis)) return {one.axis, {}};
    }
    const Declared& taken = is_turned(kind.axis, zero.axis) ? zero : kind;
    if (guess_.axis != taken.axis && stands_rather_than(taken.axis)) return standing_against(taken);
    return {taken.axis, fmt::format("{} has {} up, {} {}: {}", kind.source, to_text(kind.axis),
                                    zero.source, to_text(zero.axis), taken_text(taken.axis))};
  }

  // A body that tumbles or dives falls along any of its axes. One that stands is not turned over: a
  // landing in a smoothed recording resembles a fall the other way round.
  [[nodiscard]] UpChoice by_fall(const SignedAxis& up) const {
    if (guess_.axis == up || guess_.certainty < kMinCertainty) return {up, {}};
    const bool stands =
        guess_.axis == opposite(up) && guess_.certainty > kPlainly && floor(guess_.axis).standing();
    const SignedAxis taken = stands ? guess_.axis : up;
    return {taken, fmt::format("trunk and legs point along {}, but the body falls along {}: {}",
                               to_text(guess_.axis), to_text(opposite(up)), taken_text(taken))};
  }

  // Chooses between the guessed axis and a common one along which the body may lie. Only a body that
  // is upright most of the time, on a floor that is much steadier than the other one, certainly
  // stands.
  [[nodiscard]] std::optional<UpChoice> lying_instead() const {
    const FloorEvidence along = floor(guess_.axis);
    const bool squats = guess_.certainty > kMostly && guesses_common_axis() && along.squatting();
    const bool stands = guesses_common_axis() && along.standing() && guess_.certainty > kMostly &&
                        (along.on_floor() || along.on_slope());
    const bool is_upright = stands && along.on_floor() && guess_.certainty > kBeyondDoubt;
    for (const SignedAxis& other : kCommonAxes) {
      const FloorEvidence rival = floor(other);
      if (other.axis == guess_.axis.axis || !rival.may_rest()) continue;
      if (rival.hips > along.hips - kLowerHips) continue;
      if (stands && along.is_steadier_than(rival)) continue;
      const bool is_convention = guess_.axis == SignedAxis{};
      const bool stays =
          squats || ((is_convention || is_upright) && !along.sinks_rather_than(rival));
      return standing_or_lying(guess_.axis, other, stays ? guess_.axis : other);
    }
    return std::nullopt;
  }

  [[nodiscard]] UpChoice by_movement() const {
    if (known_.of_fall) return by_fall(*known_.of_fall);
    UpChoice choice{guess_.axis, {}};
    if (guess_.certainty < kMinCertainty) {
      choice.doubt = "the body is rarely upright: " + taken_text(choice.axis);
      return choice;
    }
    if (auto lying = lying_instead()) return *std::move(lying);
    const FloorEvidence upright = floor(guess_.axis);
    if (upright.on_floor()) return choice;
    const auto other = axis_of_floor(guess_.axis);
    // A centred motion has no floor.
    if (!other || !floor(*other).is_placed) return doubt_travel(choice, upright);
    if (clearly_stands(upright, floor(*other))) return choice;
    // Of two axes, y is the convention.
    if (guess_.axis != SignedAxis{}) choice.axis = *other;
    return standing_or_lying(guess_.axis, *other, choice.axis);
  }

  // A body that moves head first without standing swims or crawls. A centred one does not move.
  [[nodiscard]] UpChoice doubt_travel(UpChoice choice, const FloorEvidence& upright) const {
    if (upright.standing() || !upright.is_placed) return choice;
    for (const SignedAxis& other : kCommonAxes) {
      if (other.axis == choice.axis.axis || !climbs_along(upright, floor(other))) continue;
      choice.doubt = fmt::format("the body climbs along {}, or swims or crawls: {}",
                                 to_text(choice.axis), taken_text(choice.axis));
    }
    return choice;
  }

  const Body& body_;
  const std::vector<JointPoses>& poses_;
  const KnownUp& known_;
  const UpGuess guess_;
};

}  // namespace

UpChoice choose_up(const Body& body, const std::vector<JointPoses>& poses, const KnownUp& known) {
  if (!poses.empty()) return UpChooser(body, poses, known).choose();
  for (const auto& axis : {known.of_file, known.of_kind, known.of_zero_pose}) {
    if (axis) return {*axis, {}};
  }
  return {};
}

}  // namespace retarget
