#include "human/gait/noisy_stances.h"

#include <algorithm>
#include <cmath>

#include "human/gait/contact_plan.h"
#include "retarget/human.h"
#include "retarget/statistics.h"

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

// Whether the hips are high above the standing height of toes.
bool is_upright(const SourceFeet& feet, double toe_height, double scale, int frame) {
  constexpr double kHips = 0.3;  // Metres.
  if (feet.hips.empty()) return false;
  return feet.hips[static_cast<std::size_t>(frame)] - toe_height > kHips * scale;
}

// Heights of standing heels and toes, metres. The lowest feet of a noisy clip are lower than those
// that stand: starts at their height and moves to the median of slow ends within kReach until it
// stays the same.
std::array<double, 2> noisy_standing_heights(const SourceFeet& feet, const ContactOptions& options,
                                             double scale) {
  constexpr double kReach = 0.08;  // Metres; steps and boxes are higher.
  constexpr int kMostMoves = 20;
  const StandingHeights lowest = find_standing_heights(feet, options);
  std::array<double, 2> heights{};
  std::vector<double> near;
  for (const int end : {kHeelEnd, kToeEnd}) {
    double& height = heights[static_cast<std::size_t>(end)];
    height = lowest.of(end);
    for (int i = 0; i < kMostMoves; ++i) {
      near.clear();
      for (int frame = 0; frame < feet.frame_count(); ++frame) {
        if (!is_upright(feet, lowest.of(kToeEnd), scale, frame)) continue;
        for (int foot = 0; foot < feet.foot_count; ++foot) {
          const double z = feet.at(frame, foot).end(end).z();
          if (std::abs(z - height) < kReach * scale &&
              feet.speed(frame, foot, end) < options.begin_speed * scale) {
            near.push_back(z);
          }
        }
      }
      const double before = height;
      if (!near.empty()) height = median_in_place(near);
      if (height == before) break;
    }
  }
  return heights;
}

}  // namespace

NoisyStances find_noisy_stances(const SourceFeet& feet, double noise_speed) {
  constexpr double kChangeTime = 0.1;  // Seconds.
  constexpr double kUnsupported = 1.5;
  const double scale = feet.leg_length() / kUsualSourceLeg;
  const EvenOdds even = EvenOdds::of(noise_speed);
  ContactOptions options;
  options.begin_speed = even.speed;
  options.end_speed = even.speed;
  const std::array<double, 2> standing = noisy_standing_heights(feet, options, scale);
  std::vector<EndScores> scores(static_cast<std::size_t>(feet.frame_count()));
  std::vector<double> unsupported;
  for (int frame = 0; frame < feet.frame_count(); ++frame) {
    // Upright bodies rarely fly.
    unsupported.push_back(is_upright(feet, standing[kToeEnd], scale, frame) ? kUnsupported : 0.0);
    for (int foot = 0; foot < feet.foot_count; ++foot) {
      for (const int end : {kHeelEnd, kToeEnd}) {
        const double height =
            feet.at(frame, foot).end(end).z() - standing[static_cast<std::size_t>(end)];
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
