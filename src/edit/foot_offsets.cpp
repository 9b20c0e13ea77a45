#include <algorithm>
#include <cmath>
#include <utility>

#include "edit/foot_offsets.h"
#include "edit/seam_blend.h"
#include "retarget/contact_plan.h"
#include "retarget/so3.h"
#include "retarget/spline.h"
#include "retarget/trigonometry.h"

namespace retarget {

std::array<std::vector<FootStand>, 2> find_foot_stands(const HumanClip& human, double same_stand) {
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
    for (const ContactPhase& phase : without_short_breaks(phases, same_stand, human.rate)) {
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

LegReach FootOffsets::reach(std::size_t frame, const LegTrack& leg, double drop,
                            const PlantOptions& options) const {
  const double own = (leg.hips[frame] - leg.ankles[frame].translation).norm();
  const double against_hip = (shifts[frame] + Eigen::Vector3d(0.0, 0.0, drop)).norm();
  return LegReach::of(leg.lengths[frame], own, against_hip, options.soft_reach, options.max_reach);
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
                  const LegTrack& leg, const std::vector<double>& drops,
                  const PlantOptions& options, int ramp) {
  for (const PlantedFoot& plant : plants) {
    if (plant.foot != foot || !plant.toes_in_foot) continue;
    // Ramp up the rotation so that the foot does not jump when its toes touch down.
    int down = plant.begin == 0 ? ramp : 0;
    for (auto i = static_cast<std::size_t>(plant.begin); std::cmp_less(i, plant.end()); ++i) {
      if (stance_at(plant, static_cast<int>(i)) == FootStance::kOnHeel) continue;
      const double share = smooth_step(0.0, ramp, std::min(++down, ramp));
      const Eigen::Vector3d hip = leg.hips[i] - Eigen::Vector3d(0.0, 0.0, drops[i]);
      const LegReach stretch = offsets.reach(i, leg, drops[i], options);
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
