#include "human/gait/plant_noisy_feet.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/math/banded_system.h"
#include "human/gait/contact_plan.h"
#include "human/gait/end_tracks.h"
#include "human/gait/frame_runs.h"
#include "human/gait/limb_mover.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"
#include "retarget/so3.h"
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

int body_joint(const Skeleton& skeleton, const Calibration& calibration) {
  int moving = -1;
  int joint = calibration.bones[Bone::kHips].position_joint;
  for (; joint >= 0; joint = skeleton.joint(joint).parent) {
    if (skeleton.translation_slot(joint) >= 0) moving = joint;
  }
  return moving;
}

void move_body(Clip& clip, int frame, const Calibration& calibration, int joint,
               const Vector3d& shift) {
  Vector3d off = calibration.human_from_source.transpose() * shift / calibration.metres_per_unit;
  if (const int parent = clip.skeleton().joint(joint).parent; parent >= 0) {
    std::vector<Pose> world(static_cast<std::size_t>(clip.skeleton().joint_count()));
    forward_kinematics(clip, frame, world);
    off = world[static_cast<std::size_t>(parent)].rotation.conjugate() * off;
  }
  clip.translations(frame)[static_cast<std::size_t>(clip.skeleton().translation_slot(joint))] +=
      off;
}

}  // namespace retarget
