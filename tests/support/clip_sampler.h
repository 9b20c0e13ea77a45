#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "motion/clip.h"
#include "motion/resample.h"

namespace retarget {

/// A clip as a function of time, as a reference for resampling: it interpolates each track.
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

  /// Samples the pose at `fraction` in [0, 1) between `frame` and the next frame.
  void sample(int frame, double fraction, std::span<Eigen::Quaterniond> rotations,
              std::span<Eigen::Vector3d> translations) const {
    for (std::size_t i = 0; i < rotations_.size(); ++i) {
      rotations[i] = rotations_[i].sample(frame, fraction);
    }
    for (std::size_t i = 0; i < translations_.size(); ++i) {
      translations[i] = translations_[i].sample(frame, fraction);
    }
  }

  /// Samples the pose at a time in seconds. The first and last poses extend beyond the clip. A time
  /// within 1e-9 frames of a frame gives that frame exactly.
  void sample(double time, std::span<Eigen::Quaterniond> rotations,
              std::span<Eigen::Vector3d> translations) const {
    constexpr double kWholeFrameTolerance = 1e-9;  // Frames.
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
  std::vector<TrackSampler<Eigen::Quaterniond>> rotations_;  // By joint.
  std::vector<TrackSampler<Eigen::Vector3d>> translations_;  // By translated joint.
};

}  // namespace retarget
