#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "motion/clip_tracks.h"
#include "motion/track_sampler.h"

namespace retarget {

/// A clip as a function of time, for what is resampled to be held against: its tracks' samplers.
class ClipSampler {
 public:
  explicit ClipSampler(const Clip& clip, Interpolation interpolation = Interpolation::kCubic)
      : rate_(clip.rate()), frame_count_(clip.frame_count()) {
    for (int joint = 0; joint < clip.skeleton().joint_count(); ++joint) {
      rotations_.emplace_back(rotation_track(clip, joint), interpolation);
    }
    for (int slot = 0; slot < clip.skeleton().translated_count(); ++slot) {
      translations_.emplace_back(translation_track(clip, slot), interpolation);
    }
  }

  [[nodiscard]] int frame_count() const { return frame_count_; }

  /// The pose at `fraction` in [0, 1) of the way from `frame` to the next one.
  void sample(int frame, double fraction, std::span<Eigen::Quaterniond> rotations,
              std::span<Eigen::Vector3d> translations) const {
    for (std::size_t i = 0; i < rotations_.size(); ++i) {
      rotations[i] = rotations_[i].sample(frame, fraction);
    }
    for (std::size_t i = 0; i < translations_.size(); ++i) {
      translations[i] = translations_[i].sample(frame, fraction);
    }
  }

  /// The pose at a time in seconds; before the first and after the last frame these stand still.
  /// A time within a billionth of a frame of a frame's own gives the frame itself.
  void sample(double time, std::span<Eigen::Quaterniond> rotations,
              std::span<Eigen::Vector3d> translations) const {
    constexpr double kWholeFrameTolerance = 1e-9;  // in frames
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

 private:
  FrameRate rate_;
  int frame_count_;
  std::vector<TrackSampler<Eigen::Quaterniond>> rotations_;  // by joint
  std::vector<TrackSampler<Eigen::Vector3d>> translations_;  // by translated joint
};

}  // namespace retarget
