#include "judge/quality/lag_metric.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace retarget {
namespace {

using Eigen::Vector3d;
using Rates = std::vector<std::vector<Vector3d>>;  // By limb and frame.

// Rate of change of the unit vectors along a limb, 1/s.
std::vector<Vector3d> turning(const std::vector<Vector3d>& directions, double fps) {
  std::vector<Vector3d> rates;
  rates.reserve(directions.size());
  for (std::size_t i = 1; i < directions.size(); ++i) {
    rates.push_back(fps *
                    (directions[i].stableNormalized() - directions[i - 1].stableNormalized()));
  }
  return rates;
}

// Correlation of the robot's rates with the human's `lag` frames earlier, where both exist.
double correlation(const Rates& robot, const Rates& human, int lag) {
  double both = 0.0, of_robot = 0.0, of_human = 0.0;
  for (std::size_t limb = 0; limb < robot.size(); ++limb) {
    const int frames = static_cast<int>(robot[limb].size());
    for (int frame = std::max(lag, 0); frame < frames + std::min(lag, 0); ++frame) {
      const Vector3d& have = robot[limb][static_cast<std::size_t>(frame)];
      const Vector3d& want = human[limb][static_cast<std::size_t>(frame - lag)];
      both += have.dot(want);
      of_robot += have.squaredNorm();
      of_human += want.squaredNorm();
    }
  }
  const double size = std::sqrt(of_robot * of_human);
  return size > 0.0 ? both / size : 0.0;
}

// Root mean square, 1/s.
double mean_rate(const Rates& rates) {
  double sum = 0.0, count = 0.0;
  for (const auto& limb : rates) {
    for (const Vector3d& rate : limb) sum += rate.squaredNorm();
    count += static_cast<double>(limb.size());
  }
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

// The highest peak; among nearly equal peaks the one nearest to 0, because periodic motion has
// several.
int best_lag(const std::vector<double>& correlations, int reach) {
  constexpr double kNearlyAsHigh = 0.02;
  const auto at = [&](int lag) { return correlations[static_cast<std::size_t>(lag + reach)]; };
  const double highest = *std::max_element(correlations.begin(), correlations.end());
  for (int away = 0; away < reach; ++away) {
    for (const int lag : {away, -away}) {
      const bool peak = at(lag) >= at(lag - 1) && at(lag) >= at(lag + 1);
      if (peak && at(lag) >= highest - kNearlyAsHigh) return lag;
    }
  }
  return at(reach) >= at(-reach) ? reach : -reach;
}

}  // namespace

std::optional<double> limb_lag(const std::vector<LimbDirections>& limbs, double fps) {
  constexpr double kReach = 0.5, kShortest = 1.0;  // seconds
  constexpr double kStill = 0.05;                  // rad/s
  constexpr double kAlike = 0.3;                   // Minimum correlation.
  if (limbs.empty() || static_cast<double>(limbs.front().human.size()) < kShortest * fps) {
    return std::nullopt;
  }
  Rates robot, human;
  for (const LimbDirections& limb : limbs) {
    robot.push_back(turning(limb.robot, fps));
    human.push_back(turning(limb.human, fps));
  }
  if (mean_rate(human) < kStill) return std::nullopt;
  const int reach = std::max(1, static_cast<int>(std::lround(kReach * fps)));
  std::vector<double> correlations;
  for (int lag = -reach; lag <= reach; ++lag) {
    correlations.push_back(correlation(robot, human, lag));
  }
  const int lag = best_lag(correlations, reach);
  const auto at = static_cast<std::size_t>(lag + reach);
  if (!(correlations[at] >= kAlike)) return std::nullopt;
  if (std::abs(lag) == reach) return lag / fps;
  // Vertex of the parabola through three values.
  const double before = correlations[at - 1], after = correlations[at + 1];
  const double bend = before - 2.0 * correlations[at] + after;
  const double part = bend < 0.0 ? 0.5 * (before - after) / bend : 0.0;
  return (lag + part) / fps;
}

}  // namespace retarget
