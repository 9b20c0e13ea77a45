#include "human/gait/clean_clip.h"

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>

#include "formats/smpl/joint_motion.h"
#include "human/gait/body_joint.h"
#include "human/gait/contact_plan.h"
#include "human/gait/end_tracks.h"
#include "human/gait/joint_jitter.h"
#include "human/gait/plant_noisy_feet.h"
#include "human/gait/repeated_frames.h"
#include "human/gait/root_drift.h"
#include "human/gait/root_jitter.h"
#include "human/gait/source_feet.h"
#include "human/gait/track_faults.h"
#include "human/gait/track_noise.h"
#include "human/gait/track_spikes.h"
#include "human/skeleton/joint_clip.h"
#include "retarget/human.h"
#include "retarget/statistics.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

bool has_positions_only(const Clip& clip) {
  return !clip.origin().unknown_rotations.empty() && clip.frame_count() > 0;
}

class ClipCleaner {
 public:
  ClipCleaner(Clip& clip, FrameRange part, const Calibration& calibration,
              const FootNoise& foot_noise, RootRule root)
      : clip_(clip), part_(part), calibration_(calibration), root_(root) {
    report_.foot_noise = foot_noise;
  }

  CleanReport clean() {
    constexpr int kFewest = 3;  // Frames.
    if (part_.end - part_.begin < kFewest) return {};
    bridge();
    // Rotations computed from positions follow the smoothed positions.
    if (!has_positions_only(clip_)) smooth_root(smooth_rotations());
    jittery_ = report_.foot_noise.wander > 0.0;
    if (root_ == RootRule::kFollowsFeet) move_root();
    return std::move(report_);
  }

 private:
  void bridge() {
    // First, because frozen frames between lost ones would be anchors of an interpolation.
    if (const int lost = bridge_lost_frames(clip_, part_); lost > 0) {
      report_.notes.push_back(count_text(lost, "lost frame") + " bridged");
    }
    if (const int frozen = bridge_frozen_frames(clip_, part_); frozen > 0) {
      report_.notes.push_back(count_text(frozen, "frozen frame") + " bridged");
    }
    for (const std::string& lost : bridge_lost_joints(clip_, part_)) {
      report_.notes.push_back(lost + ": bridged");
    }
    // Spikes of positions were bridged before their rotations were computed.
    if (has_positions_only(clip_)) return;
    for (const std::string& spike : bridge_spikes(clip_, part_, calibration_.metres_per_unit)) {
      report_.notes.push_back(spike + ": bridged");
    }
  }

  // @return whether the joints had independent errors
  bool smooth_rotations() {
    constexpr double kSlowest = 1.5;  // Hz
    const double frame_time = clip_.rate().frame_time();
    const JointJitter jitter = find_jitter(clip_, part_, calibration_);
    std::vector<double> cutoffs;
    std::map<int, NoiseRest> rests;  // By joint.
    for (const int joint : jitter.joints) {
      const std::vector<Quaterniond> rotations = rotation_track(clip_, part_, joint);
      const TrackNoise noise = measure_noise(rotations);
      if (!noise.may_exceed(kSmallStep)) continue;
      const NoisePower power = NoisePower::of(noise, jitter.white);
      const auto cutoff = best_cutoff(rotations, power, frame_time, kSlowest);
      const double strength = cutoff ? smoothing_strength(*cutoff, frame_time) : 0.0;
      rests[joint] = rest_of(power, strength, frame_time);
      if (!cutoff) continue;
      cutoffs.push_back(*cutoff);
      const auto smooth = smoothed(rotations, strength);
      for (int frame = part_.begin; frame < part_.end; ++frame) {
        clip_.rotations(frame)[static_cast<std::size_t>(joint)] =
            smooth[static_cast<std::size_t>(frame - part_.begin)];
      }
    }
    if (cutoffs.empty()) return false;
    const auto [slowest, fastest] = std::ranges::minmax(cutoffs);
    report_.notes.push_back(
        fmt::format("jitter of {} degrees per frame (median of {}) smoothed, cutoffs {} to {} Hz",
                    number_text(median(jitter.steps) * 180.0 / std::numbers::pi, 1), jitter.of,
                    number_text(slowest, 1), number_text(fastest, 1)));
    report_.foot_noise = noise_of_feet(rests);
    if (report_.foot_noise.speed > 0.0) fix_lengths();
    return jitter.white;
  }

  // @param white  whether the joints had independent errors
  void smooth_root(bool white) {
    const auto found = smooth_root_jitter(clip_, part_, calibration_, white);
    if (!found) return;
    report_.notes.push_back(
        fmt::format("jitter of the root of {} cm per frame smoothed, cutoff {} Hz",
                    number_text(100.0 * found->step, 1), number_text(found->cutoff, 1)));
  }

  // Of the noisier foot, at the end of a straight leg.
  [[nodiscard]] FootNoise noise_of_feet(const std::map<int, NoiseRest>& rests) const {
    // Two of three axes of rotation are across the leg.
    constexpr double kAcross = 2.0 / 3.0, kHalf = 0.5 * 0.5;
    FootNoise most;
    for (const Side side : kSides) {
      double square = 0.0, wander = 0.0;
      for (const auto& [bone, share] : {std::pair{Bone::kHips, 1.0},
                                        {side_bone(side, LimbBone::kUpLeg), 1.0},
                                        {side_bone(side, LimbBone::kLeg), kHalf}}) {
        const auto rest = rests.find(calibration_.bones[bone].rotation_joint);
        if (rest == rests.end()) continue;
        square += kAcross * share * rest->second.speed * rest->second.speed;
        wander += kAcross * share * rest->second.wander * rest->second.wander;
      }
      const double speed = kUsualSourceLeg * std::sqrt(square);
      if (speed > most.speed) most = {speed, kUsualSourceLeg * std::sqrt(wander)};
    }
    return most;
  }

  // The hips and their ancestors.
  [[nodiscard]] std::vector<int> trunk_joints() const {
    std::vector<int> joints;
    int joint = calibration_.bones[Bone::kHips].position_joint;
    for (; joint >= 0; joint = clip_.skeleton().joint(joint).parent) joints.push_back(joint);
    return joints;
  }

  // Replaces the translations of joints outside the trunk with their medians.
  void fix_lengths() {
    const std::vector<int> trunk = trunk_joints();
    for (int joint = 0; joint < clip_.skeleton().joint_count(); ++joint) {
      const int slot = clip_.skeleton().translation_slot(joint);
      if (slot < 0 || std::ranges::find(trunk, joint) != trunk.end()) continue;
      Vector3d middle;
      for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> values;
        for (int frame = part_.begin; frame < part_.end; ++frame) {
          values.push_back(clip_.translation(frame, joint)[axis]);
        }
        middle[axis] = median(values);
      }
      for (int frame = part_.begin; frame < part_.end; ++frame) {
        clip_.translations(frame)[static_cast<std::size_t>(slot)] = middle;
      }
    }
  }

  [[nodiscard]] FeetAndHips read_feet() const { return feet_and_hips(clip_, calibration_, part_); }

  void move_root() {
    const int moved = body_joint(clip_.skeleton(), calibration_);
    if (moved < 0) return;
    const auto [feet, hips] = read_feet();
    if (feet.foot_count == 0) return;
    const RootEvidence evidence = without_noise(measure_root(feet, hips));
    if (!jittery_ && !evidence.moves()) return;
    // This drift is not the path of a body whose root translation is missing: correcting it would
    // cover a part of the path and hide the fault from the gates.
    if (!jittery_ && root_is_missing(feet, hips)) return;
    // A leg that is not tracked moves with the hips, like a foot that stands while the root drifts.
    if (find_still_limbs(clip_, calibration_).leg) return;
    const DriftRule rule{jittery_, jittery_ || evidence.climbs(), evidence.climbs_steadily,
                         evidence.moves() ? 0.0 : report_.foot_noise.wander};
    const RootDrift found = find_root_drift(feet, hips, rule);
    if (found.drift.empty() || (!jittery_ && !found.helps())) return;
    if (!jittery_ && loses_contacts(found, moved, feet)) return;
    remove(found.drift, moved);
    report_.notes.push_back(root_note(found, evidence));
    report_.root_moved = found.farthest;
    if (jittery_) hold_feet(moved, found.speed_after * kUsualSourceLeg / feet.leg_length());
  }

  // Speeds that the noise of the joints does not explain.
  [[nodiscard]] RootEvidence without_noise(RootEvidence evidence) const {
    // Noise of positions is an upper bound, which would hide a drift.
    if (has_positions_only(clip_)) return evidence;
    const double noise = report_.foot_noise.speed;
    for (double* speed : {&evidence.speed, &evidence.single_speed, &evidence.shake_speed}) {
      *speed = std::sqrt(std::max(0.0, *speed * *speed - noise * noise));
    }
    return evidence;
  }

  // A right correction makes more feet stand. In a fast run with noise few feet stand, and the
  // solution follows those that swing. Then its vertical part is wrong, too.
  [[nodiscard]] bool loses_contacts(const RootDrift& found, int moved, const SourceFeet& feet) {
    constexpr double kLeastShare = 0.95;
    Clip uncorrected = clip_;
    std::vector<Vector3d> whole = found.drift;
    for (std::size_t i = 0; i < found.discarded_heights.size(); ++i) {
      whole[i].z() += found.discarded_heights[i];
    }
    remove(whole, moved);
    const std::int64_t left = contact_time(read_feet().feet);
    clip_ = std::move(uncorrected);
    return static_cast<double>(left) < kLeastShare * static_cast<double>(contact_time(feet));
  }

  [[nodiscard]] std::string root_note(const RootDrift& found, const RootEvidence& evidence) const {
    return fmt::format("the root moved by up to {} m, because ", number_text(found.farthest, 2)) +
           root_reason(found, evidence);
  }

  // The evidence that started the correction. Feet that climb slowly hardly slide.
  [[nodiscard]] std::string root_reason(const RootDrift& found,
                                        const RootEvidence& evidence) const {
    constexpr double kSlides = 0.05;  // m/s
    const auto climbed = [](double metres) {
      return fmt::format("standing feet {} by {} m over the clip", metres > 0.0 ? "rose" : "sank",
                         number_text(std::abs(metres), 2));
    };
    const bool slid = found.speed_before > kSlides && found.speed_left < found.speed_before;
    if (slid && (jittery_ || found.calms_feet())) {
      return fmt::format("standing feet slid at {} m/s; now {} m/s",
                         number_text(found.speed_before, 2), number_text(found.speed_left, 2));
    }
    if (evidence.climbs_steadily) return climbed(evidence.climb);
    if (!jittery_ && !found.calms_feet()) return climbed(found.climb_before);
    if (jittery_) return "the joints had noise";
    if (evidence.shake_speed > kClimbSpeed) {
      return fmt::format("standing feet rose and sank at {} m/s",
                         number_text(evidence.shake_speed, 2));
    }
    // The median speed is low if the feet slid for a part of the time.
    return fmt::format("standing feet slid at {} m/s",
                       number_text(std::max(evidence.speed, evidence.single_speed), 2));
  }

  // @param speed  median speed of standing feet, m/s for a body with legs of kUsualSourceLeg
  void hold_feet(int moved, double speed) {
    const bool of_positions = has_positions_only(clip_);
    // Noise of positions is an upper bound. Speeds of noise rarely exceed four times their median.
    constexpr double kRarely = 4.0;
    if (of_positions) {
      report_.foot_noise.speed = std::min(report_.foot_noise.speed, kRarely * speed);
    }
    // The fit holds slower feet by itself; noise of that size looks like slow steps.
    constexpr double kSlow = 0.07;
    const double of_noise = std::min(speed, report_.foot_noise.speed);
    NoisyFeet held;
    if (of_noise > kSlow) {
      held =
          plant_noisy_feet(clip_, part_, calibration_, moved, of_noise, report_.foot_noise.wander);
    }
    if (held.stances == 0 && !of_positions) {
      // Stances that are not held end where the noise peaks.
      constexpr double kPeaks = 1.5;
      report_.foot_noise.speed *= kPeaks;
    }
    if (held.stances == 0) return;
    report_.notes.push_back(fmt::format("{} of feet held: the legs turn, ankles by up to {} m",
                                        count_text(held.stances, "stance"),
                                        number_text(held.farthest, 2)));
  }

  // Sum over the ends of feet, in frames.
  static std::int64_t contact_time(const SourceFeet& feet) {
    std::int64_t sum = 0;
    const ContactPlan contacts = find_contacts(feet, {});
    for (const auto& foot : contacts.ends) {
      for (const EndContacts& end : foot) {
        for (const ContactPhase& phase : end.phases) sum += phase.end - phase.begin;
      }
    }
    return sum;
  }

  void remove(const std::vector<Vector3d>& drift, int joint) {
    for (int frame = part_.begin; frame < part_.end; ++frame) {
      const Vector3d& now = drift[static_cast<std::size_t>(frame - part_.begin)];
      move_body(clip_, frame, calibration_, joint, -now);
    }
  }

  Clip& clip_;
  FrameRange part_;
  const Calibration& calibration_;
  RootRule root_;
  bool jittery_ = false;  // The limbs had noise, and some of it remains.
  CleanReport report_;
};

}  // namespace

CleanReport clean_clip(Clip& clip, FrameRange part, const Calibration& calibration,
                       const FootNoise& foot_noise, RootRule root) {
  return ClipCleaner(clip, part, calibration, foot_noise, root).clean();
}

namespace {

// World positions, indexed by joint and frame.
std::vector<std::vector<Vector3d>> position_tracks(const Clip& clip) {
  const auto joints = static_cast<std::size_t>(clip.skeleton().joint_count());
  std::vector<std::vector<Vector3d>> tracks(joints);
  std::vector<Pose> world(joints);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, world);
    for (std::size_t joint = 0; joint < joints; ++joint) {
      tracks[joint].push_back(world[joint].translation);
    }
  }
  return tracks;
}

// Longest side of the body's axis-aligned bounding box, median over the frames.
double body_extent(const std::vector<std::vector<Vector3d>>& tracks) {
  std::vector<double> extents;
  for (std::size_t frame = 0; frame < tracks.front().size(); ++frame) {
    Eigen::AlignedBox3d box;
    for (const auto& track : tracks) box.extend(track[frame]);
    extents.push_back(box.sizes().maxCoeff());
  }
  return median(extents);
}

JointMotion motion_of(const Clip& clip, const std::vector<std::vector<Vector3d>>& tracks) {
  JointMotion motion;
  motion.frame_count = clip.frame_count();
  motion.joint_count = clip.skeleton().joint_count();
  motion.names = clip.skeleton().names();
  motion.rate = clip.rate();
  motion.height = clip.origin().body_height;
  motion.up = clip.origin().up;
  for (std::size_t frame = 0; frame < tracks.front().size(); ++frame) {
    for (const auto& track : tracks) motion.positions.push_back(track[frame]);
  }
  return motion;
}

// Replaces the positions and recomputes the rotations. @return false if the clip is unchanged.
bool remake(Clip& clip, const std::vector<std::vector<Vector3d>>& tracks) {
  auto remade = clip_of_joints(motion_of(clip, tracks), clip.name());
  // The bone map refers to joints by index, so their order must not change.
  if (!remade || remade->skeleton().names() != clip.skeleton().names()) return false;
  remade->set_origin(clip.origin());
  clip = *std::move(remade);
  return true;
}

// Least movement of joints that are wrong, as a share of the body's extent: 10 cm.
constexpr double kLeastFault = 0.06;

}  // namespace

SideSwaps undo_position_swaps(Clip& clip) {
  if (!has_positions_only(clip)) return {};
  std::vector<std::vector<Vector3d>> tracks = position_tracks(clip);
  SideSwaps found =
      undo_side_swaps(tracks, clip.skeleton().names(), kLeastFault * body_extent(tracks));
  if (!found.undone.empty() && !remake(clip, tracks)) return {};
  return found;
}

std::vector<std::string> bridge_position_spikes(Clip& clip) {
  if (!has_positions_only(clip)) return {};
  std::vector<std::vector<Vector3d>> tracks = position_tracks(clip);
  std::vector<std::string> found = bridge_spikes(tracks, clip.skeleton().names(), clip.rate(),
                                                 kLeastFault * body_extent(tracks));
  if (found.empty() || !remake(clip, tracks)) return {};
  return found;
}

PositionJitter clean_positions(Clip& clip) {
  constexpr double kStep = 0.003;       // Share of the body's extent.
  constexpr double kSlowest = 2.0;      // Hz
  constexpr double kUsualExtent = 1.7;  // Metres, of a body with legs of kUsualSourceLeg.
  if (!has_positions_only(clip)) return {};
  std::vector<std::vector<Vector3d>> tracks = position_tracks(clip);
  const double extent = body_extent(tracks), frame_time = clip.rate().frame_time();
  std::vector<double> steps;
  std::vector<TrackNoise> noises;
  for (const auto& track : tracks) {
    noises.push_back(measure_noise(track));
    if (noises.back().exceeds(kStep * extent)) steps.push_back(noises.back().step);
  }
  if (2 * steps.size() < tracks.size()) return {};
  std::vector<double> speeds, wanders;
  for (std::size_t joint = 0; joint < tracks.size(); ++joint) {
    if (!noises[joint].may_exceed(0.0)) continue;
    // Estimates from video also have slow errors, which faster ones may hide.
    const NoisePower power = NoisePower::of(noises[joint], false);
    const auto cutoff = best_cutoff(tracks[joint], power, frame_time, kSlowest);
    const double strength = cutoff ? smoothing_strength(*cutoff, frame_time) : 0.0;
    if (cutoff) tracks[joint] = smoothed(tracks[joint], strength);
    const NoiseRest rest = rest_of(power, strength, frame_time);
    speeds.push_back(rest.speed);
    wanders.push_back(rest.wander);
  }
  if (speeds.empty() || !remake(clip, tracks)) return {};
  const double metres = kUsualExtent / extent;
  return {fmt::format("jitter of {} % of the body size per frame (median of {} of {}) smoothed",
                      number_text(100.0 * median(steps) / extent, 1), steps.size(),
                      count_text(tracks.size(), "joint")),
          {metres * median(speeds), metres * median(wanders)}};
}

}  // namespace retarget
