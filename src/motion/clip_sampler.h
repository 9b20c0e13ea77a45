#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "retarget/clip.h"
#include "retarget/options.h"

namespace retarget {

template <typename Value>
class TrackSampler;

/// A clip as a function of time. Immutable once built; threads may share it.
///
/// Holds the clip's tracks with sign-continuous quaternions and, for cubic interpolation, a
/// velocity per joint and frame, so that each sample costs the same wherever it lies.
class ClipSampler {
 public:
  explicit ClipSampler(const Clip& clip, Interpolation interpolation = Interpolation::kCubic);
  ~ClipSampler();
  ClipSampler(ClipSampler&&) noexcept;
  ClipSampler& operator=(ClipSampler&&) noexcept;
  ClipSampler(const ClipSampler&) = delete;
  ClipSampler& operator=(const ClipSampler&) = delete;

  [[nodiscard]] int frame_count() const { return frame_count_; }

  /// The pose at `fraction` in [0, 1) of the way from `frame` to the next one. A fraction of
  /// zero gives the frame itself, bit for bit, as does any at the last frame.
  /// @pre 0 <= frame < frame_count()
  /// @param rotations     one per joint; filled, sign-continuous in time
  /// @param translations  one per translated joint, as Clip::translations; filled
  void sample(int frame, double fraction, std::span<Eigen::Quaterniond> rotations,
              std::span<Eigen::Vector3d> translations) const;

  /// The pose at a time in seconds; before the first and after the last frame these stand still.
  /// A time within a billionth of a frame of a frame's own gives the frame itself.
  /// @pre the clip has frames
  void sample(double time, std::span<Eigen::Quaterniond> rotations,
              std::span<Eigen::Vector3d> translations) const;

 private:
  FrameRate rate_;
  int frame_count_;
  std::vector<TrackSampler<Eigen::Quaterniond>> rotations_;  // by joint
  std::vector<TrackSampler<Eigen::Vector3d>> translations_;  // by translated joint
};

}  // namespace retarget
