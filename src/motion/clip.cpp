#include "retarget/clip.h"

#include <fmt/format.h>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

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

namespace {

constexpr double kSnapTolerance = 1e-4;
constexpr double kFractionTolerance = 1e-9;
// Keeps products of a frame number and a rate within 64 bits.
constexpr std::int64_t kMaxTerm = 1'000'000'000;

// The simplest fraction near a positive value, by its continued fraction.
FrameRate simplest_fraction(double value) {
  std::int64_t num_before = 0, num = 1, den_before = 1, den = 0;
  double rest = value;
  for (int term = 0; term < 40; ++term) {
    const double whole = std::floor(rest);
    const double next_num = whole * static_cast<double>(num) + static_cast<double>(num_before);
    const double next_den = whole * static_cast<double>(den) + static_cast<double>(den_before);
    if (next_num > kMaxTerm || next_den > kMaxTerm) break;
    num_before = std::exchange(num, static_cast<std::int64_t>(next_num));
    den_before = std::exchange(den, static_cast<std::int64_t>(next_den));
    const double error = std::abs(static_cast<double>(num) / den - value);
    if (num > 0 && error <= kFractionTolerance * value) break;
    if (rest == whole) break;
    rest = 1.0 / (rest - whole);
  }
  // Clamps rates beyond the range of 64-bit time arithmetic.
  if (den == 0) return {kMaxTerm, 1};
  if (num == 0) return {1, kMaxTerm};
  return {num, den};
}

}  // namespace

FrameRate frame_rate_from_fps(double fps) {
  const double whole = std::round(fps);
  if (whole >= 1.0 && whole <= kMaxTerm && std::abs(fps / whole - 1.0) <= kSnapTolerance) {
    return {static_cast<std::int64_t>(whole), 1};
  }
  return simplest_fraction(fps);
}

FrameRate frame_rate_from_frame_time(double frame_time) {
  const double whole = std::round(1.0 / frame_time);
  if (whole >= 1.0 && whole <= kMaxTerm && std::abs(frame_time * whole - 1.0) <= kSnapTolerance) {
    return {static_cast<std::int64_t>(whole), 1};
  }
  return simplest_fraction(1.0 / frame_time);
}

bool same_rate(const FrameRate& a, const FrameRate& b) {
  return std::abs(a.fps() / b.fps() - 1.0) <= kSnapTolerance;
}

std::string to_text(const FrameRate& rate) {
  return fmt::format("{:.8g}", rate.fps());
}

void forward_kinematics(const Clip& clip, int frame, std::span<Pose> world_from_joint) {
  const Skeleton& skeleton = clip.skeleton();
  const auto rotations = clip.rotations(frame);
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    const Pose parent_from_joint{rotations[joint], clip.translation(frame, joint)};
    const int parent = skeleton.joint(joint).parent;
    world_from_joint[joint] =
        parent < 0 ? parent_from_joint : world_from_joint[parent] * parent_from_joint;
  }
}

}  // namespace retarget
