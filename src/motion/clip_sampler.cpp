#include "motion/clip_sampler.h"

#include <cassert>
#include <cmath>

#include "motion/clip_tracks.h"
#include "motion/track_sampler.h"

namespace retarget {
namespace {

// in frames; times computed from frame numbers are off by rounding
constexpr double kWholeFrameTolerance = 1e-9;

}  // namespace

ClipSampler::ClipSampler(const Clip& clip, Interpolation interpolation)
    : rate_(clip.rate()), frame_count_(clip.frame_count()) {
  for (int joint = 0; joint < clip.skeleton().joint_count(); ++joint) {
    rotations_.emplace_back(rotation_track(clip, joint), interpolation);
  }
  for (int slot = 0; slot < clip.skeleton().translated_count(); ++slot) {
    translations_.emplace_back(translation_track(clip, slot), interpolation);
  }
}

ClipSampler::~ClipSampler() = default;
ClipSampler::ClipSampler(ClipSampler&&) noexcept = default;
ClipSampler& ClipSampler::operator=(ClipSampler&&) noexcept = default;

void ClipSampler::sample(int frame, double fraction, std::span<Eigen::Quaterniond> rotations,
                         std::span<Eigen::Vector3d> translations) const {
  assert(0 <= frame && frame < frame_count_);
  for (std::size_t i = 0; i < rotations_.size(); ++i) {
    rotations[i] = rotations_[i].sample(frame, fraction);
  }
  for (std::size_t i = 0; i < translations_.size(); ++i) {
    translations[i] = translations_[i].sample(frame, fraction);
  }
}

void ClipSampler::sample(double time, std::span<Eigen::Quaterniond> rotations,
                         std::span<Eigen::Vector3d> translations) const {
  const int last = frame_count_ - 1;
  const double place = time * rate_.fps();
  if (!(place > 0.0)) return sample(0, 0.0, rotations, translations);
  if (place >= last) return sample(last, 0.0, rotations, translations);
  const double nearest = std::round(place);
  if (std::abs(place - nearest) <= kWholeFrameTolerance) {
    return sample(static_cast<int>(nearest), 0.0, rotations, translations);
  }
  const double frame = std::floor(place);
  sample(static_cast<int>(frame), place - frame, rotations, translations);
}

}  // namespace retarget
