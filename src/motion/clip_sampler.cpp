#include "retarget/motion/clip_sampler.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "motion/clip_tracks.h"
#include "retarget/math/spline.h"

namespace retarget {
namespace {

// in frames; times computed from frame numbers are off by rounding
constexpr double kSnapTolerance = 1e-9;

}  // namespace

ClipSampler::ClipSampler(Clip clip, Interpolation interpolation)
    : clip_(std::move(clip)), interpolation_(interpolation) {
  make_sign_continuous(clip_);
  if (interpolation_ == Interpolation::kCubic && clip_.frame_count() > 0) prepare_velocities();
}

void ClipSampler::prepare_velocities() {
  const auto frames = static_cast<std::size_t>(clip_.frame_count());
  const std::size_t joints = clip_.skeleton().joint_count();
  const std::size_t translated = clip_.skeleton().translated_count();
  angular_velocities_.resize(frames * joints);
  linear_velocities_.resize(frames * translated);
  for (std::size_t joint = 0; joint < joints; ++joint) {
    const auto velocities = spline_velocities(steps_between(rotation_track(clip_, joint)));
    for (std::size_t i = 0; i < frames; ++i)
      angular_velocities_[i * joints + joint] = velocities[i];
  }
  for (std::size_t slot = 0; slot < translated; ++slot) {
    const auto velocities = spline_velocities(steps_between(translation_track(clip_, slot)));
    for (std::size_t i = 0; i < frames; ++i)
      linear_velocities_[i * translated + slot] = velocities[i];
  }
}

void ClipSampler::sample(int frame, double fraction, std::span<Eigen::Quaterniond> rotations,
                         std::span<Eigen::Vector3d> translations) const {
  assert(0 <= frame && frame < clip_.frame_count());
  const auto rotations_before = clip_.rotations(frame);
  const auto translations_before = clip_.translations(frame);
  if (fraction == 0.0 || frame + 1 == clip_.frame_count()) {
    std::ranges::copy(rotations_before, rotations.begin());
    std::ranges::copy(translations_before, translations.begin());
    return;
  }

  const auto rotations_after = clip_.rotations(frame + 1);
  const auto translations_after = clip_.translations(frame + 1);
  const std::size_t joints = rotations_before.size();
  const std::size_t translated = translations_before.size();
  if (interpolation_ == Interpolation::kLinear) {
    for (std::size_t i = 0; i < joints; ++i) {
      rotations[i] = interpolate_linear(rotations_before[i], rotations_after[i], fraction);
    }
    for (std::size_t i = 0; i < translated; ++i) {
      translations[i] =
          translations_before[i] + fraction * (translations_after[i] - translations_before[i]);
    }
    return;
  }
  const Eigen::Vector3d* angular = angular_velocities_.data() + frame * joints;
  for (std::size_t i = 0; i < joints; ++i) {
    rotations[i] = interpolate_cubic(rotations_before[i], angular[i], rotations_after[i],
                                     angular[joints + i], fraction);
  }
  const Eigen::Vector3d* linear = linear_velocities_.data() + frame * translated;
  for (std::size_t i = 0; i < translated; ++i) {
    translations[i] = interpolate_cubic(translations_before[i], linear[i], translations_after[i],
                                        linear[translated + i], fraction);
  }
}

void ClipSampler::sample(double time, std::span<Eigen::Quaterniond> rotations,
                         std::span<Eigen::Vector3d> translations) const {
  const int last = clip_.frame_count() - 1;
  const double place = time * clip_.rate().fps();
  if (!(place > 0.0)) return sample(0, 0.0, rotations, translations);
  if (place >= last) return sample(last, 0.0, rotations, translations);
  const double nearest = std::round(place);
  if (std::abs(place - nearest) <= kSnapTolerance) {
    return sample(static_cast<int>(nearest), 0.0, rotations, translations);
  }
  const double frame = std::floor(place);
  sample(static_cast<int>(frame), place - frame, rotations, translations);
}

}  // namespace retarget
