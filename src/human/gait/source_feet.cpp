#include "human/gait/source_feet.h"

#include <algorithm>
#include <cmath>

#include "base/math/gravity.h"
#include "retarget/human_poser.h"
#include "retarget/human_skeleton.h"
#include "retarget/pose.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

// The speed is the minimum over two windows: two frames, and this time. The short window detects a
// foot coming to rest early at any frame rate; the long one is robust against noise at high rates.
constexpr double kSpeedTime = 1.0 / 15.0;

// m/s, over `half` frames on either side.
template <typename PlaceAt>
double speed_over(const SourceFeet& source, int frame, int half, const PlaceAt& place_at) {
  const int from = std::max(frame - half, 0), to = std::min(frame + half, source.frame_count() - 1);
  if (to == from) return 0.0;
  return (place_at(to) - place_at(from)).norm() / (source.frame_time * (to - from));
}

template <typename PlaceAt>
double short_speed(const SourceFeet& source, int frame, const PlaceAt& place_at) {
  const int half = static_cast<int>(std::lround(0.5 * kSpeedTime / source.frame_time));
  const double shortly = speed_over(source, frame, 1, place_at);
  return half <= 1 ? shortly : std::min(shortly, speed_over(source, frame, half, place_at));
}

// Position of an end of the sole. Its height is the height of the lowest point, so a rolling foot
// stands on its tip; its horizontal position is fixed in the foot.
Eigen::Vector3d lower_end(const Pose& world_from_sole, const SoleEnd& end) {
  Eigen::Vector3d place = world_from_sole * end.middle;
  place.z() = std::min(place.z(), (world_from_sole * end.tip).z());
  return place;
}

// Position of a shoulder, or of the lower of both ends of the skull.
Eigen::Vector3d upper_place(const HumanPose& pose, Bone bone, double scale) {
  constexpr double kSkull = 0.1;  // From the joint of the head to the middle of the skull, metres.
  const Pose& joint = pose[bone];
  if (bone != Bone::kHead) return joint.translation;
  const Eigen::Vector3d top = joint * Eigen::Vector3d(kSkull * scale, 0.0, 0.0);
  return top.z() < joint.translation.z() ? top : joint.translation;
}

}  // namespace

SourceFeet::SourceFeet(const HumanClipInfo& human)
    : frame_time(human.rate.frame_time()), soles(human.soles), has_hips_(human.has(Bone::kHips)) {
  for (std::size_t foot = kSides.size(); foot-- > 0;) {
    const auto has_part = [&](LimbBone part) { return human.has(side_bone(kSides[foot], part)); };
    has_ankle[foot] = has_part(LimbBone::kFoot);
    // A toe without its ankle is not a usable foot.
    has_toe[foot] = has_ankle[foot] && has_part(LimbBone::kToe);
    if (!has_ankle[foot] || !has_part(LimbBone::kUpLeg) || !has_part(LimbBone::kLeg)) continue;
    leg_ = kSides[foot];
    foot_count = static_cast<int>(kSides.size());
  }
  for (std::size_t i = 0; i < kSupportBones.size(); ++i) {
    has_support[i] = human.has(kSupportBones[i]);
  }
  for (std::size_t i = 0; i < kUpperBones.size(); ++i) has_upper[i] = human.has(kUpperBones[i]);
}

SourceFeet::SourceFeet(const HumanClip& human, int frames) : SourceFeet(human) {
  for (int frame = 0; frame < frames; ++frame) add(human.frame(frame));
}

void SourceFeet::add(const HumanPose& pose) {
  if (has_hips_) hips.push_back(pose[Bone::kHips].translation.z());
  if (foot_count == 0) return;
  const auto joint = [&](LimbBone part) { return pose[side_bone(leg_, part)].translation; };
  legs.push_back((joint(LimbBone::kUpLeg) - joint(LimbBone::kLeg)).norm() +
                 (joint(LimbBone::kLeg) - joint(LimbBone::kFoot)).norm());
  for (std::size_t foot = 0; foot < kSides.size(); ++foot) {
    const Side side = kSides[foot];
    const Bone bone = side_bone(side, LimbBone::kFoot);
    const Pose &ankle = pose[bone], &toe = pose[side_bone(side, LimbBone::kToe)];
    const Eigen::Vector3d up_in_foot =
        canonical_t_pose(bone).transpose() * Eigen::Vector3d::UnitZ();
    // For standing toes, y points up and z sideways.
    feet.push_back({ankle.translation, toe.translation,
                    (toe.rotation * Eigen::Vector3d::UnitY()).z(),
                    (toe.rotation * Eigen::Vector3d::UnitZ()).z(),
                    (ankle.rotation * up_in_foot).z(), std::nullopt});
    if (!soles[foot]) continue;
    const Pose& sole = pose[side_bone(side, LimbBone::kFootMod)];
    feet.back().heel = lower_end(sole, soles[foot]->heel);
    feet.back().toe = lower_end(sole, soles[foot]->toe);
    feet.back().down = -(ankle.rotation * Eigen::Vector3d::UnitX()).z();
  }
  for (const Bone bone : kSupportBones) supports.push_back(pose[bone].translation);
  const double scale = legs.back() / kUsualSourceLeg;
  for (const Bone bone : kUpperBones) uppers.push_back(upper_place(pose, bone, scale));
}

SourceFeet SourceFeet::before_pace(double pace) const {
  SourceFeet feet_before = *this;
  feet_before.frame_time /= pace;
  return feet_before;
}

void SourceFeet::forget(int frames) {
  const auto drop = [frames](auto& values, std::size_t of_frame) {
    const std::size_t count = std::min(values.size(), static_cast<std::size_t>(frames) * of_frame);
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
  };
  drop(feet, static_cast<std::size_t>(foot_count));
  drop(legs, 1);
  drop(hips, 1);
  drop(supports, kSupportBones.size());
  drop(uppers, kUpperBones.size());
}

void SourceFeet::reserve(int frames) {
  const auto count = static_cast<std::size_t>(frames);
  feet.reserve(count * static_cast<std::size_t>(foot_count));
  legs.reserve(count);
  hips.reserve(count);
  supports.reserve(count * kSupportBones.size());
  uppers.reserve(count * kUpperBones.size());
}

double SourceFeet::ankle_over_heel() const {
  // The y axis of FootMod points up.
  double sum = 0.0;
  int known = 0;
  for (const auto& sole : soles) {
    if (!sole) continue;
    sum -= sole->heel.middle.y();
    ++known;
  }
  return known == 0 ? 0.0 : sum / known;
}

double SourceFeet::leg_length() const {
  std::vector<double> scratch;
  return leg_length(scratch);
}

double SourceFeet::leg_length(std::vector<double>& scratch) const {
  scratch.assign(legs.begin(), legs.end());
  return scratch.empty() ? kUsualSourceLeg : median_in_place(scratch);
}

double SourceFeet::speed(int frame, int foot, int end) const {
  return short_speed(*this, frame, [&](int t) { return at(t, foot).end(end); });
}

double SourceFeet::support_speed(int frame, std::size_t index) const {
  return short_speed(*this, frame, [&](int t) { return support(t, index); });
}

FeetAndHips feet_and_hips(const Clip& clip, const Calibration& calibration, FrameRange part) {
  HumanPoser poser(clip, calibration);
  FeetAndHips found{SourceFeet(poser.info()), {}};
  HumanPose pose;
  for (int frame = part.begin; frame < part.end; ++frame) {
    poser.pose(frame, pose);
    found.feet.add(pose);
    found.hips.push_back(pose[Bone::kHips].translation);
  }
  return found;
}

double leg_length(const HumanClip& human) {
  const SourceFeet feet(human, human.frame_count);
  return feet.legs.empty() ? 0.0 : feet.leg_length();
}

bool falls_freely(std::span<const double> hips, double frame_time, double share) {
  const double steps = static_cast<double>(hips.size()) - 1.0;
  const double slope = (hips.back() - hips.front()) / std::max(1.0, steps);
  double rise = 0.0;
  for (std::size_t i = 0; i < hips.size(); ++i) {
    rise = std::max(rise, hips[i] - hips.front() - slope * static_cast<double>(i));
  }
  const double time = steps * frame_time;
  return rise >= share * kGravity * (time * time) / 8.0;
}

}  // namespace retarget
