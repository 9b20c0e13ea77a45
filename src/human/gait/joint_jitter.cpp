#include "human/gait/joint_jitter.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <span>

#include "human/gait/source_feet.h"
#include "human/gait/track_noise.h"
#include "retarget/statistics.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// A part of the body. Necks, heads, collars and toes are not judged: in good motion capture their
// small rotations are often noisy.
struct JitterLimb {
  const char* name;
  std::array<Bone, 3> judged;    // May repeat bones.
  std::array<Bone, 4> smoothed;  // May repeat bones.
  int fewest;                    // Jittery joints that make the limb jittery.
  std::array<bool, 2> feet;      // That it moves: left, right.

  [[nodiscard]] constexpr bool moves_feet() const { return feet[0] || feet[1]; }
};

using enum Bone;

constexpr std::array kJitterLimbs = {
    JitterLimb{"the hips", {kHips, kHips, kHips}, {kHips, kHips, kHips, kHips}, 1, {true, true}},
    JitterLimb{"the left leg",
               {kLeftUpLeg, kLeftLeg, kLeftFoot},
               {kLeftUpLeg, kLeftLeg, kLeftFoot, kLeftToe},
               2,
               {true, false}},
    JitterLimb{"the right leg",
               {kRightUpLeg, kRightLeg, kRightFoot},
               {kRightUpLeg, kRightLeg, kRightFoot, kRightToe},
               2,
               {false, true}},
    JitterLimb{"the spine",
               {kSpine, kSpine1, kSpine2},
               {kSpine, kSpine1, kSpine2, kSpine2},
               2,
               {false, false}},
    JitterLimb{"the left arm",
               {kLeftArm, kLeftForeArm, kLeftHand},
               {kLeftShoulder, kLeftArm, kLeftForeArm, kLeftHand},
               2,
               {false, false}},
    JitterLimb{"the right arm",
               {kRightArm, kRightForeArm, kRightHand},
               {kRightShoulder, kRightArm, kRightForeArm, kRightHand},
               2,
               {false, false}}};

class JitterSearch {
 public:
  JitterSearch(const Clip& clip, FrameRange part, const Calibration& calibration)
      : clip_(clip), part_(part), calibration_(calibration) {
    for (const int joint : joints_of(kMappedBones)) {
      noises_[joint] = measure_noise(rotation_track(clip, part, joint));
    }
  }

  // Half of all moving joints.
  [[nodiscard]] JointJitter of_body() const {
    constexpr int kFewest = 5;  // Joints.
    JointJitter found;
    int moving = 0;
    std::vector<TrackNoise> jittery;
    for (const auto& [joint, noise] : noises_) {
      moving += noise.moves ? 1 : 0;
      if (!noise.exceeds(kLargeStep)) continue;
      jittery.push_back(noise);
      found.steps.push_back(noise.step);
    }
    found.white = has_white_noise(jittery);
    if (moving < kFewest || 2 * static_cast<int>(found.steps.size()) < moving) return {};
    found.joints.resize(static_cast<std::size_t>(clip_.skeleton().joint_count()));
    std::iota(found.joints.begin(), found.joints.end(), 0);
    found.of = fmt::format("{} of {}", found.steps.size(), count_text(moving, "joint"));
    return found;
  }

  [[nodiscard]] JointJitter of_limbs() {
    // Noise in a few limbs only is less certain, so it has to be stronger.
    constexpr std::size_t kMany = kJitterLimbs.size() / 2;
    constexpr double kStrong = 2.0 * kLargeStep;
    std::vector<const JitterLimb*> limbs = jittery_limbs(kLargeStep);
    if (limbs.size() < kMany) limbs = jittery_limbs(kStrong);
    if (hides_noise_of_legs(limbs)) return {};
    JointJitter found;
    std::vector<std::string> names;
    std::set<int> joints;
    std::vector<TrackNoise> jittery;
    for (const JitterLimb* limb : limbs) {
      for (const TrackNoise& noise : jitter_of(*limb)) {
        found.steps.push_back(noise.step);
        if (noise.exceeds(kLargeStep)) jittery.push_back(noise);
      }
      names.emplace_back(limb->name);
      joints.merge(joints_of(limb->smoothed));
    }
    found.white = has_white_noise(jittery);
    found.joints.assign(joints.begin(), joints.end());
    found.of = count_text(found.steps.size(), "joint") + " of " + list_names(names);
    return found;
  }

 private:
  // Noise in the hips and other limbs, but not in the legs, is probably noise of the whole body,
  // which fast legs hide. Smoothing the rest alone would move the feet.
  [[nodiscard]] static bool hides_noise_of_legs(const std::vector<const JitterLimb*>& limbs) {
    const auto are_hips = [](const JitterLimb* limb) { return limb->feet[0] && limb->feet[1]; };
    const auto is_leg = [](const JitterLimb* limb) { return limb->feet[0] != limb->feet[1]; };
    return limbs.size() > 1 && std::ranges::any_of(limbs, are_hips) &&
           std::ranges::none_of(limbs, is_leg);
  }

  // @param least  median step of their noise, rad per frame
  [[nodiscard]] std::vector<const JitterLimb*> jittery_limbs(double least) {
    std::vector<const JitterLimb*> limbs;
    for (const JitterLimb& limb : kJitterLimbs) {
      std::vector<double> steps;
      for (const TrackNoise& noise : jitter_of(limb)) steps.push_back(noise.step);
      if (steps.empty() || !(median(steps) > least)) continue;
      if (!limb.moves_feet() || shakes_feet(limb, median(steps))) limbs.push_back(&limb);
    }
    return limbs;
  }

  // Joints that rotate bones; excludes fingers.
  [[nodiscard]] std::set<int> joints_of(std::span<const Bone> bones) const {
    std::set<int> joints;
    for (const Bone bone : bones) {
      const int joint = calibration_.bones[bone].rotation_joint;
      if (joint >= 0) joints.insert(joint);
    }
    return joints;
  }

  // Noise of the joints that have it; empty if it is not certain. The worst joints must correlate
  // like noise in the mean, because the movement of a fast knee or foot hides a part of that.
  [[nodiscard]] std::vector<TrackNoise> jitter_of(const JitterLimb& limb) const {
    constexpr double kCorrelation = -0.25;
    std::vector<TrackNoise> noisy;
    for (const int joint : joints_of(limb.judged)) {
      const TrackNoise& noise = noises_.at(joint);
      if (noise.may_exceed(kLargeStep)) noisy.push_back(noise);
    }
    if (static_cast<int>(noisy.size()) < limb.fewest) return {};
    std::ranges::sort(noisy, {}, &TrackNoise::correlation);
    double sum = 0.0;
    for (int i = 0; i < limb.fewest; ++i) sum += noisy[static_cast<std::size_t>(i)].correlation;
    const bool certain = sum < kCorrelation * limb.fewest;
    if (!certain && !is_strong(limb)) return {};
    return noisy;
  }

  // Fast movements in few frames look like noise, but in them feet stand between the steps. Noise
  // moves feet in every frame.
  // @param step  step of the noise, rad per frame
  [[nodiscard]] bool shakes_feet(const JitterLimb& limb, double step) {
    constexpr double kPercent = 15.0, kShare = 0.12;  // Rotations about the leg do not move a foot.
    if (!feet_) feet_ = feet_and_hips(clip_, calibration_, part_).feet;
    const SourceFeet& feet = *feet_;
    if (feet.foot_count != 2) return false;
    const double least = kShare * step * feet.leg_length();
    for (int foot = 0; foot < 2; ++foot) {
      if (!limb.feet[static_cast<std::size_t>(foot)]) continue;
      std::vector<double> moves;
      for (int frame = 0; frame + 1 < feet.frame_count(); ++frame) {
        const SourceFoot &from = feet.at(frame, foot), &to = feet.at(frame + 1, foot);
        moves.push_back(std::min((to.ankle - from.ankle).norm(), (to.toe - from.toe).norm()));
      }
      if (moves.empty() || percentile(moves, kPercent) < least) return false;
    }
    return true;
  }

  // Whether every joint has strong noise by the differences of its changes: a fast movement hides
  // the correlation of the changes themselves.
  [[nodiscard]] bool is_strong(const JitterLimb& limb) const {
    constexpr double kStep = 4.0 * kLargeStep, kSharpCorrelation = -0.4;
    const std::set<int> joints = joints_of(limb.judged);
    return std::ranges::all_of(joints, [&](int joint) {
      const TrackNoise& noise = noises_.at(joint);
      return noise.may_exceed(kStep) && noise.sharp_correlation < kSharpCorrelation;
    });
  }

  const Clip& clip_;
  FrameRange part_;
  const Calibration& calibration_;
  std::map<int, TrackNoise> noises_;
  std::optional<SourceFeet> feet_;  // Once needed.
};

}  // namespace

std::vector<Eigen::Quaterniond> rotation_track(const Clip& clip, FrameRange part, int joint) {
  std::vector<Eigen::Quaterniond> rotations;
  for (int frame = part.begin; frame < part.end; ++frame) {
    Eigen::Quaterniond rotation = clip.rotations(frame)[static_cast<std::size_t>(joint)];
    if (!rotations.empty() && rotations.back().dot(rotation) < 0.0) {
      rotation.coeffs() = -rotation.coeffs();
    }
    rotations.push_back(rotation);
  }
  return rotations;
}

JointJitter find_jitter(const Clip& clip, FrameRange part, const Calibration& calibration) {
  // In fewer frames or at a lower rate, a fast movement can look like the noise of a limb.
  constexpr int kFewest = 60;
  constexpr double kLongest = 1.0 / 22.0;  // Seconds per frame.
  JitterSearch search(clip, part, calibration);
  JointJitter found = search.of_body();
  const bool may_judge = part.end - part.begin >= kFewest && clip.rate().frame_time() < kLongest;
  return found.joints.empty() && may_judge ? search.of_limbs() : found;
}

}  // namespace retarget
