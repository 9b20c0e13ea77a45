#include <algorithm>
#include <cassert>
#include <utility>

#include "retarget/clip.h"
#include "retarget/so3.h"

namespace retarget {

Clip::Clip(std::shared_ptr<const Skeleton> skeleton, FrameRate rate, int frame_count)
    : skeleton_(std::move(skeleton)), rate_(rate), frame_count_(0) {
  resize(frame_count);
}

const ClipOrigin& Clip::origin() const {
  static const ClipOrigin kUnknown;
  return origin_ ? *origin_ : kUnknown;
}

void Clip::set_origin(ClipOrigin origin) {
  origin_ = std::make_shared<const ClipOrigin>(std::move(origin));
}

Clip Clip::empty_like(FrameRate rate, int frame_count) const {
  Clip clip(skeleton_, rate, frame_count);
  clip.origin_ = origin_;
  return clip;
}

double Clip::duration() const {
  return frame_count_ > 0 ? rate_.time_of(frame_count_ - 1) : 0.0;
}

std::span<Eigen::Quaterniond> Clip::rotations(int frame) {
  const std::size_t width = skeleton_->joint_count();
  return {rotations_.data() + frame * width, width};
}

std::span<const Eigen::Quaterniond> Clip::rotations(int frame) const {
  const std::size_t width = skeleton_->joint_count();
  return {rotations_.data() + frame * width, width};
}

std::span<Eigen::Vector3d> Clip::translations(int frame) {
  const std::size_t width = skeleton_->translated_count();
  return {translations_.data() + frame * width, width};
}

std::span<const Eigen::Vector3d> Clip::translations(int frame) const {
  const std::size_t width = skeleton_->translated_count();
  return {translations_.data() + frame * width, width};
}

const Eigen::Vector3d& Clip::translation(int frame, int joint) const {
  const int slot = skeleton_->translation_slot(joint);
  return slot < 0 ? skeleton_->joint(joint).offset : translations(frame)[slot];
}

void Clip::resize(int frame_count) {
  const auto frames = static_cast<std::size_t>(frame_count);
  rotations_.resize(frames * skeleton_->joint_count(), Eigen::Quaterniond::Identity());
  translations_.resize(frames * skeleton_->translated_count());
  for (int joint = 0; joint < skeleton_->joint_count(); ++joint) {
    const int slot = skeleton_->translation_slot(joint);
    if (slot < 0) continue;
    for (int frame = frame_count_; frame < frame_count; ++frame) {
      translations_[static_cast<std::size_t>(frame) * skeleton_->translated_count() + slot] =
          skeleton_->joint(joint).offset;
    }
  }
  frame_count_ = frame_count;
}

void copy_frame(const Clip& from, int from_frame, Clip& to, int to_frame) {
  std::ranges::copy(from.rotations(from_frame), to.rotations(to_frame).begin());
  std::ranges::copy(from.translations(from_frame), to.translations(to_frame).begin());
}

Clip cut(const Clip& clip, int begin, int end) {
  assert(0 <= begin && begin <= end && end <= clip.frame_count());
  Clip part = clip.empty_like(clip.rate(), end - begin);
  for (int frame = begin; frame < end; ++frame) copy_frame(clip, frame, part, frame - begin);
  return part;
}

void make_sign_continuous(Clip& clip) {
  for (int frame = 1; frame < clip.frame_count(); ++frame) {
    const auto before = std::as_const(clip).rotations(frame - 1);
    const auto now = clip.rotations(frame);
    for (std::size_t joint = 0; joint < now.size(); ++joint) {
      align_sign(before[joint].coeffs(), now[joint].coeffs());
    }
  }
}

}  // namespace retarget
