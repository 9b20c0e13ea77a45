#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace retarget {

/// One value of a joint in a motion row.
enum class Channel : unsigned char {
  kXPosition,
  kYPosition,
  kZPosition,
  kXRotation,
  kYRotation,
  kZRotation,
  kXScale,
  kYScale,
  kZScale,
};

[[nodiscard]] constexpr bool is_position(Channel channel) {
  return channel <= Channel::kZPosition;
}
[[nodiscard]] constexpr bool is_rotation(Channel channel) {
  return channel >= Channel::kXRotation && channel <= Channel::kZRotation;
}
/// 0, 1 or 2 for x, y or z.
[[nodiscard]] constexpr int axis_of(Channel channel) {
  return static_cast<int>(channel) % 3;
}
/// As BVH spells it: `Xposition`, `Zrotation`, `Yscale`.
[[nodiscard]] std::string_view channel_name(Channel channel);

/// A joint of a skeleton. Lengths and axes are the file's own.
struct Joint {
  std::string name;
  int parent = -1;  ///< Index of the parent, always smaller than the joint's own; -1 for the root.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< From the parent, in the parent's frame.
  std::vector<Eigen::Vector3d> end_sites;            ///< In the joint's frame.
  /// How a motion row stores this joint, in file order; rotations compose left to right
  /// (intrinsic). Per joint: orders may differ within one skeleton.
  std::vector<Channel> channels;

  /// Whether the joint's translation is stored per frame instead of being its offset.
  [[nodiscard]] bool has_position_channels() const;
};

/// A tree of joints in depth-first declaration order; immutable once built.
class Skeleton {
 public:
  /// Joint 0 is the root; every parent comes before its children.
  explicit Skeleton(std::vector<Joint> joints);

  [[nodiscard]] int joint_count() const { return static_cast<int>(joints_.size()); }
  [[nodiscard]] const Joint& joint(int index) const { return joints_[index]; }
  [[nodiscard]] const std::vector<Joint>& joints() const { return joints_; }
  /// The first joint of that exact name.
  [[nodiscard]] std::optional<int> find(std::string_view name) const;
  /// All names in joint order.
  [[nodiscard]] std::vector<std::string> names() const;
  /// Values in one motion row: the channels of all joints.
  [[nodiscard]] int channel_count() const { return channel_count_; }

  /// Number of joints with a translation of their own in each frame.
  [[nodiscard]] int translated_count() const { return translated_count_; }
  /// Where a joint's translation lies in a frame's list of translations; -1: it is its offset.
  [[nodiscard]] int translation_slot(int joint) const { return translation_slots_[joint]; }

 private:
  std::vector<Joint> joints_;
  std::vector<int> translation_slots_;
  int translated_count_ = 0;
  int channel_count_ = 0;
};

}  // namespace retarget
