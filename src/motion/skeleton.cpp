#include <algorithm>
#include <array>
#include <cassert>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <vector>

#include "retarget/clip.h"
#include "retarget/skeleton_points.h"

namespace retarget {

std::string_view channel_name(Channel channel) {
  static constexpr std::array<std::string_view, 9> kNames = {"Xposition", "Yposition", "Zposition",
                                                             "Xrotation", "Yrotation", "Zrotation",
                                                             "Xscale",    "Yscale",    "Zscale"};
  return kNames[static_cast<std::size_t>(channel)];
}

bool Joint::has_position_channels() const {
  return std::any_of(channels.begin(), channels.end(), is_position);
}

Skeleton::Skeleton(std::vector<Joint> joints) : joints_(std::move(joints)) {
  translation_slots_.reserve(joints_.size());
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    assert(joints_[i].parent < static_cast<int>(i));
    translation_slots_.push_back(joints_[i].has_position_channels() ? translated_count_++ : -1);
    channel_count_ += static_cast<int>(joints_[i].channels.size());
  }
}

std::optional<int> Skeleton::find(std::string_view name) const {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (joints_[i].name == name) return static_cast<int>(i);
  }
  return std::nullopt;
}

std::vector<std::string> Skeleton::names() const {
  std::vector<std::string> all;
  all.reserve(joints_.size());
  for (const Joint& joint : joints_) all.push_back(joint.name);
  return all;
}

std::vector<SkeletonPoint> skeleton_points(const Skeleton& skeleton) {
  std::vector<SkeletonPoint> points;
  std::unordered_set<std::string_view> names;
  for (const Joint& joint : skeleton.joints()) names.insert(joint.name);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const Joint& joint = skeleton.joint(j);
    points.push_back({joint.name, j, Eigen::Vector3d::Zero()});
    int number = 0;
    for (const Eigen::Vector3d& end_site : joint.end_sites) {
      // A joint may already have this name.
      std::string name;
      do {
        ++number;
        name = joint.name + "_end" + (number == 1 ? "" : std::to_string(number));
      } while (names.contains(name));
      points.push_back({name, j, end_site});
    }
  }
  return points;
}

std::vector<SkeletonPoint> points_below(const Skeleton& skeleton, int joint) {
  std::vector<SkeletonPoint> points;
  if (joint < 0) return points;
  // Parents come before their children.
  std::vector<bool> below(static_cast<std::size_t>(skeleton.joint_count()), false);
  for (int j = joint; j < skeleton.joint_count(); ++j) {
    const int parent = skeleton.joint(j).parent;
    below[j] = j == joint || (parent >= 0 && below[parent]);
  }
  for (SkeletonPoint& point : skeleton_points(skeleton)) {
    if (below[point.joint]) points.push_back(std::move(point));
  }
  return points;
}

Pose world_from_point(const SkeletonPoint& point, const std::vector<Pose>& world_from_joint) {
  const Pose& world = world_from_joint[point.joint];
  return {world.rotation, world * point.offset};
}

Eigen::AlignedBox3d extents(const Clip& clip) {
  // A clip without frames has the extents of its skeleton at rest.
  const Clip rest(clip.shared_skeleton(), clip.rate(), 1);
  const Clip& shown = clip.frame_count() > 0 ? clip : rest;
  const std::vector<SkeletonPoint> points = skeleton_points(shown.skeleton());
  std::vector<Pose> world_from_joint(shown.skeleton().joint_count());
  Eigen::AlignedBox3d box;
  for (int frame = 0; frame < shown.frame_count(); ++frame) {
    forward_kinematics(shown, frame, world_from_joint);
    for (const SkeletonPoint& point : points) {
      box.extend(world_from_point(point, world_from_joint).translation);
    }
  }
  return box;
}

}  // namespace retarget
