#include "human/gait/noisy_stances.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "human/gait/contact_plan.h"

namespace retarget {
namespace {

// Speed in m/s and height in metres at which an end stands as likely as it swings.
struct EvenOdds {
  double speed, height;

  // Speeds of noise rarely exceed twice their median. Feet that pass each other in walking are
  // faster than kFastest.
  static EvenOdds of(double noise_speed) {
    constexpr double kSlowest = 0.15, kFastest = 0.8, kShare = 2.2;
    constexpr double kLow = 0.05, kRise = 0.08;  // Metres, and metres per m/s.
    return {std::min(kSlowest + kShare * noise_speed, kFastest),
            kLow + kRise * std::min(noise_speed, kFastest)};
  }
};

// Evidence in a frame: 1 for a certain stance; the least value limits the effect of outliers.
double evidence(double share_of_even) {
  constexpr double kLeast = -3.0;
  return std::max(1.0 - share_of_even * share_of_even, kLeast);
}

// Each state is a set of ends that stand, as a bit mask.
constexpr std::size_t kStateCount = 16;
using EndScores = std::array<double, 4>;

int changes_between(std::size_t from, std::size_t to) {
  int count = 0;
  for (std::size_t changed = from ^ to; changed != 0; changed &= changed - 1) ++count;
  return count;
}

double score_of(std::size_t state, const EndScores& scores, double unsupported) {
  if (state == 0) return -unsupported;
  double sum = 0.0;
  for (std::size_t end = 0; end < scores.size(); ++end) {
    if ((state >> end & 1U) != 0) sum += scores[end];
  }
  return sum;
}

// The sequence of states that maximises the sum of the scores of ends that stand, minus the cost of
// each change of an end and of frames in which nothing supports the body (Viterbi's algorithm).
std::vector<std::size_t> likeliest(const std::vector<EndScores>& scores,
                                   const std::vector<double>& unsupported, double change_cost) {
  std::vector<std::array<std::size_t, kStateCount>> came_from(scores.size());
  std::array<double, kStateCount> best{};
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const std::array<double, kStateCount> before = best;
    for (std::size_t state = 0; state < kStateCount; ++state) {
      std::size_t from = state;
      for (std::size_t other = 0; other < kStateCount; ++other) {
        const double cost =
            change_cost * (changes_between(other, state) - changes_between(from, state));
        if (before[other] - cost > before[from]) from = other;
      }
      came_from[i][state] = from;
      best[state] = before[from] - change_cost * changes_between(from, state) +
                    score_of(state, scores[i], unsupported[i]);
    }
  }
  std::vector<std::size_t> states(scores.size());
  auto state = static_cast<std::size_t>(std::ranges::max_element(best) - best.begin());
  for (std::size_t i = scores.size(); i-- > 0;) {
    states[i] = state;
    state = came_from[i][state];
  }
  return states;
}

// Penalty on frames in which no foot stands: upright bodies rarely fly.
double unsupported_penalty(const SourceFeet& feet, const StandingHeights& standing, double scale,
                           int frame) {
  constexpr double kPenalty = 1.5, kHips = 0.3;  // Metres.
  if (feet.hips.empty()) return 0.0;
  const double hips = feet.hips[static_cast<std::size_t>(frame)] - standing.of(kToeEnd);
  return hips > kHips * scale ? kPenalty : 0.0;
}

}  // namespace

NoisyStances find_noisy_stances(const SourceFeet& feet, double noise_speed) {
  constexpr double kChangeTime = 0.1;  // Seconds.
  const double scale = feet.leg_length() / kUsualSourceLeg;
  const EvenOdds even = EvenOdds::of(noise_speed);
  ContactOptions options;
  options.begin_speed = even.speed;
  options.end_speed = even.speed;
  const StandingHeights standing = find_standing_heights(feet, options);
  std::vector<EndScores> scores(static_cast<std::size_t>(feet.frame_count()));
  std::vector<double> unsupported;
  for (int frame = 0; frame < feet.frame_count(); ++frame) {
    unsupported.push_back(unsupported_penalty(feet, standing, scale, frame));
    for (int foot = 0; foot < feet.foot_count; ++foot) {
      for (const int end : {kHeelEnd, kToeEnd}) {
        const double height = feet.at(frame, foot).end(end).z() - standing.of(end);
        scores[static_cast<std::size_t>(frame)][stance_index(foot, end)] =
            evidence(feet.speed(frame, foot, end) / (scale * even.speed)) +
            std::min(0.0, evidence(std::max(0.0, height) / (scale * even.height)));
      }
    }
  }
  NoisyStances stances;
  for (const std::size_t state : likeliest(scores, unsupported, kChangeTime / feet.frame_time)) {
    for (std::size_t end = 0; end < stances.size(); ++end) {
      stances[end].push_back(static_cast<char>(state >> end & 1U));
    }
  }
  return stances;
}

}  // namespace retarget
