#include "edit/plant_feet.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "edit/ground_pose.h"
#include "edit/seam.h"
#include "retarget/contact_plan.h"
#include "retarget/so3.h"
#include "retarget/spline.h"
#include "retarget/text.h"
#include "retarget/trigonometry.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Metres: smaller drops are rounding errors.
constexpr double kNoDrop = 1e-10;
// Metres: maximum distance by which hips are lowered.
constexpr double kDeepestPelvis = 0.1;
// Legs extend freely up to kSoftReach of the length of thigh and shin; beyond it the extension
// saturates at kMaxReach. For legs that the source extends farther, the range is from there to
// their full length.
constexpr double kSoftReach = 0.96, kMaxReach = 0.995;
// Seconds: stances separated by less than this are merged.
constexpr double kBreakInStand = 0.1;

// Returns a smooth upper bound: a sliding maximum followed by a sliding mean.
std::vector<double> smooth_cover(const std::vector<double>& values, int reach) {
  const int count = static_cast<int>(values.size());
  std::vector<double> largest(values.size(), 0.0), result(values.size(), 0.0);
  for (int i = 0; i < count; ++i) {
    if (!(values[i] > 0.0)) continue;
    for (int k = std::max(0, i - reach); k <= std::min(count - 1, i + reach); ++k) {
      largest[k] = std::max(largest[k], values[i]);
    }
  }
  for (int i = 0; i < count; ++i) {
    double sum = 0.0, weights = 0.0;
    for (int k = -reach; k <= reach; ++k) {
      const double weight = 1.0 + portable::sin_cos(std::numbers::pi * k / (reach + 1.0)).cosine;
      sum += weight * largest[std::clamp(i + k, 0, count - 1)];
      weights += weight;
    }
    result[i] = sum / weights;
  }
  return result;
}

// Tracks a leg through all frames.
LegTrack track_leg(const Clip& clip, const Calibration& calibration, const LegJoints& leg) {
  const Eigen::Quaterniond human_from_source(calibration.human_from_source);
  const double metres_per_unit = calibration.metres_per_unit;
  std::vector<Pose> poses(static_cast<std::size_t>(clip.skeleton().joint_count()));
  LegTrack track;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, poses);
    const Pose& ankle = poses[leg.ankle];
    track.hips.emplace_back(human_from_source * poses[leg.hip].translation * metres_per_unit);
    track.ankles.push_back({(human_from_source * ankle.rotation).normalized(),
                            human_from_source * ankle.translation * metres_per_unit});
    const Eigen::Vector3d& knee = poses[leg.knee].translation;
    track.lengths.push_back(
        ((knee - poses[leg.hip].translation).norm() + (ankle.translation - knee).norm()) *
        metres_per_unit);
  }
  return track;
}

class FootPlanter {
 public:
  FootPlanter(Clip& clip, const Calibration& calibration, const BodyMover& mover,
              const PlantOptions& options)
      : clip_(clip),
        mover_(mover),
        options_(options),
        human_from_source_(calibration.human_from_source),
        metres_per_unit_(calibration.metres_per_unit),
        frames_(static_cast<std::size_t>(clip.frame_count())) {
    const auto legs = find_legs(clip.skeleton(), calibration);
    for (int foot = 0; foot < 2; ++foot) {
      if (!legs[foot]) continue;
      const Bone bone = side_bone(kSides[foot], LimbBone::kLeg);
      // Knees bend about -z of the canonical shin.
      Eigen::Vector3d axis = -Eigen::Vector3d::UnitZ();
      const auto& bone_axes = calibration.bones[bone].joint_from_bone;
      if (bone_axes) axis = *bone_axes * axis;
      solvers_[foot].emplace(*legs[foot], learned_hinge(clip, *legs[foot], axis));
      tracks_[foot] = track_leg(clip, calibration, *legs[foot]);
    }
  }

  PlantSummary run(std::span<const PlantedFoot> plants) {
    const int release = frames_in(options_.release, clip_.rate());
    std::array<FootOffsets, 2> offsets{FootOffsets(frames_), FootOffsets(frames_)};
    for (int foot = 0; foot < 2; ++foot) {
      if (solvers_[foot]) offsets[foot] = planted_offsets(plants, foot, tracks_[foot]);
    }
    // A foot flat on the floor needs the hips lowered; a foot on its toes can rise on them instead.
    std::vector<double> drops = find_drops(offsets, false);
    for (int foot = 0; foot < 2; ++foot) {
      if (!solvers_[foot]) continue;
      rise_on_toes(offsets[foot], plants, foot, tracks_[foot], drops, release);
      fade_offsets(offsets[foot], release);
    }
    drops = find_drops(offsets, true);
    for (std::size_t frame = 0; frame < frames_; ++frame) {
      const bool lower = drops[frame] > kNoDrop;
      if (!lower && !offsets[0].any(frame) && !offsets[1].any(frame)) continue;
      if (lower) {
        mover_.move(clip_, static_cast<int>(frame),
                    {Eigen::Quaterniond::Identity(), {0.0, 0.0, -drops[frame]}});
        summary_.largest_drop = std::max(summary_.largest_drop, drops[frame]);
      }
      for (int foot = 0; foot < 2; ++foot) {
        if (!solvers_[foot] || (!lower && !offsets[foot].any(frame))) continue;
        place_foot(offsets[foot], foot, frame, drops[frame]);
      }
    }
    return summary_;
  }

 private:
  // Returns how far the hips must be lowered for the legs to reach, metres.
  [[nodiscard]] std::vector<double> find_drops(const std::array<FootOffsets, 2>& offsets,
                                               bool on_toes) const {
    std::vector<double> drops(frames_, 0.0);
    bool any = false;
    for (int foot = 0; foot < 2; ++foot) {
      if (!solvers_[foot]) continue;
      for (std::size_t frame = 0; frame < frames_; ++frame) {
        if (!offsets[foot].planted[frame] || !offsets[foot].any(frame)) continue;
        if (offsets[foot].heel_up[frame] && !on_toes) continue;
        const Eigen::Vector3d from_foot =
            tracks_[foot].hips[frame] - offsets[foot].moved(frame, tracks_[foot]).translation;
        const double reach = offsets[foot].reach(frame, tracks_[foot], 0.0).easily();
        if (from_foot.norm() <= reach) continue;
        const double left = reach * reach - from_foot.head<2>().squaredNorm();
        const double drop = left > 0.0 ? from_foot.z() - std::sqrt(left) : from_foot.z();
        // Limits the drop for low hips, so that a sitting or lying body stays above the floor.
        constexpr double kLower = 0.125;
        const double deepest = std::clamp(kLower * from_foot.z(), 0.0, kDeepestPelvis);
        drops[frame] = std::max(drops[frame], std::clamp(drop, 0.0, deepest));
        any = true;
      }
    }
    return any ? smooth_cover(drops, frames_in(options_.pelvis_blend, clip_.rate())) : drops;
  }

  void place_foot(const FootOffsets& offsets, int foot, std::size_t frame, double drop) {
    const Pose wanted = offsets.moved(frame, tracks_[foot]);
    const Pose in_source{human_from_source_.conjugate() * wanted.rotation,
                         human_from_source_.conjugate() * wanted.translation / metres_per_unit_};
    LegReach stretch = offsets.reach(frame, tracks_[foot], drop);
    stretch.begin /= metres_per_unit_;
    stretch.room /= metres_per_unit_;
    const double miss = solvers_[foot]->reach(clip_, static_cast<int>(frame), in_source, stretch) *
                        metres_per_unit_;
    summary_.largest_correction =
        std::max(summary_.largest_correction, offsets.shifts[frame].norm());
    if (offsets.planted[frame]) summary_.largest_miss = std::max(summary_.largest_miss, miss);
  }

  Clip& clip_;
  const BodyMover& mover_;
  const PlantOptions& options_;
  const Eigen::Quaterniond human_from_source_;
  const double metres_per_unit_;
  const std::size_t frames_;
  std::array<std::optional<TwoBoneLeg>, 2> solvers_;
  std::array<LegTrack, 2> tracks_;
  PlantSummary summary_;
};

}  // namespace

std::vector<Pose> ankle_poses(const Clip& clip, const Calibration& calibration,
                              const LegJoints& leg) {
  return track_leg(clip, calibration, leg).ankles;
}

Result<PlantSummary> plant_feet(Clip& clip, const Calibration& calibration,
                                std::span<const PlantedFoot> plants, const PlantOptions& options) {
  RETARGET_TRY_ASSIGN(const auto mover, BodyMover::of(clip, calibration));
  return FootPlanter(clip, calibration, mover, options).run(plants);
}

std::string planted_text(const PlantSummary& feet) {
  return "moved by up to " + number_text(100.0 * feet.largest_correction, 1) +
         " cm to stand, hips lowered by up to " + number_text(100.0 * feet.largest_drop, 1) + " cm";
}

std::vector<ContactPhase> without_short_breaks(const std::vector<ContactPhase>& phases,
                                               double seconds, const FrameRate& rate) {
  std::vector<ContactPhase> closed;
  for (const ContactPhase& phase : phases) {
    if (!closed.empty() && (phase.begin - closed.back().end) * rate.frame_time() < seconds) {
      closed.back().end = phase.end;
    } else {
      closed.push_back(phase);
    }
  }
  return closed;
}

std::array<std::vector<FootStand>, 2> find_foot_stands(const HumanClip& human) {
  std::array<std::vector<FootStand>, 2> stands;
  const ContactPlan contacts = find_contacts(human);
  const double upright_rise = kUprightRise * contacts.scale;
  for (int foot = 0; foot < 2; ++foot) {
    const Bone ankle = side_bone(kSides[foot], LimbBone::kFoot),
               toe = side_bone(kSides[foot], LimbBone::kToe);
    if (!human.has(ankle)) continue;
    const bool has_toe = human.has(toe);
    std::vector<FootStance> stances(static_cast<std::size_t>(human.frame_count),
                                    FootStance::kOnSole);
    std::vector<ContactPhase> phases;
    for (int frame = 0; frame < human.frame_count; ++frame) {
      if (!contacts.in_contact(foot, frame)) {
        if (!has_toe) continue;
        const HumanPose& pose = human.frame(frame);
        const double rise = pose[ankle].translation.z() - pose[toe].translation.z();
        if (contacts.in_contact(foot, kHeelEnd, frame)) {
          stances[frame] = FootStance::kOnHeel;
        } else if (contacts.in_contact(foot, kToeEnd, frame) && rise > upright_rise) {
          stances[frame] = FootStance::kOnToes;
        } else {
          continue;
        }
      }
      if (phases.empty() || phases.back().end != frame) phases.push_back({frame, frame});
      phases.back().end = frame + 1;
    }
    for (const ContactPhase& phase : without_short_breaks(phases, kBreakInStand, human.rate)) {
      stands[foot].push_back(
          {phase.begin, phase.end, {stances.begin() + phase.begin, stances.begin() + phase.end}});
    }
  }
  return stands;
}

PlantedFoot plant_of(const FootStand& stand, int foot, int frame, const std::vector<Pose>& ankles,
                     const HumanClip& human) {
  PlantedFoot plant{
      foot, stand.begin, {ankles.begin() + stand.begin, ankles.begin() + stand.end}, stand.stances};
  const Bone toe = side_bone(kSides[foot], LimbBone::kToe);
  if (human.has(toe)) {
    plant.toes_in_foot = ankles[frame].inverse() * human.frame(frame)[toe].translation;
  }
  return plant;
}

namespace {

// Corrections below this are rounding errors, metres and radians.
constexpr double kEpsilon = 1e-10;

using Track = std::vector<Eigen::Vector3d>;

// Interpolates between two planted runs, or fades before the first and after the last one.
void fade_between(Track& track, const std::vector<bool>& planted, int from, int to, int release) {
  const int frames = static_cast<int>(track.size());
  const auto velocity = [&](int frame, int inwards) -> Eigen::Vector3d {
    const int other = frame + inwards;
    if (other < 0 || other >= frames || !planted[other]) return Eigen::Vector3d::Zero();
    return (track[other] - track[frame]) * inwards;
  };
  // Velocities within the planted runs, taken before anything is filled.
  const Eigen::Vector3d leaving = from >= 0 ? velocity(from, -1) : Eigen::Vector3d::Zero();
  const Eigen::Vector3d coming = to < frames ? velocity(to, 1) : Eigen::Vector3d::Zero();
  if (from >= 0 && to < frames && to - from <= 2 * release) {
    for (int i = from + 1; i < to; ++i) {
      track[i] = ease(track[from], leaving, track[to], coming, to - from, i - from);
    }
    return;
  }
  if (from >= 0) {
    for (int i = from + 1; i < std::min(to, from + release); ++i) {
      track[i] = fade(track[from], leaving, release, i - from);
    }
  }
  if (to < frames) {
    for (int i = to - 1; i > std::max(from, to - release); --i) {
      track[i] = fade(track[to], -coming, release, to - i);
    }
  }
}

FootStance stance_at(const PlantedFoot& plant, int frame) {
  const auto at = static_cast<std::size_t>(frame - plant.begin);
  return at < plant.stances.size() ? plant.stances[at] : FootStance::kOnSole;
}

// Rotates a foot on its toes about them if its leg would be stretched too far: the heel moves
// towards the hip, as in a long step.
Pose on_its_toes(const Pose& wanted, const Eigen::Vector3d& toes_in_foot,
                 const Eigen::Vector3d& hip, const LegReach& stretch, double share) {
  constexpr double kMaxTurn = 0.6;  // Radians; beyond this the leg is too short.
  const Eigen::Vector3d toes = wanted * toes_in_foot;
  const Eigen::Vector3d foot = wanted.translation - toes, leg = hip - toes;
  const Eigen::Vector3d axis = foot.cross(leg);
  const double lengths = foot.norm() * leg.norm();
  const double distance = (hip - wanted.translation).norm(), near = stretch.halved().at(distance);
  if (near >= distance || !(axis.norm() > 1e-6 * lengths)) return wanted;
  const double cosine = std::clamp(
      (foot.squaredNorm() + leg.squaredNorm() - near * near) / (2.0 * lengths), -1.0, 1.0);
  const double angle = portable::atan2(std::sqrt(1.0 - cosine * cosine), cosine);
  const double turn = portable::atan2(axis.norm(), foot.dot(leg)) - angle;
  const Eigen::Quaterniond about =
      exp_so3(axis.normalized() * share * std::clamp(turn, 0.0, kMaxTurn));
  return {(about * wanted.rotation).normalized(), toes + about * foot};
}

}  // namespace

bool FootOffsets::any(std::size_t frame) const {
  return shifts[frame].norm() > kEpsilon || turns[frame].norm() > kEpsilon;
}

void FootOffsets::set(std::size_t frame, const Pose& wanted, const LegTrack& leg) {
  const Pose& ankle = leg.ankles[frame];
  shifts[frame] = wanted.translation - ankle.translation;
  turns[frame] = log_so3(wanted.rotation * ankle.rotation.conjugate());
}

Pose FootOffsets::moved(std::size_t frame, const LegTrack& leg) const {
  const Pose& ankle = leg.ankles[frame];
  return {(exp_so3(turns[frame]) * ankle.rotation).normalized(), ankle.translation + shifts[frame]};
}

LegReach FootOffsets::reach(std::size_t frame, const LegTrack& leg, double drop) const {
  const double own = (leg.hips[frame] - leg.ankles[frame].translation).norm();
  const double against_hip = (shifts[frame] + Eigen::Vector3d(0.0, 0.0, drop)).norm();
  return LegReach::of(leg.lengths[frame], own, against_hip, kSoftReach, kMaxReach);
}

FootOffsets planted_offsets(std::span<const PlantedFoot> plants, int foot, const LegTrack& leg) {
  FootOffsets offsets(leg.ankles.size());
  for (const PlantedFoot& plant : plants) {
    if (plant.foot != foot) continue;
    for (int i = plant.begin; i < plant.end(); ++i) {
      const auto at = static_cast<std::size_t>(i - plant.begin);
      offsets.set(static_cast<std::size_t>(i), plant.world_from_foot[at], leg);
      offsets.planted[i] = true;
      offsets.heel_up[i] = plant.toes_in_foot && stance_at(plant, i) == FootStance::kOnToes;
    }
  }
  return offsets;
}

void rise_on_toes(FootOffsets& offsets, std::span<const PlantedFoot> plants, int foot,
                  const LegTrack& leg, const std::vector<double>& drops, int ramp) {
  for (const PlantedFoot& plant : plants) {
    if (plant.foot != foot || !plant.toes_in_foot) continue;
    // Ramp up the rotation so that the foot does not jump when its toes touch down.
    int down = plant.begin == 0 ? ramp : 0;
    for (auto i = static_cast<std::size_t>(plant.begin); std::cmp_less(i, plant.end()); ++i) {
      if (stance_at(plant, static_cast<int>(i)) == FootStance::kOnHeel) continue;
      const double share = smooth_step(0.0, ramp, std::min(++down, ramp));
      const Eigen::Vector3d hip = leg.hips[i] - Eigen::Vector3d(0.0, 0.0, drops[i]);
      const LegReach stretch = offsets.reach(i, leg, drops[i]);
      offsets.set(i, on_its_toes(offsets.moved(i, leg), *plant.toes_in_foot, hip, stretch, share),
                  leg);
    }
  }
}

void fade_offsets(FootOffsets& offsets, int release) {
  const int frames = static_cast<int>(offsets.planted.size());
  // Gaps lie between runs of planted frames: `from` is the last frame before, `to` the first after.
  int from = -1;
  for (int to = 0; to <= frames; ++to) {
    if (to < frames && !offsets.planted[to]) continue;
    if (to - from > 1 && (from >= 0 || to < frames)) {
      fade_between(offsets.shifts, offsets.planted, from, to, release);
      fade_between(offsets.turns, offsets.planted, from, to, release);
    }
    from = to;
  }
}

}  // namespace retarget
