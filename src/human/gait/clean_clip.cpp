#include "human/gait/clean_clip.h"

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <set>
#include <utility>

#include "formats/smpl/joint_motion.h"
#include "human/gait/contact_plan.h"
#include "human/gait/plant_noisy_feet.h"
#include "human/gait/repeated_frames.h"
#include "human/gait/root_drift.h"
#include "human/gait/source_feet.h"
#include "human/gait/track_faults.h"
#include "human/gait/track_spikes.h"
#include "human/skeleton/human_clip.h"
#include "human/skeleton/joint_clip.h"
#include "retarget/statistics.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

class ClipCleaner {
 public:
  ClipCleaner(Clip& clip, FrameRange part, const Calibration& calibration, bool jittery)
      : clip_(clip), part_(part), calibration_(calibration), jittery_(jittery) {}

  CleanReport clean() {
    constexpr int kFewest = 3;  // Frames.
    if (part_.end - part_.begin < kFewest) return {};
    bridge();
    // Rotations computed from positions follow the smoothed positions.
    if (clip_.origin().unknown_rotations.empty() && smooth_rotations()) {
      jittery_ = true;
      fix_lengths();
    }
    move_root();
    return std::move(report_);
  }

 private:
  void bridge() {
    if (const int frozen = bridge_frozen_frames(clip_, part_); frozen > 0) {
      report_.notes.push_back(count_text(frozen, "frozen frame") + " bridged");
    }
    for (const std::string& lost : bridge_lost_joints(clip_, part_)) {
      report_.notes.push_back(lost + ": bridged");
    }
    // Positions that have noise were smoothed before their rotations were computed.
    if (!clip_.origin().unknown_rotations.empty()) return;
    for (const std::string& spike : bridge_spikes(clip_, part_, calibration_.metres_per_unit)) {
      report_.notes.push_back(spike + ": bridged");
    }
  }

  // Consecutive quaternions have a dot product >= 0.
  [[nodiscard]] std::vector<Quaterniond> track(int joint) const {
    std::vector<Quaterniond> rotations;
    for (int frame = part_.begin; frame < part_.end; ++frame) {
      Quaterniond rotation = std::as_const(clip_).rotations(frame)[static_cast<std::size_t>(joint)];
      if (!rotations.empty() && rotations.back().dot(rotation) < 0.0) {
        rotation.coeffs() = -rotation.coeffs();
      }
      rotations.push_back(rotation);
    }
    return rotations;
  }

  // Joints that rotate bones; excludes fingers.
  [[nodiscard]] std::set<int> turning_joints() const {
    std::set<int> joints;
    for (const Bone bone : kMappedBones) {
      const int joint = calibration_.bones[bone].rotation_joint;
      if (joint >= 0) joints.insert(joint);
    }
    return joints;
  }

  bool smooth_rotations() {
    constexpr int kFewest = 5;        // Joints.
    constexpr double kSlowest = 1.5;  // Hz
    const double frame_time = clip_.rate().frame_time();
    std::vector<double> steps;
    int moving = 0;
    for (const int joint : turning_joints()) {
      const TrackNoise noise = measure_noise(track(joint), frame_time);
      moving += noise.moves ? 1 : 0;
      if (noise.exceeds(kLargeStep)) steps.push_back(noise.step);
    }
    if (moving < kFewest || 2 * static_cast<int>(steps.size()) < moving) return false;
    std::vector<double> cutoffs;
    for (int joint = 0; joint < clip_.skeleton().joint_count(); ++joint) {
      const std::vector<Quaterniond> rotations = track(joint);
      const TrackNoise noise = measure_noise(rotations, frame_time);
      if (!noise.may_exceed(kSmallStep)) continue;
      cutoffs.push_back(cutoff_for(noise, frame_time, kSlowest));
      const auto smooth = smoothed(rotations, cutoffs.back(), frame_time);
      for (int frame = part_.begin; frame < part_.end; ++frame) {
        clip_.rotations(frame)[static_cast<std::size_t>(joint)] =
            smooth[static_cast<std::size_t>(frame - part_.begin)];
      }
    }
    // The remaining noise is slow. Estimate its speed from the drift of a straight leg over kTime.
    constexpr double kTime = 0.125;  // Seconds.
    report_.foot_speed = kUsualSourceLeg * median(steps) / std::sqrt(kTime * frame_time);
    const auto [slowest, fastest] = std::ranges::minmax(cutoffs);
    report_.notes.push_back(fmt::format(
        "jitter of {} degrees per frame (median of {} of {}) smoothed, cutoffs {} to {} Hz",
        number_text(median(steps) * 180.0 / std::numbers::pi, 1), steps.size(),
        count_text(moving, "joint"), number_text(slowest, 1), number_text(fastest, 1)));
    return true;
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

  struct FeetAndHips {
    SourceFeet feet;
    std::vector<Vector3d> hips;
  };

  [[nodiscard]] FeetAndHips read_feet() const {
    HumanPoser poser(clip_, calibration_);
    FeetAndHips read{SourceFeet(poser.info()), {}};
    HumanPose pose;
    for (int frame = part_.begin; frame < part_.end; ++frame) {
      poser.pose(frame, pose);
      read.feet.add(pose);
      read.hips.push_back(pose[Bone::kHips].translation);
    }
    return read;
  }

  void move_root() {
    const int moved = body_joint(clip_.skeleton(), calibration_);
    if (moved < 0) return;
    const auto [feet, hips] = read_feet();
    if (feet.foot_count == 0) return;
    const RootEvidence evidence = measure_root(feet);
    if (!jittery_ && !evidence.moves()) return;
    // This drift is not the path of a body whose root translation is missing: correcting it would
    // cover a part of the path and hide the fault from the gates.
    if (!jittery_ && root_is_missing(feet, hips)) return;
    const RootDrift found = find_root_drift(feet, hips, {jittery_, jittery_ || evidence.climbs()});
    if (found.drift.empty() || (!jittery_ && !found.helps())) return;
    Clip uncorrected = clip_;
    remove(found.drift, moved);
    // In a fast run with noise few feet stand, and the solution follows those that swing.
    constexpr double kLeastShare = 0.7;
    if (!jittery_ && contact_time(read_feet().feet) < kLeastShare * contact_time(feet)) {
      clip_ = std::move(uncorrected);
      return;
    }
    report_.notes.push_back(root_note(found));
    report_.root_moved = found.farthest;
    if (jittery_) hold_feet(moved, found.speed_after * kUsualSourceLeg / feet.leg_length());
  }

  static std::string root_note(const RootDrift& found) {
    const std::string moved =
        fmt::format("the root moved by up to {} m, because ", number_text(found.farthest, 2));
    if (!found.calms_feet() && found.helps()) {
      return moved + fmt::format("standing feet {} by {} m over the clip",
                                 found.climb_before > 0.0 ? "rose" : "sank",
                                 number_text(std::abs(found.climb_before), 2));
    }
    return moved + fmt::format("standing feet slid at {} m/s; now {} m/s",
                               number_text(found.speed_before, 2),
                               number_text(found.speed_after, 2));
  }

  // @param speed  median speed of standing feet, m/s for a body with legs of kUsualSourceLeg
  void hold_feet(int moved, double speed) {
    // The fit holds slower feet by itself; noise of that size looks like slow steps.
    constexpr double kSlow = 0.07;
    NoisyFeet held;
    if (speed > kSlow) held = plant_noisy_feet(clip_, part_, calibration_, moved, speed);
    if (held.stances == 0) {
      // Speeds rarely exceed three times the median.
      report_.foot_speed = std::max(report_.foot_speed, 3.0 * speed);
      return;
    }
    // At the edges of stances some noise remains.
    constexpr double kShare = 4.0;
    report_.foot_speed = kShare * speed;
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
  bool jittery_;  // The limbs had noise, and some of it remains.
  CleanReport report_;
};

}  // namespace

CleanReport clean_clip(Clip& clip, FrameRange part, const Calibration& calibration, bool jittery) {
  return ClipCleaner(clip, part, calibration, jittery).clean();
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
  for (std::size_t frame = 0; frame < tracks.front().size(); ++frame) {
    for (const auto& track : tracks) motion.positions.push_back(track[frame]);
  }
  return motion;
}

}  // namespace

std::string clean_positions(Clip& clip) {
  constexpr double kStep = 0.003;   // Share of the body's extent.
  constexpr double kSlowest = 2.0;  // Hz
  if (clip.origin().unknown_rotations.empty() || clip.frame_count() == 0) return {};
  std::vector<std::vector<Vector3d>> tracks = position_tracks(clip);
  const double extent = body_extent(tracks), frame_time = clip.rate().frame_time();
  std::vector<double> steps;
  std::vector<TrackNoise> noises;
  for (const auto& track : tracks) {
    noises.push_back(measure_noise(track, frame_time));
    if (noises.back().exceeds(kStep * extent)) steps.push_back(noises.back().step);
  }
  if (2 * steps.size() < tracks.size()) return {};
  for (std::size_t joint = 0; joint < tracks.size(); ++joint) {
    if (!noises[joint].may_exceed(0.0)) continue;
    const double cutoff = cutoff_for(noises[joint], frame_time, kSlowest);
    tracks[joint] = smoothed(tracks[joint], cutoff, frame_time);
  }
  auto remade = clip_of_joints(motion_of(clip, tracks), clip.name());
  // The bone map refers to joints by index, so their order must not change.
  if (!remade || remade->skeleton().names() != clip.skeleton().names()) return {};
  remade->set_origin(clip.origin());
  clip = *std::move(remade);
  return fmt::format("jitter of {} % of the body size per frame (median of {} of {}) smoothed",
                     number_text(100.0 * median(steps) / extent, 1), steps.size(),
                     count_text(tracks.size(), "joint"));
}

}  // namespace retarget
