#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <span>
#include <vector>

#include "retarget/motion/frame_rate.h"
#include "retarget/motion/skeleton.h"

namespace retarget {

/// A motion of a skeleton: local rotations (unit quaternions) and translations, frame by frame,
/// in the units and axes of the file it came from.
///
/// Joints without position channels have their offset as translation in every frame and take no
/// memory for it.
class Clip {
 public:
  /// All rotations identity, all translations the joints' offsets.
  Clip(std::shared_ptr<const Skeleton> skeleton, FrameRate rate, int frame_count);

  [[nodiscard]] const Skeleton& skeleton() const { return *skeleton_; }
  [[nodiscard]] const std::shared_ptr<const Skeleton>& shared_skeleton() const { return skeleton_; }
  [[nodiscard]] const FrameRate& rate() const { return rate_; }
  [[nodiscard]] int frame_count() const { return frame_count_; }
  /// Time from the first to the last frame in seconds: (frame_count - 1) / rate.
  [[nodiscard]] double duration() const;

  /// Rotations of all joints of a frame, each parent_from_joint.
  [[nodiscard]] std::span<Eigen::Quaterniond> rotations(int frame);
  [[nodiscard]] std::span<const Eigen::Quaterniond> rotations(int frame) const;
  /// Translations of the joints that have position channels, by Skeleton::translation_slot.
  [[nodiscard]] std::span<Eigen::Vector3d> translations(int frame);
  [[nodiscard]] std::span<const Eigen::Vector3d> translations(int frame) const;

  /// Translation of any joint from its parent, in the parent's frame.
  [[nodiscard]] const Eigen::Vector3d& translation(int frame, int joint) const;

  void set_rate(FrameRate rate) { rate_ = rate; }
  /// Frames that are added are at rest, as those of the constructor; amortised cost per frame.
  void resize(int frame_count);

 private:
  std::shared_ptr<const Skeleton> skeleton_;
  FrameRate rate_;
  int frame_count_;
  std::vector<Eigen::Quaterniond> rotations_;  // frame-major
  std::vector<Eigen::Vector3d> translations_;  // frame-major, translated joints alone
};

/// Gives a frame of a clip the pose of a frame of another on the same skeleton.
void copy_frame(const Clip& from, int from_frame, Clip& to, int to_frame);

/// Frames [begin, end) as a clip of its own that starts at time 0.
/// @pre 0 <= begin <= end <= clip.frame_count()
[[nodiscard]] Clip cut(const Clip& clip, int begin, int end);

/// Of q and -q takes for every joint the one nearer to the frame before, in place.
/// Rotations stay the same; interpolation and filtering need it.
void make_sign_continuous(Clip& clip);

}  // namespace retarget
