#include "retarget/clip_arrays.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "base/try.h"
#include "retarget/pose.h"

namespace retarget {
namespace {

constexpr double kMaxNormError = 1e-3;

// Joint indices in depth-first order, so that each joint follows its parent.
Result<std::vector<int>> depth_first(const ClipArrays& arrays) {
  const int joints = static_cast<int>(arrays.names.size());
  std::vector<std::vector<int>> children(arrays.names.size());
  int root = -1;
  for (int j = 0; j < joints; ++j) {
    const int parent = arrays.parents[j];
    if (parent < -1 || parent >= joints) {
      return usage_failure(
          fmt::format("parents[{}]: expected -1 to {}, found {}", j, joints - 1, parent));
    }
    if (parent >= 0) {
      children[parent].push_back(j);
    } else if (root >= 0) {
      return usage_failure(fmt::format("parents: two roots, \"{}\" and \"{}\"", arrays.names[root],
                                       arrays.names[j]));
    } else {
      root = j;
    }
  }
  std::vector<int> order, waiting;
  if (root >= 0) waiting.push_back(root);
  while (!waiting.empty()) {
    const int joint = waiting.back();
    waiting.pop_back();
    order.push_back(joint);
    waiting.insert(waiting.end(), children[joint].rbegin(), children[joint].rend());
  }
  if (static_cast<int>(order.size()) < joints) {
    return usage_failure("parents: expected a tree with one root (-1), found a cycle");
  }
  return order;
}

Result<void> check_names(const std::vector<std::string>& names) {
  if (names.empty()) return usage_failure("names: expected at least one joint");
  std::set<std::string_view> known;
  for (const std::string& name : names) {
    if (name.empty()) return usage_failure("names: a joint has no name");
    if (!known.insert(name).second) {
      return usage_failure(fmt::format("names: \"{}\" is given twice", name));
    }
  }
  return {};
}

class PoseReader {
 public:
  explicit PoseReader(const ClipArrays& arrays) : arrays_(arrays) {}

  [[nodiscard]] Result<void> check() const {
    for (std::size_t i = 0; i < arrays_.rotations.size() / 4; ++i) {
      const double norm = rotation(i).norm();
      if (std::abs(norm - 1.0) <= kMaxNormError) continue;
      return usage_failure(fmt::format(
          "rotations: expected unit quaternions, found one of length {:.4g} in frame {} of \"{}\"",
          norm, i / joints(), arrays_.names[i % joints()]));
    }
    return {};
  }

  // The pose parent_from_joint.
  [[nodiscard]] Pose local(std::size_t frame, int joint) const {
    const int parent = arrays_.parents[joint];
    const Pose given = pose(frame * joints() + static_cast<std::size_t>(joint));
    if (arrays_.local || parent < 0) return given;
    return pose(frame * joints() + static_cast<std::size_t>(parent)).inverse() * given;
  }

 private:
  [[nodiscard]] std::size_t joints() const { return arrays_.names.size(); }
  [[nodiscard]] Eigen::Quaterniond rotation(std::size_t index) const {
    const double* q = &arrays_.rotations[4 * index];
    return arrays_.scalar_first ? Eigen::Quaterniond(q[0], q[1], q[2], q[3])
                                : Eigen::Quaterniond(q[3], q[0], q[1], q[2]);
  }
  [[nodiscard]] Pose pose(std::size_t index) const {
    const double* p = &arrays_.positions[3 * index];
    Eigen::Quaterniond q = rotation(index);
    // Keeps rotations that are already normalised to rounding bit for bit.
    if (std::abs(q.squaredNorm() - 1.0) > 1e-15) q.normalize();
    return {q, {p[0], p[1], p[2]}};
  }

  const ClipArrays& arrays_;
};

// The offset of one joint over all frames.
struct OffsetFound {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double spread = 0.0;  // Largest distance from the mean.
};

OffsetFound find_offset(const PoseReader& poses, std::size_t frames, int joint) {
  if (frames == 0) return {};
  const Eigen::Vector3d first = poses.local(0, joint).translation;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t f = 0; f < frames; ++f) sum += poses.local(f, joint).translation - first;
  OffsetFound found{first + sum / static_cast<double>(frames), 0.0};
  for (std::size_t f = 0; f < frames; ++f) {
    found.spread = std::max(found.spread, (poses.local(f, joint).translation - found.mean).norm());
  }
  return found;
}

std::vector<Channel> channels_of(bool translated) {
  std::vector<Channel> channels;
  if (translated) channels = {Channel::kXPosition, Channel::kYPosition, Channel::kZPosition};
  channels.insert(channels.end(), {Channel::kZRotation, Channel::kYRotation, Channel::kXRotation});
  return channels;
}

std::shared_ptr<const Skeleton> make_skeleton(const ClipArrays& arrays, const PoseReader& poses,
                                              const std::vector<int>& order) {
  std::vector<OffsetFound> offsets(order.size());
  double longest = 0.0;
  for (const int joint : order) {
    if (arrays.parents[joint] < 0) continue;
    offsets[joint] = find_offset(poses, arrays.frames, joint);
    longest = std::max(longest, offsets[joint].mean.norm());
  }
  std::vector<int> place(order.size());
  std::vector<Joint> joints;
  for (const int joint : order) {
    place[joint] = static_cast<int>(joints.size());
    const int parent = arrays.parents[joint];
    const bool translated = parent < 0 || offsets[joint].spread > arrays.fixed_offset * longest;
    joints.push_back({arrays.names[joint],
                      parent < 0 ? -1 : place[parent],
                      offsets[joint].mean,
                      {},
                      channels_of(translated)});
  }
  return std::make_shared<const Skeleton>(std::move(joints));
}

}  // namespace

Result<Clip> clip_from_arrays(const ClipArrays& arrays) {
  TRY(check_names(arrays.names));
  TRY_ASSIGN(const std::vector<int> order, depth_first(arrays));
  const PoseReader poses(arrays);
  TRY(poses.check());
  Clip clip(make_skeleton(arrays, poses, order), arrays.rate, static_cast<int>(arrays.frames));
  const Skeleton& skeleton = clip.skeleton();
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      const Pose local = poses.local(static_cast<std::size_t>(f), order[j]);
      clip.rotations(f)[j] = local.rotation;
      const int slot = skeleton.translation_slot(j);
      if (slot >= 0) clip.translations(f)[slot] = local.translation;
    }
  }
  ClipOrigin origin;
  origin.name = arrays.name;
  clip.set_origin(std::move(origin));
  return clip;
}

}  // namespace retarget
