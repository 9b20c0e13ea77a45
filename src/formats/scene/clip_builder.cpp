#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "formats/scene/clip_builder.h"
#include "retarget/bvh.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

// Half a turn about the axis with positive scale, if the two others are negative.
Eigen::Quaterniond turned_over(const Eigen::Vector3d& scale) {
  const bool x = scale.x() < 0.0, y = scale.y() < 0.0, z = scale.z() < 0.0;
  if (y && z) return {0.0, 1.0, 0.0, 0.0};
  if (x && z) return {0.0, 0.0, 1.0, 0.0};
  if (x && y) return {0.0, 0.0, 0.0, 1.0};
  return Eigen::Quaterniond::Identity();
}

// Relative to the skeleton's size: 0.02 mm for a person.
constexpr double kTolerance = 1e-5;

}  // namespace

NodePlace place_below(const NodePlace& parent, const NodeTransform& parent_from_node) {
  const auto& [translation, rotation, scale] = parent_from_node;
  NodePlace place;
  place.world_from_node.linear() = parent.world_from_node.linear() *
                                   rotation.normalized().toRotationMatrix() * scale.asDiagonal();
  place.world_from_node.translation() = parent.world_from_node * translation;
  place.rotation = (parent.rotation * rotation * turned_over(scale)).normalized();
  return place;
}

bool is_mirrored(const NodeTransform& transform) {
  int negative = 0;
  for (const double scale : transform.scale) negative += scale < 0.0 ? 1 : 0;
  return negative % 2 == 1;
}

bool is_sound(const NodeTransform& transform) {
  // Also excludes numbers whose squares overflow.
  constexpr double kLargest = 1e100;
  const double norm = transform.rotation.coeffs().squaredNorm();
  return transform.translation.cwiseAbs().maxCoeff() < kLargest &&
         transform.scale.cwiseAbs().maxCoeff() < kLargest && transform.translation.allFinite() &&
         transform.scale.allFinite() && norm > 1e-6 && norm < 1e6;
}

Eigen::Quaterniond rotation_of(const Eigen::Matrix3d& matrix) {
  Eigen::Matrix3d axes;
  axes.col(0) = matrix.col(0).stableNormalized();
  axes.col(2) = axes.col(0).cross(matrix.col(1)).stableNormalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return Eigen::Quaterniond(axes).normalized();
}

NodeTransform decomposed(const Eigen::Affine3d& affine) {
  const Eigen::Matrix3d& linear = affine.linear();
  NodeTransform result;
  result.translation = affine.translation();
  result.rotation = rotation_of(linear);
  for (int axis = 0; axis < 3; ++axis) result.scale[axis] = linear.col(axis).stableNorm();
  if (linear.determinant() < 0.0) result.scale.z() = -result.scale.z();
  return result;
}

std::optional<Eigen::Affine3d> usable_bind(const Eigen::Affine3d& affine) {
  const double volume = affine.linear().determinant();
  const bool is_finite = affine.matrix().allFinite() && std::isfinite(volume);
  if (!is_finite || !(volume > 1e-18) || affine.matrix().cwiseAbs().maxCoeff() > 1e9) {
    return std::nullopt;
  }
  return affine;
}

std::size_t ClipBuilder::frame_bytes(std::size_t joints) {
  // Once in this object and once in the clip.
  return 2 * joints * (sizeof(Eigen::Quaterniond) + sizeof(Eigen::Vector3d));
}

ClipBuilder::ClipBuilder(std::vector<WorldJoint> joints, FrameRate rate, int frame_count)
    : joints_(std::move(joints)), rate_(rate), frame_count_(frame_count) {
  const std::size_t count = joints_.size() * static_cast<std::size_t>(frame_count);
  rotations_.resize(count, Eigen::Quaterniond::Identity());
  translations_.resize(count, Eigen::Vector3d::Zero());
}

void ClipBuilder::set_frame(int frame, std::span<const Pose> world_from_joint) {
  const std::size_t first = static_cast<std::size_t>(frame) * joints_.size();
  // Rotations from the rest pose, in world axes.
  std::vector<Eigen::Quaterniond> turns(joints_.size());
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const WorldJoint& joint = joints_[j];
    turns[j] = world_from_joint[j].rotation * joint.world_from_rest.rotation.conjugate();
    if (joint.parent < 0) {
      rotations_[first + j] = turns[j].normalized();
      translations_[first + j] = world_from_joint[j].translation;
      continue;
    }
    const auto parent = static_cast<std::size_t>(joint.parent);
    const Eigen::Quaterniond parent_from_world = turns[parent].conjugate();
    rotations_[first + j] = (parent_from_world * turns[j]).normalized();
    translations_[first + j] = parent_from_world * (world_from_joint[j].translation -
                                                    world_from_joint[parent].translation);
  }
}

double ClipBuilder::size() const {
  double size = 0.0;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if (joints_[j].parent >= 0 && frame_count_ > 0) size += translations_[j].norm();
  }
  return size;
}

bool ClipBuilder::is_translated(std::size_t joint, double tolerance) const {
  for (std::size_t i = joint; i < translations_.size(); i += joints_.size()) {
    if ((translations_[i] - translations_[joint]).cwiseAbs().maxCoeff() > tolerance) return true;
  }
  return false;
}

Eigen::Vector3d ClipBuilder::rest_offset(std::size_t joint) const {
  const auto parent = static_cast<std::size_t>(joints_[joint].parent);
  return joints_[joint].world_from_rest.translation - joints_[parent].world_from_rest.translation;
}

double ClipBuilder::motion_per_rest() const {
  std::vector<double> ratios;
  for (std::size_t j = 0; j < joints_.size() && frame_count_ > 0; ++j) {
    if (joints_[j].parent < 0) continue;
    const double rest = rest_offset(j).norm(), now = translations_[j].norm();
    if (rest > 0.0 && now > 0.0) ratios.push_back(now / rest);
  }
  return ratios.empty() ? 1.0 : median(std::move(ratios));
}

Eigen::Vector3d ClipBuilder::zero_offset(std::size_t joint, double scale) const {
  constexpr double kMostRatio = 1.5;
  const Eigen::Vector3d rest = scale * rest_offset(joint);
  const double length = translations_[joint].norm();
  const bool fits = rest.norm() < kMostRatio * length && length < kMostRatio * rest.norm();
  return fits ? rest : translations_[joint];
}

Clip ClipBuilder::build() const {
  using enum Channel;
  // The longest path through a body is about a fifth of the total length of its bones.
  const double tolerance = kTolerance * 0.2 * size();
  const double scale = motion_per_rest();
  std::vector<Joint> joints;
  joints.reserve(joints_.size());
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const WorldJoint& from = joints_[j];
    Joint joint;
    joint.name = from.name;
    joint.parent = from.parent;
    joint.channels = {kZRotation, kXRotation, kYRotation};
    if (from.parent >= 0) {
      joint.offset = frame_count_ > 0 ? translations_[j] : rest_offset(j);
    }
    if (from.parent < 0 || is_translated(j, tolerance)) {
      // A joint that translates may be away from its rest position in the first frame.
      if (from.parent >= 0) joint.offset = zero_offset(j, scale);
      joint.channels.insert(joint.channels.begin(), {kXPosition, kYPosition, kZPosition});
    }
    joints.push_back(std::move(joint));
  }
  Clip clip(std::make_shared<const Skeleton>(std::move(joints)), rate_, frame_count_);
  const Skeleton& skeleton = clip.skeleton();
  for (int frame = 0; frame < frame_count_; ++frame) {
    const std::size_t first = static_cast<std::size_t>(frame) * joints_.size();
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      clip.rotations(frame)[j] = rotations_[first + j];
      const int slot = skeleton.translation_slot(static_cast<int>(j));
      if (slot >= 0) {
        clip.translations(frame)[static_cast<std::size_t>(slot)] = translations_[first + j];
      }
    }
  }
  make_sign_continuous(clip);
  return clip;
}

std::vector<std::string> plain_joint_names(std::vector<std::string> names) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string& name = names[i];
    std::ranges::replace_if(
        name, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '{'; },
        '_');
    const std::size_t first = name.find_first_not_of(' ');
    name = first == std::string::npos ? ""
                                      : name.substr(first, name.find_last_not_of(' ') - first + 1);
    if (name.empty()) name = "joint_" + std::to_string(i);
  }
  return names;
}

}  // namespace retarget
