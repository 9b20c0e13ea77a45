#include "robot/anatomy/mirrored_bodies.h"

#include <algorithm>
#include <optional>
#include <span>

#include "retarget/kinematic_tree.h"

namespace retarget {
namespace {

class BodyMirror {
 public:
  BodyMirror(const Robot& robot, const RobotAnatomy& limbs)
      : tree_(robot.tree()),
        posed_(robot.tree(), reference_configuration(robot)),
        left_(limbs.left),
        images_(robot.bodies().size(), -1) {
    const auto root = [&](std::size_t side) {
      return posed_.anchor(limbs.arms[side].joints.front());
    };
    middle_ = 0.5 * (root(0) + root(1));
  }

  std::vector<int> find(const RobotAnatomy& limbs);

 private:
  // Returns the candidate nearest to the mirror image of a point; nothing without candidates.
  template <typename Place>
  [[nodiscard]] std::optional<int> nearest(const Eigen::Vector3d& point,
                                           std::span<const int> candidates,
                                           const Place& place) const {
    const Eigen::Vector3d image = point - 2.0 * left_.dot(point - middle_) * left_;
    const auto apart = [&](int candidate) { return (place(candidate) - image).norm(); };
    if (candidates.empty()) return std::nullopt;
    return *std::ranges::min_element(candidates, {}, apart);
  }

  void mirror_group(const std::vector<int>& bodies, const std::vector<int>& others);
  void mirror_links(int first, int second);

  const KinematicTree& tree_;
  TreeState posed_;
  Eigen::Vector3d left_, middle_;
  std::vector<int> images_;
};

void BodyMirror::mirror_group(const std::vector<int>& bodies, const std::vector<int>& others) {
  const auto place = [&](int body) { return posed_.world_from_body(body).translation; };
  for (const int body : bodies) {
    if (const auto image = nearest(place(body), others, place)) images_[body] = *image;
  }
}

// Mirrors two links and what they carry; parts without a counterpart keep none.
void BodyMirror::mirror_links(int first, int second) {
  const auto group = [&](int link) { return tree_.rigid_group(tree_.links()[link].body); };
  mirror_group(group(first), group(second));
  mirror_group(group(second), group(first));
  images_[tree_.links()[first].body] = tree_.links()[second].body;
  images_[tree_.links()[second].body] = tree_.links()[first].body;
  const auto anchor = [&](int link) { return posed_.anchor(tree_.links()[link].joint); };
  const std::vector<int> own = tree_.children(first), others = tree_.children(second);
  for (const int child : own) {
    const auto other = nearest(anchor(child), others, anchor);
    if (other && nearest(anchor(*other), own, anchor) == child) mirror_links(child, *other);
  }
}

std::vector<int> BodyMirror::find(const RobotAnatomy& limbs) {
  std::vector<bool> in_limb(tree_.links().size(), false);
  for (const auto* pair : {&limbs.legs, &limbs.arms}) {
    for (const Limb& limb : *pair) {
      if (limb.joints.empty()) continue;
      const int first = tree_.link_of_joint(limb.joints.front());
      std::fill(in_limb.begin() + first, in_limb.begin() + tree_.links()[first].last_descendant + 1,
                true);
    }
    if ((*pair)[0].joints.empty()) continue;
    mirror_links(tree_.link_of_joint((*pair)[0].joints.front()),
                 tree_.link_of_joint((*pair)[1].joints.front()));
  }
  for (std::size_t link = 0; link < tree_.links().size(); ++link) {
    if (in_limb[link]) continue;
    const std::vector<int> bodies = tree_.rigid_group(tree_.links()[link].body);
    mirror_group(bodies, bodies);
  }
  return images_;
}

}  // namespace

std::vector<int> mirrored_bodies(const Robot& robot, const RobotAnatomy& limbs) {
  return BodyMirror(robot, limbs).find(limbs);
}

}  // namespace retarget
