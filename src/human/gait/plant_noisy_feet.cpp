#include "human/gait/plant_noisy_feet.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/math/banded_system.h"
#include "human/gait/body_joint.h"
#include "human/gait/contact_plan.h"
#include "human/gait/end_tracks.h"
#include "human/gait/frame_runs.h"
#include "human/gait/limb_mover.h"
#include "human/gait/noisy_stances.h"
#include "human/gait/source_feet.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"
#include "retarget/so3.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Track = std::vector<Vector3d>;

// A stance of one end of a foot, and where it is held.
struct HeldEnd {
  int begin = 0, end = 0;
  Vector3d place = Vector3d::Zero();
};

Vector3d median_of(const Track& track, int begin, int end) {
  Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (int i = begin; i < end; ++i) values.push_back(track[static_cast<std::size_t>(i)][axis]);
    middle[axis] = median(values);
  }
  return middle;
}

// Passes through the targets of frames with weight, and changes smoothly between them.
Track interpolated(const Track& targets, const std::vector<double>& weights, double cutoff,
                   double frame_time) {
  constexpr double kToZero = 1e-3;
  const double frequency = 2.0 * std::numbers::pi * cutoff * frame_time;
  const double strength = 1.0 / (frequency * frequency * frequency * frequency);
  Track result(targets.size(), Vector3d::Zero());
  for (int axis = 0; axis < 3; ++axis) {
    PentadiagonalFit fit(targets.size());
    for (std::size_t i = 0; i < targets.size(); ++i) {
      fit.add_value(i, kToZero, 0.0);
      if (weights[i] > 0.0) fit.add_value(i, weights[i], targets[i][axis]);
      if (i + 2 < targets.size()) fit.add_second_difference(i, strength, 0.0);
    }
    const std::vector<double> solved = fit.solve();
    for (std::size_t i = 0; i < targets.size(); ++i) result[i][axis] = solved[i];
  }
  return result;
}

// Rotates a vector in its vertical plane until it has this height; unchanged if it is too short or
// has no direction over the ground.
Vector3d with_height(const Vector3d& vector, double height) {
  const double over_ground = vector.head<2>().norm();
  const double left = vector.squaredNorm() - height * height;
  if (vector.z() == height || !(left > 0.0) || !(over_ground > 0.0)) return vector;
  Vector3d turned;
  turned << vector.head<2>() * (std::sqrt(left) / over_ground), height;
  return turned;
}

class NoisyFootPlanter {
 public:
  NoisyFootPlanter(Clip& clip, FrameRange part, const Calibration& calibration, int moved,
                   double noise_speed, double noise_distance)
      : clip_(clip),
        part_(part),
        calibration_(calibration),
        moved_(moved),
        noise_speed_(noise_speed),
        noise_distance_(noise_distance) {}

  NoisyFeet run() {
    constexpr double kErrors = 3.0;  // RMS errors.
    const auto legs = find_legs(clip_.skeleton(), calibration_);
    if (!legs[0] || !legs[1]) return {};
    read_feet();
    if (!has_whole_feet(feet_)) return {};
    reach_ = kErrors * noise_distance_ * feet_.leg_length() / kUsualSourceLeg;
    const NoisyStances stances = find_noisy_stances(feet_, noise_speed_);
    for (int foot = 0; foot < 2; ++foot) {
      for (const int end : {kHeelEnd, kToeEnd}) {
        const std::size_t index = stance_index(foot, end);
        tracks_[index] = track_of(foot, end);
        held_[index] = held(tracks_[index], stances[index]);
      }
      result_.stances += static_cast<int>(held_[stance_index(foot, kToeEnd)].size());
    }
    if (result_.stances == 0) return {};
    for (const int end : {kHeelEnd, kToeEnd}) level(end);
    for (int foot = 0; foot < 2; ++foot) find_targets(foot);
    move_root();
    for (int foot = 0; foot < 2; ++foot) turn_leg(foot, *legs[static_cast<std::size_t>(foot)]);
    return result_;
  }

 private:
  void read_feet() { feet_ = feet_and_hips(clip_, calibration_, part_).feet; }

  [[nodiscard]] Track track_of(int foot, int end) const {
    Track track;
    for (int i = 0; i < feet_.frame_count(); ++i) track.push_back(feet_.at(i, foot).end(end));
    return track;
  }

  [[nodiscard]] std::vector<HeldEnd> held(const Track& track,
                                          const std::vector<char>& stands) const {
    std::vector<HeldEnd> stances;
    const auto is_held = [&](int frame) { return stands[static_cast<std::size_t>(frame)] != 0; };
    for_each_run_where(0, feet_.frame_count(), is_held, [&](int begin, int end) {
      stances.push_back({begin, end, median_of(track, begin, end)});
    });
    return stances;
  }

  // Moves stances to their median height, except those far from it, as on a box.
  void level(int end) {
    constexpr double kFar = 0.15;  // Metres.
    std::vector<double> heights;
    for (int foot = 0; foot < 2; ++foot) {
      for (const HeldEnd& stance : held_[stance_index(foot, end)]) {
        heights.insert(heights.end(), static_cast<std::size_t>(stance.end - stance.begin),
                       stance.place.z());
      }
    }
    if (heights.empty()) return;
    const double middle = median(heights);
    levels_[static_cast<std::size_t>(end)] = middle;
    for (int foot = 0; foot < 2; ++foot) {
      for (HeldEnd& stance : held_[stance_index(foot, end)]) {
        if (std::abs(stance.place.z() - middle) < kFar) stance.place.z() = middle;
      }
    }
  }

  void find_targets(int foot) {
    const Track& heel = tracks_[stance_index(foot, kHeelEnd)];
    const Track& toe = tracks_[stance_index(foot, kToeEnd)];
    std::vector<HeldEnd>& heels = held_[stance_index(foot, kHeelEnd)];
    const std::vector<HeldEnd>& toes = held_[stance_index(foot, kToeEnd)];
    // Feet are rigid: a heel is held at the foot's length from the toe that is held longest with
    // it.
    std::vector<double> lengths;
    for (std::size_t i = 0; i < heel.size(); ++i) lengths.push_back((toe[i] - heel[i]).norm());
    const double length = median(lengths);
    for (HeldEnd& held_heel : heels) {
      int longest = 0;
      Vector3d place = held_heel.place;
      for (const HeldEnd& held_toe : toes) {
        const int common =
            std::min(held_heel.end, held_toe.end) - std::max(held_heel.begin, held_toe.begin);
        const Vector3d along = held_toe.place - held_heel.place;
        if (common <= longest || !(along.norm() > 0.0)) continue;
        longest = common;
        place = held_toe.place - length * along.normalized();
      }
      held_heel.place = place;
    }
    add_targets(foot, kHeelEnd, heel, heels);
    add_targets(foot, kToeEnd, toe, toes);
  }

  void add_targets(int foot, int end, const Track& track, const std::vector<HeldEnd>& stances) {
    constexpr double kHeld = 1e6;
    const std::size_t index = stance_index(foot, end);
    targets_[index].assign(track.size(), Vector3d::Zero());
    weights_[index].assign(track.size(), 0.0);
    for (const HeldEnd& stance : stances) {
      for (int i = stance.begin; i < stance.end; ++i) {
        const auto at = static_cast<std::size_t>(i);
        if ((stance.place - track[at]).norm() > reach_) continue;
        targets_[index][at] = stance.place - track[at];
        weights_[index][at] = kHeld;
      }
    }
  }

  // Translates the body by the common, slow part of the corrections.
  void move_root() {
    constexpr double kCutoff = 1.5;  // Hz
    const auto count = static_cast<std::size_t>(feet_.frame_count());
    Track common(count, Vector3d::Zero());
    std::vector<double> weights(count, 0.0);
    for (std::size_t i = 0; i < count; ++i) {
      double held = 0.0;
      for (std::size_t end = 0; end < targets_.size(); ++end) {
        if (weights_[end][i] == 0.0) continue;
        common[i] += targets_[end][i];
        held += 1.0;
      }
      if (held == 0.0) continue;
      common[i] /= held;
      weights[i] = std::min(1.0, 0.5 * held);
    }
    const Track shifts = interpolated(common, weights, kCutoff, feet_.frame_time);
    for (std::size_t i = 0; i < count; ++i) {
      move_body(clip_, part_.begin + static_cast<int>(i), calibration_, moved_, shifts[i]);
      for (std::size_t end = 0; end < targets_.size(); ++end) {
        if (weights_[end][i] > 0.0) targets_[end][i] -= shifts[i];
      }
    }
    read_feet();
  }

  void turn_leg(int foot, const LegJoints& joints) {
    constexpr double kCutoff = 2.0;  // Hz
    std::array<Track, 2> offsets;
    for (const int end : {kHeelEnd, kToeEnd}) {
      const std::size_t index = stance_index(foot, end);
      offsets[static_cast<std::size_t>(end)] =
          interpolated(targets_[index], weights_[index], kCutoff, feet_.frame_time);
    }
    const Side side = kSides[static_cast<std::size_t>(foot)];
    const LimbMover leg(clip_, calibration_, joints, side_bone(side, LimbBone::kLeg));
    for (int i = 0; i < feet_.frame_count(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      place_foot(foot, i, within_reach(offsets[0][at]), within_reach(offsets[1][at]), leg);
    }
  }

  // Interpolation over a short swing between opposite corrections would overshoot.
  [[nodiscard]] Vector3d within_reach(const Vector3d& offset) const {
    const double length = offset.norm();
    return length > reach_ ? Vector3d(offset * (reach_ / length)) : offset;
  }

  // Feet of an upright body are not below those that stand: otherwise noise would set the height of
  // the floor.
  [[nodiscard]] Vector3d above_floor(Vector3d place, int i, int end) const {
    constexpr double kHips = 0.3;  // Metres, for legs of kUsualSourceLeg.
    const auto& level = levels_[static_cast<std::size_t>(end)];
    if (!level || feet_.hips.empty()) return place;
    const double hips = feet_.hips[static_cast<std::size_t>(i)] - *level;
    if (hips > kHips * feet_.leg_length() / kUsualSourceLeg)
      place.z() = std::max(place.z(), std::min(*level, place.z() + reach_));
    return place;
  }

  void place_foot(int foot, int i, const Vector3d& heel_offset, const Vector3d& toe_offset,
                  const LimbMover& leg) {
    const auto at = static_cast<std::size_t>(i);
    const SourceFoot& source = feet_.at(i, foot);
    const Vector3d heel = source.end(kHeelEnd), toe = source.end(kToeEnd);
    const Vector3d new_heel = above_floor(heel + heel_offset, i, kHeelEnd);
    const Vector3d new_toe = above_floor(toe + toe_offset, i, kToeEnd);
    const Vector3d foot_before = toe - heel;
    const double length = foot_before.norm();
    Vector3d along = new_toe - new_heel;
    if (!(along.norm() > 0.0) || !(length > 0.0)) return;
    along *= length / along.norm();
    const bool on_toe = weights_[stance_index(foot, kHeelEnd)][at] == 0.0 &&
                        weights_[stance_index(foot, kToeEnd)][at] > 0.0;
    // At the foot's true length, the end that is not held must not be below the floor either.
    const double rise = on_toe ? new_toe.z() - above_floor(new_toe - along, i, kHeelEnd).z()
                               : above_floor(new_heel + along, i, kToeEnd).z() - new_heel.z();
    along = with_height(along, rise);
    const Quaterniond turn = rotation_between(foot_before, along);
    const Vector3d ankle = on_toe ? Vector3d(new_toe - turn * (toe - source.ankle))
                                  : Vector3d(new_heel + turn * (source.ankle - heel));
    result_.farthest = std::max(result_.farthest, (ankle - source.ankle).norm());
    leg.move_end(clip_, part_.begin + i, turn, ankle - source.ankle);
  }

  Clip& clip_;
  FrameRange part_;
  const Calibration& calibration_;
  int moved_;
  double noise_speed_, noise_distance_;
  double reach_ = 0.0;  // Metres that the noise explains.
  SourceFeet feet_;
  // Corrections in metres and their weights, by end and frame; weight 0: the end does not stand.
  std::array<Track, 4> targets_;
  std::array<Track, 4> tracks_;
  std::array<std::vector<HeldEnd>, 4> held_;
  std::array<std::optional<double>, 2> levels_;  // One per end: the height of most stances, metres.
  std::array<std::vector<double>, 4> weights_;
  NoisyFeet result_;
};

}  // namespace

NoisyFeet plant_noisy_feet(Clip& clip, FrameRange part, const Calibration& calibration, int moved,
                           double noise_speed, double noise_distance) {
  return NoisyFootPlanter(clip, part, calibration, moved, noise_speed, noise_distance).run();
}

}  // namespace retarget
