#include "human/gait/travel.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "human/gait/body_joint.h"
#include "human/gait/frame_runs.h"
#include "human/gait/limb_mover.h"
#include "human/gait/source_feet.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"
#include "retarget/spline.h"

namespace retarget {
namespace {

using Eigen::Vector2d;
using GroundTrack = std::vector<Vector2d>;

constexpr double kAverage = 1.5;     // Seconds over which a speed is averaged.
constexpr double kSupported = 0.5;   // Seconds around contacts of hands, knees and the trunk.
constexpr double kLongSwing = 1.0;   // Seconds; a longer swing follows the body.
constexpr double kFade = 0.5;        // Seconds at either end of a long swing.
constexpr double kNoOffset = 1e-12;  // Metres.

std::size_t at(int frame) {
  return static_cast<std::size_t>(frame);
}

// Speeds of a path over the ground, m/s: means with biweight weights.
std::vector<double> speeds_of(const GroundTrack& path, double frame_time) {
  const int count = static_cast<int>(path.size());
  const int half = frames_in(0.5 * kAverage, frame_time);
  std::vector<double> weights;
  for (int i = 0; i < half; ++i) {
    const double u = (i + 0.5) / half, left = 1.0 - u * u;
    weights.push_back(left * left);
  }
  std::vector<double> speeds;
  for (int frame = 0; frame < count; ++frame) {
    Vector2d moved = Vector2d::Zero();
    double sum = 0.0;
    // Step i is from frame i to frame i + 1.
    for (int step = std::max(frame - half, 0); step < std::min(frame + half, count - 1); ++step) {
      const double weight = weights[at(step < frame ? frame - 1 - step : step - frame)];
      moved += weight * (path[at(step + 1)] - path[at(step)]);
      sum += weight;
    }
    speeds.push_back(sum > 0.0 ? moved.norm() / (sum * frame_time) : 0.0);
  }
  return speeds;
}

// By frame: seconds to the nearest frame in which parts of the body other than feet carry weight.
std::vector<double> seconds_to_support(const ContactPlan& contacts, int count, double frame_time) {
  std::vector<double> seconds(at(count), std::numeric_limits<double>::infinity());
  for (const auto& phases : contacts.bodies) {
    for (const ContactPhase& phase : phases) {
      for (int i = phase.begin; i < phase.end; ++i) seconds[at(i)] = 0.0;
    }
  }
  for (int i = 1; i < count; ++i) {
    seconds[at(i)] = std::min(seconds[at(i)], seconds[at(i - 1)] + frame_time);
  }
  for (int i = count - 2; i >= 0; --i) {
    seconds[at(i)] = std::min(seconds[at(i)], seconds[at(i + 1)] + frame_time);
  }
  return seconds;
}

Vector2d mean_of(const GroundTrack& track, const FrameRange& range) {
  Vector2d sum = Vector2d::Zero();
  for (int i = range.begin; i < range.end; ++i) sum += track[at(i)];
  return sum / (range.end - range.begin);
}

// Displacements of a foot: constant in its stances, smooth between them.
GroundTrack foot_offsets(const GroundTrack& body, const std::vector<FrameRange>& stances,
                         double frame_time) {
  const int count = static_cast<int>(body.size()), fade = frames_in(kFade, frame_time);
  GroundTrack offsets = body;
  // Adds a share of the difference between a stance and the body.
  const auto pull = [&](const Vector2d& stance, int frame, double share) {
    offsets[at(frame)] += share * (stance - body[at(frame)]);
  };
  int last = 0;  // End of the previous stance.
  std::optional<Vector2d> before;
  const auto fill_swing = [&](int end, const std::optional<Vector2d>& after) {
    const bool is_short = before && after && end - last <= frames_in(kLongSwing, frame_time);
    const int length = is_short ? end - last + 1 : fade;
    for (int i = last; i < end; ++i) {
      if (before) pull(*before, i, 1.0 - quintic_step(double(i - last + 1) / length));
      if (after) pull(*after, i, quintic_step(1.0 - double(end - i) / length));
    }
  };
  for (const FrameRange& stance : stances) {
    const Vector2d place = mean_of(body, stance);
    fill_swing(stance.begin, place);
    for (int i = stance.begin; i < stance.end; ++i) offsets[at(i)] = place;
    before = place;
    last = stance.end;
  }
  fill_swing(count, std::nullopt);
  return offsets;
}

class TravelScaler {
 public:
  TravelScaler(Clip& clip, int first, FrameRange part, const Calibration& calibration,
               const TravelRule& rule, const ContactOptions& options)
      : clip_(clip),
        first_(std::min(first, part.begin)),
        part_(part),
        calibration_(calibration),
        rule_(rule),
        options_(options) {}

  TravelReport run() {
    const int moved = body_joint(clip_.skeleton(), calibration_);
    if (moved < 0 || part_.end <= part_.begin) return {};
    read_human();
    find_factors();
    if (std::ranges::all_of(factors_, [](double factor) { return factor == 1.0; })) return {};
    find_offsets();
    move(moved);
    return report();
  }

 private:
  [[nodiscard]] int count() const { return clip_.frame_count() - first_; }
  [[nodiscard]] double frame_time() const { return clip_.rate().frame_time(); }

  void read_human() {
    const auto [feet, hips] = feet_and_hips(clip_, calibration_, {first_, clip_.frame_count()});
    for (const Eigen::Vector3d& place : hips) path_.emplace_back(place.head<2>());
    if (feet.foot_count > 0) contacts_ = find_contacts(feet, options_);
  }

  void find_factors() {
    const std::vector<double> speeds = speeds_of(path_, frame_time());
    const std::vector<double> away = seconds_to_support(contacts_, count(), frame_time());
    for (int i = 0; i < count(); ++i) {
      const double free = smooth_step(0.0, kSupported, away[at(i)]);
      factors_.push_back(1.0 + free * (rule_.factor(speeds[at(i)]) - 1.0));
    }
  }

  // Mean factor of the step from a frame to the next one.
  [[nodiscard]] double step_factor(int i) const {
    return 0.5 * (factors_[at(i)] + factors_[at(i + 1)]);
  }

  void find_offsets() {
    body_ = {Vector2d::Zero()};
    for (int i = 0; i + 1 < count(); ++i) {
      body_.emplace_back(body_.back() + (step_factor(i) - 1.0) * (path_[at(i + 1)] - path_[at(i)]));
    }
    const Vector2d start = body_[at(part_.begin - first_)];
    for (Vector2d& offset : body_) offset -= start;
    for (int foot = 0; foot < 2; ++foot) {
      feet_[at(foot)] =
          foot_offsets(body_, foot_stances(contacts_, foot, count(), frame_time()), frame_time());
    }
  }

  void move(int moved) {
    const auto legs = find_legs(clip_.skeleton(), calibration_);
    std::array<std::optional<LimbMover>, 2> movers;
    for (std::size_t foot = 0; foot < 2; ++foot) {
      if (!legs[foot]) continue;
      movers[foot].emplace(clip_, calibration_, *legs[foot],
                           side_bone(kSides[foot], LimbBone::kLeg));
    }
    for (int frame = first_; frame < clip_.frame_count(); ++frame) {
      const Vector2d& body = body_[at(frame - first_)];
      if (body.norm() > kNoOffset) {
        move_body(clip_, frame, calibration_, moved, {body.x(), body.y(), 0.0});
      }
      for (std::size_t foot = 0; foot < 2; ++foot) {
        const Vector2d off = feet_[foot][at(frame - first_)] - body;
        if (!movers[foot] || !(off.norm() > kNoOffset)) continue;
        movers[foot]->move_end(clip_, frame, Eigen::Quaterniond::Identity(),
                               {off.x(), off.y(), 0.0});
      }
    }
  }

  [[nodiscard]] TravelReport report() const {
    TravelReport report{1.0, factors_[at(part_.begin - first_)], 0.0};
    double way = 0.0, scaled = 0.0;
    for (int i = part_.begin - first_; i < part_.end - first_; ++i) {
      report.least = std::min(report.least, factors_[at(i)]);
      report.greatest = std::max(report.greatest, factors_[at(i)]);
      if (i + 1 == part_.end - first_) break;
      const double step = (path_[at(i + 1)] - path_[at(i)]).norm();
      way += step;
      scaled += step_factor(i) * step;
    }
    if (way > 0.0) report.factor = std::clamp(scaled / way, report.least, report.greatest);
    return report;
  }

  Clip& clip_;
  const int first_;
  const FrameRange part_;
  const Calibration& calibration_;
  const TravelRule& rule_;
  const ContactOptions& options_;
  ContactPlan contacts_;
  // By frame from first_.
  GroundTrack path_;  // Of the hips, metres.
  std::vector<double> factors_;
  GroundTrack body_;                 // Displacements, metres.
  std::array<GroundTrack, 2> feet_;  // Displacements, metres.
};

}  // namespace

double TravelRule::factor(double speed) const {
  if (slow == fast) return slow;
  return slow + (fast - slow) * smooth_step(slow_speed, fast_speed, speed);
}

TravelReport scale_travel(Clip& clip, int first, FrameRange part, const Calibration& calibration,
                          const TravelRule& rule, const ContactOptions& contacts) {
  return TravelScaler(clip, first, part, calibration, rule, contacts).run();
}

}  // namespace retarget
