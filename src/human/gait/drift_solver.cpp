// Finds the drift of a root that makes standing feet stand.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "base/math/banded_system.h"
#include "human/gait/drift_travel.h"
#include "human/gait/end_tracks.h"
#include "human/gait/planted_parts.h"
#include "human/gait/root_drift.h"
#include "human/gait/stance_likelihood.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

double square(double x) {
  return x * x;
}

// Iteratively reweighted least squares.
class DriftSolver {
 public:
  DriftSolver(const SourceFeet& feet, const std::vector<Vector3d>& hips, DriftRule rule)
      : tracks_(feet),
        parts_(feet, tracks_, hips),
        vertical_(rule.vertical),
        climbs_(rule.climbs),
        wander_(rule.wander),
        rate_(1.0 / tracks_.frame_time),
        step_((rule.jittery ? 0.15 : 0.05) * tracks_.frame_time),
        drift_(tracks_.count, Vector3d::Zero()) {
    for (const Vector3d& place : hips) hips_.push_back(place / tracks_.scale);
    // Turning speed above which a foot hardly stands, m/s.
    const double turning = rule.jittery ? 0.2 : 0.12;
    stands_ = stance_likelihood(tracks_, frames_in_free_fall(feet, tracks_), parts_, turning);
    constexpr double kOneLevel = 0.15;  // Metres.
    on_levels_ = parts_.root_speed() > 0.0 && spread_of_stances() > kOneLevel;
  }

  RootDrift solve() {
    find_common_steps();
    iterate();
    if (vertical_ && !climbs_ && climbs_now()) solve_with_level_stances();
    RootDrift result;
    if (vertical_ && tilts_floor()) {
      for (Vector3d& drift : drift_) {
        result.discarded_heights.push_back(drift.z() * tracks_.scale);
        drift.z() = 0.0;
      }
      // The rest must calm the feet on its own.
      measured_ = Vector3d(1.0, 1.0, 0.0);
    }
    result.speed_after = speed_of_stances() * tracks_.scale;
    result.climb_after = climb_of_stances() * tracks_.scale;
    if (wander_ > 0.0) keep_travel(drift_, wander_, tracks_.frame_time);
    result.speed_left = speed_of_stances() * tracks_.scale;
    without_drift([&] {
      result.speed_before = speed_of_stances() * tracks_.scale;
      result.climb_before = climb_of_stances() * tracks_.scale;
    });
    const Vector3d middle = middle_of_drift();
    for (const Vector3d& drift : drift_) {
      result.drift.push_back(drift * tracks_.scale);
      result.farthest = std::max(result.farthest, (drift - middle).norm() * tracks_.scale);
    }
    return result;
  }

 private:
  void iterate() {
    // Distance from the common level, in metres, at which a stance weighs a quarter; 0: ignore the
    // level.
    constexpr std::array kGates = {0.0, 0.0, 0.3, 0.2, 0.12, 0.08, 0.08};
    is_first_ = true;
    for (const double gate : kGates) {
      weigh_steps();
      for (int axis = 0; axis < (vertical_ ? 3 : 2); ++axis) solve_axis(axis, gate);
      is_first_ = false;
      if (levels_) rolling_.z() -= added_climb();
    }
  }

  // Climb of the stances that the correction adds, per step. A body on several levels may climb in
  // truth; on one level, all of the climb is an error.
  [[nodiscard]] double added_climb() {
    double before = 0.0;
    if (on_levels_) without_drift([&] { before = climb_of_level(); });
    return climb_of_level() - before;
  }

  [[nodiscard]] bool climbs_now() {
    return std::abs(added_climb()) * static_cast<double>(tracks_.count) > kClimb;
  }

  // Feet that roll sink, or rise, alike in all stances, and the root does not. Finds the step with
  // which the correction adds no climb, starting at the median, which is inexact in a short clip with
  // noise. A box on which the body steps remains far from the other stances.
  void solve_with_level_stances() {
    constexpr double kMuchNearer = 0.5;
    const double spread = spread_of_stances();
    std::vector<Vector3d> drift(tracks_.count, Vector3d::Zero());
    drift_.swap(drift);
    const double climb = median_climb();
    if (std::abs(climb) * rate_ > kClimbSpeed) rolling_.z() = climb;
    levels_ = true;
    find_common_steps();
    iterate();
    levels_ = false;
    if (spread_of_stances() < kMuchNearer * spread) return;
    drift_.swap(drift);
    rolling_.setZero();
  }

  [[nodiscard]] Vector3d step(int end, std::size_t i) const {
    return tracks_.places[end][i + 1] - tracks_.places[end][i];
  }
  // The part of a step that the root may cause.
  [[nodiscard]] Vector3d step_of_root(int end, std::size_t i) const {
    return step(end, i) - rolling_;
  }
  [[nodiscard]] double stands(int end, std::size_t i) const {
    return std::min(stands_[end][i], stands_[end][i + 1]);
  }

  // Common step of the standing ends, and its RMS change from frame to frame.
  void find_common_steps() {
    common_.clear();
    constexpr double kSure = 0.8, kLeastChange = 0.5;  // m/s^2
    Vector3d squares = Vector3d::Zero();
    double product = 0.0;  // Of the horizontal components.
    int changes = 0;
    bool was_sure = false;
    for (std::size_t i = 0; i + 1 < tracks_.count; ++i) {
      Vector3d sum = Vector3d::Zero();
      double weight = 0.0;
      for (int end = 0; end < kEndCount; ++end) {
        sum += stands(end, i) * step_of_root(end, i);
        weight += stands(end, i);
      }
      common_.push_back(sum / std::max(weight, 1e-9));
      const bool sure = weight > kSure;
      if (sure && was_sure) {
        const Vector3d change = common_[i] - common_[i - 1];
        squares += change.cwiseAbs2();
        product += change.x() * change.y();
        ++changes;
      }
      was_sure = sure;
    }
    const double least = kLeastChange * square(tracks_.frame_time);
    if (changes > 0) {
      squares /= changes;
      product /= changes;
    }
    find_axes(product, squares);
    change_ = squares.cwiseSqrt().cwiseMax(least);
  }

  // Horizontally the geometric median, which turns with the world.
  [[nodiscard]] Vector3d middle_of_drift() const {
    constexpr int kPasses = 30;
    constexpr double kNear = 1e-3;  // Metres.
    Vector3d middle = Vector3d::Zero();
    for (const Vector3d& drift : drift_) middle += drift / static_cast<double>(drift_.size());
    for (int pass = 0; pass < kPasses; ++pass) {
      Vector3d sum = Vector3d::Zero();
      double weights = 0.0;
      for (const Vector3d& drift : drift_) {
        const double weight = 1.0 / std::max(kNear, (drift - middle).head<2>().norm());
        sum += weight * drift;
        weights += weight;
      }
      middle = sum / weights;
    }
    std::vector<double> heights;
    for (const Vector3d& drift : drift_) heights.push_back(drift.z());
    middle.z() = median(heights);
    return middle;
  }

  // The horizontal axes in which the changes are uncorrelated: they turn with the world.
  // @param squares  mean squares of the changes along x, y and z; then along axes_
  void find_axes(double product, Vector3d& squares) {
    const double middle = 0.5 * (squares.x() + squares.y());
    const double half = 0.5 * (squares.x() - squares.y());
    const double apart = std::sqrt(half * half + product * product);
    axes_.setIdentity();
    if (!(apart > 0.0)) return;
    const double cosine = std::sqrt(std::max(0.0, 0.5 * (1.0 + half / apart)));
    const double sine =
        std::copysign(std::sqrt(std::max(0.0, 0.5 * (1.0 - half / apart))), product);
    axes_.col(0) = Vector3d(cosine, sine, 0.0);
    axes_.col(1) = Vector3d(-sine, cosine, 0.0);
    squares.head<2>() << middle + apart, std::max(0.0, middle - apart);
  }

  template <typename Measure>
  void without_drift(const Measure& measure) {
    std::vector<Vector3d> drift(tracks_.count, Vector3d::Zero());
    drift_.swap(drift);
    measure();
    drift_.swap(drift);
  }

  // Whether the stances are nearer to one level before the correction. In a few seconds of a large
  // drift that also happens by chance, but the correction then stops the feet, and they are not
  // much nearer.
  [[nodiscard]] bool tilts_floor() {
    constexpr double kWorse = 0.01;  // Metres.
    constexpr double kStops = 0.2;   // Share of the vertical speed.
    constexpr double kMuchWorse = 4.0;
    double before = 0.0, moving = 0.0;
    without_drift([&] {
      before = spread_of_stances();
      moving = vertical_speed_of_stances();
    });
    const double spread = spread_of_stances();
    if (!(spread > before + kWorse)) return false;
    return spread > kMuchWorse * (before + kWorse) || vertical_speed_of_stances() > kStops * moving;
  }

  // Reduces the weight of ends that move differently from the solution: they do not stand.
  void weigh_steps() {
    constexpr double kFirstWidth = 0.5, kWidth = 0.2;  // m/s
    for (int end = 0; end < kEndCount; ++end) {
      weights_[end].resize(tracks_.count - 1);
      for (std::size_t i = 0; i + 1 < tracks_.count; ++i) {
        const Vector3d expected = is_first_ ? common_[i] : Vector3d(drift_[i + 1] - drift_[i]);
        const double off = (step_of_root(end, i) - expected).norm() * rate_;
        weights_[end][i] = stands(end, i) * (is_first_ ? 1.0 / (1.0 + square(off / kFirstWidth))
                                                       : cauchy(off / kWidth));
      }
    }
  }

  void solve_axis(int axis, double gate) {
    // Acceleration of the hips in m/s^2, and root offset in metres over about a second.
    constexpr double kHipsChange = 6.0, kAside = 0.15, kUpward = 0.5;
    const Vector3d along = axes_.col(axis);
    PentadiagonalFit fit(tracks_.count);
    const double hips = 1.0 / square(kHipsChange * square(tracks_.frame_time));
    const double smooth = 1.0 / square(change_[axis]);
    for (std::size_t i = 0; i + 2 < tracks_.count; ++i) {
      const double bend = along.dot(hips_[i] - 2.0 * hips_[i + 1] + hips_[i + 2]);
      fit.add_second_difference(i, hips, bend);
      fit.add_second_difference(i, smooth, 0.0);
    }
    const double near = 1.0 / (square(axis < 2 ? kAside : kUpward) * rate_);
    for (std::size_t i = 0; i < tracks_.count; ++i) fit.add_value(i, near, 0.0);
    for (int end = 0; end < kEndCount; ++end) {
      for (std::size_t i = 0; i + 1 < tracks_.count; ++i) {
        fit.add_difference(i, weights_[end][i] / square(step_), along.dot(step_of_root(end, i)));
      }
    }
    add_rest(axis, fit);
    if (axis == 2 && gate > 0.0) add_level(gate, fit);
    const std::vector<double> solved = fit.solve();
    for (std::size_t i = 0; i < tracks_.count; ++i) {
      drift_[i] += (solved[i] - along.dot(drift_[i])) * along;
    }
  }

  // Where nothing stands, the root hardly drifts faster than the planted parts show.
  void add_rest(int axis, PentadiagonalFit& fit) const {
    constexpr double kRarely = 3.0;  // Usual speeds.
    if (!(parts_.root_speed() > 0.0)) return;
    const double slow = kRarely * parts_.root_speed() * tracks_.frame_time;
    const double weight = 1.0 / (square(slow) + square(change_[axis]));
    for (std::size_t i = 0; i + 1 < tracks_.count; ++i) {
      double most = 0.0;
      for (const std::vector<double>& weights : weights_) most = std::max(most, weights[i]);
      fit.add_difference(i, weight * (1.0 - most), 0.0);
    }
  }

  // Pulls stances to one level, except those far from it, such as on a step or a box.
  void add_level(double gate, PentadiagonalFit& fit) const {
    constexpr double kSpread = 0.03, kTime = 0.3;  // Spread in metres of stances of this duration.
    constexpr double kLeastGate = 0.08;            // Metres.
    constexpr double kLongest = 1.0;               // Seconds.
    constexpr double kFar = 2.0;                   // Gates.
    // A drift that is known to be slow does not separate the levels.
    if (on_levels_) gate = std::min(gate, std::max(kLeastGate, parts_.root_speed() * kLongest));
    const std::vector<double> standing = heights_of_stances(0, tracks_.count);
    if (standing.empty()) return;
    const double level = median(standing);
    const double weight = 1.0 / (square(kSpread) * kTime * rate_);
    for (int end = 0; end < kEndCount; ++end) {
      for (std::size_t i = 0; i < tracks_.count; ++i) {
        const double height = tracks_.heights[end][i];
        const double off = (height - drift_[i].z() - level) / gate;
        if (on_levels_ && std::abs(off) > kFar) continue;
        const double stands = weights_[end][std::min(i, tracks_.count - 2)];
        fit.add_value(i, weight * stands * cauchy(off), height - level);
      }
    }
  }

  // Median over the steps of standing ends.
  // @param measure  measure of a step, from Vector3d
  template <typename Measure>
  [[nodiscard]] double median_of_stances(const Measure& measure) const {
    std::vector<double> values;
    for (int end = 0; end < kEndCount; ++end) {
      for (std::size_t i = 0; i + 1 < tracks_.count; ++i) {
        if (stands(end, i) < 0.5) continue;
        values.push_back(measure(Vector3d(step_of_root(end, i) - drift_[i + 1] + drift_[i])));
      }
    }
    return values.empty() ? 0.0 : median(values);
  }

  // Heights of the standing ends in frames [begin, end), without the drift.
  [[nodiscard]] std::vector<double> heights_of_stances(std::size_t begin, std::size_t end) const {
    std::vector<double> standing;
    for (int foot_end = 0; foot_end < kEndCount; ++foot_end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (!(stands_[foot_end][i] > 0.5)) continue;
        standing.push_back(tracks_.heights[foot_end][i] - drift_[i].z());
      }
    }
    return standing;
  }

  // Climb of the stances without the drift from the first to the last third of the clip, per step.
  [[nodiscard]] double climb_of_level() const {
    const std::size_t third = tracks_.count / 3;
    const auto first = heights_of_stances(0, third);
    const auto last = heights_of_stances(tracks_.count - third, tracks_.count);
    if (first.empty() || last.empty()) return 0.0;
    return (median(last) - median(first)) / static_cast<double>(tracks_.count - third);
  }

  // Height difference that contains most of the standing ends, metres.
  [[nodiscard]] double spread_of_stances() const {
    const std::vector<double> heights = heights_of_stances(0, tracks_.count);
    return heights.empty() ? 0.0 : percentile(heights, 90.0) - percentile(heights, 10.0);
  }

  [[nodiscard]] double speed_of_stances() const {
    return median_of_stances(
        [&](const Vector3d& step) { return step.cwiseProduct(measured_).norm() * rate_; });
  }
  [[nodiscard]] double vertical_speed_of_stances() const {
    return median_of_stances([&](const Vector3d& step) { return std::abs(step.z()) * rate_; });
  }

  // Per step.
  [[nodiscard]] double median_climb() const {
    return median_of_stances([](const Vector3d& step) { return step.z(); });
  }

  [[nodiscard]] double climb_of_stances() const {
    return median_climb() * static_cast<double>(tracks_.count);
  }

  static double cauchy(double x) { return 1.0 / square(1.0 + x * x); }

  EndTracks tracks_;
  PlantedParts parts_;
  bool vertical_, climbs_;
  double wander_;           // Metres; 0: the root drifts for certain.
  bool on_levels_ = false;  // Whether the stances are on several levels without the drift.
  bool levels_ = false;     // Whether rolling_ follows the climb that the correction adds.
  double rate_;
  double step_;                           // Movement of a standing end per frame, metres.
  Vector3d rolling_ = Vector3d::Zero();   // Step of standing feet that roll.
  Vector3d measured_ = Vector3d::Ones();  // Axes of the measured speed: 1, others: 0.
  std::vector<Vector3d> drift_, hips_, common_;
  Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();  // Columns; the last is vertical.
  Vector3d change_ = Vector3d::Zero();  // RMS of the drift's second differences along axes_.
  std::array<std::vector<double>, kEndCount> stands_, weights_;
  bool is_first_ = true;
};

}  // namespace

RootDrift find_root_drift(const SourceFeet& feet, const std::vector<Vector3d>& hips,
                          DriftRule rule) {
  if (!has_whole_feet(feet)) return {};
  return DriftSolver(feet, hips, rule).solve();
}

}  // namespace retarget
