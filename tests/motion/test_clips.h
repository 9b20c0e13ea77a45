#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/so3.h"

namespace retarget {

inline const std::vector<Channel> kRotationChannels = {Channel::kZRotation, Channel::kYRotation,
                                                       Channel::kXRotation};
inline const std::vector<Channel> kAllChannels = {Channel::kXPosition, Channel::kYPosition,
                                                  Channel::kZPosition, Channel::kZRotation,
                                                  Channel::kYRotation, Channel::kXRotation};

inline Joint make_joint(const std::string& name, int parent, const Eigen::Vector3d& offset,
                        const std::vector<Channel>& channels = kRotationChannels) {
  Joint joint;
  joint.name = name;
  joint.parent = parent;
  joint.offset = offset;
  joint.channels = channels;
  return joint;
}

// Two branches below a moving root; the second one begins with a joint that also slides.
inline std::shared_ptr<const Skeleton> make_tree() {
  return std::make_shared<const Skeleton>(std::vector<Joint>{
      make_joint("Hips", -1, {0.1, 0.9, 0.0}, kAllChannels),
      make_joint("Spine", 0, {0.0, 0.3, 0.05}), make_joint("Head", 1, {0.0, 0.4, 0.0}),
      make_joint("Slider", 0, {0.2, 0.0, -0.1}, kAllChannels),
      make_joint("Tool", 3, {0.0, -0.5, 0.0})});
}

using AngleOverTime = std::function<double(double seconds)>;

inline const Eigen::Vector3d kTestAxis = Eigen::Vector3d(1.0, -2.0, 0.5).normalized();

// Every joint rotates by f(t) about one axis, every translation is (f, 2 f, 1 - f) at t.
inline Clip make_clip(const FrameRate& rate, int frame_count, const AngleOverTime& f) {
  Clip clip(make_tree(), rate, frame_count);
  for (int frame = 0; frame < frame_count; ++frame) {
    const double value = f(rate.time_of(frame));
    for (auto& rotation : clip.rotations(frame)) rotation = exp_so3(value * kTestAxis);
    for (auto& translation : clip.translations(frame)) {
      translation = {value, 2.0 * value, 1.0 - value};
    }
  }
  return clip;
}

// Largest translation difference between the clip and that of make_clip, frames [begin, end).
inline double translation_error(const Clip& clip, const AngleOverTime& f, int begin, int end) {
  double worst = 0.0;
  for (int frame = begin; frame < end; ++frame) {
    const double value = f(clip.rate().time_of(frame));
    for (const auto& translation : clip.translations(frame)) {
      const Eigen::Vector3d expected(value, 2.0 * value, 1.0 - value);
      worst = std::max(worst, (translation - expected).cwiseAbs().maxCoeff());
    }
  }
  return worst;
}

// The same for rotations, in radians.
inline double rotation_error(const Clip& clip, const AngleOverTime& f, int begin, int end) {
  double worst = 0.0;
  for (int frame = begin; frame < end; ++frame) {
    const Eigen::Quaterniond expected = exp_so3(f(clip.rate().time_of(frame)) * kTestAxis);
    for (const auto& rotation : clip.rotations(frame)) {
      worst = std::max(worst, log_so3(rotation * expected.conjugate()).norm());
    }
  }
  return worst;
}

inline bool same_bits(const Clip& a, int frame_a, const Clip& b, int frame_b) {
  const auto rotations_a = a.rotations(frame_a), rotations_b = b.rotations(frame_b);
  const auto translations_a = a.translations(frame_a), translations_b = b.translations(frame_b);
  for (std::size_t i = 0; i < rotations_a.size(); ++i) {
    if (rotations_a[i].coeffs() != rotations_b[i].coeffs()) return false;
  }
  for (std::size_t i = 0; i < translations_a.size(); ++i) {
    if (translations_a[i] != translations_b[i]) return false;
  }
  return rotations_a.size() == rotations_b.size() && translations_a.size() == translations_b.size();
}

inline bool same_bits(const Clip& a, const Clip& b) {
  if (a.frame_count() != b.frame_count()) return false;
  for (int frame = 0; frame < a.frame_count(); ++frame) {
    if (!same_bits(a, frame, b, frame)) return false;
  }
  return true;
}

}  // namespace retarget
