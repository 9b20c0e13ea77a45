#include "formats/scene/skeleton_shape.h"

#include <algorithm>
#include <map>
#include <utility>

#include "formats/scene/clip_builder.h"

namespace retarget {
namespace {

// A tree of joints: its root, its number of joints, and their largest distance from the root.
struct JointTreeSize {
  int root = -1;
  std::size_t joints = 0;
  double reach = 0.0;
};

// The trees of marked nodes.
std::vector<JointTreeSize> joint_trees(const SceneGraph& scene, const std::vector<bool>& marks,
                                       const std::vector<Eigen::Vector3d>& places) {
  std::vector<JointTreeSize> trees;
  std::vector<std::size_t> tree_of(scene.nodes.size());
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    if (!marks[i]) continue;
    const int parent = scene.nodes[i].parent;
    const bool is_root = parent < 0 || !marks[as_size(parent)];
    tree_of[i] = is_root ? trees.size() : tree_of[as_size(parent)];
    if (is_root) trees.push_back({static_cast<int>(i)});
    JointTreeSize& tree = trees[tree_of[i]];
    ++tree.joints;
    tree.reach = std::max(tree.reach, (places[i] - places[as_size(tree.root)]).norm());
  }
  return trees;
}

// The nearest node above each node that moves in any take; -1: none.
std::vector<int> moving_nodes_above(const SceneGraph& scene) {
  std::vector<bool> moves(scene.nodes.size());
  for (const SceneTake& take : scene.takes) {
    for (std::size_t i = 0; i < moves.size(); ++i) moves[i] = moves[i] || take.moves[i];
  }
  std::vector<int> above;
  for (const SceneNode& node : scene.nodes) {
    above.push_back(node.parent < 0               ? -1
                    : moves[as_size(node.parent)] ? node.parent
                                                  : above[as_size(node.parent)]);
  }
  return above;
}

// Whether trees are one torso and, near its root, two legs with equal numbers of joints. Controls
// for feet are as far from the root of a whole body as its feet.
bool are_torso_and_legs(const std::vector<JointTreeSize>& trees,
                        const std::vector<Eigen::Vector3d>& places) {
  constexpr std::size_t kMinLeg = 3;
  constexpr double kNear = 0.5;
  const auto is_torso = [](const JointTreeSize& tree) { return tree.joints >= kMinBodyJoints; };
  if (std::ranges::count_if(trees, is_torso) != 1) return false;
  const JointTreeSize& torso = *std::ranges::find_if(trees, is_torso);
  std::map<std::size_t, int> legs;  // Their number by the number of joints.
  for (const JointTreeSize& tree : trees) {
    const double distance = (places[as_size(tree.root)] - places[as_size(torso.root)]).norm();
    if (is_torso(tree) || tree.joints < kMinLeg || distance > kNear * torso.reach) continue;
    ++legs[tree.joints];
  }
  return std::ranges::any_of(legs, [](const auto& pair) { return pair.second == 2; });
}

}  // namespace

std::vector<Eigen::Vector3d> node_rests(const SceneGraph& scene) {
  std::vector<NodePlace> places;
  std::vector<Eigen::Vector3d> positions;
  for (const SceneNode& node : scene.nodes) {
    const NodePlace parent = node.parent < 0 ? NodePlace() : places[as_size(node.parent)];
    places.push_back(place_below(parent, node.rest));
    positions.push_back(places.back().world_from_node.translation());
  }
  return positions;
}

bool mark_dummy_hips(const SceneGraph& scene, std::vector<bool>& marks) {
  const std::vector<Eigen::Vector3d> places = node_rests(scene);
  const std::vector<int> above = moving_nodes_above(scene);
  std::map<int, std::vector<JointTreeSize>> trees_below;
  for (const JointTreeSize& tree : joint_trees(scene, marks, places)) {
    trees_below[above[as_size(tree.root)]].push_back(tree);
  }
  bool found = false;
  for (const auto& [node, trees] : trees_below) {
    if (node < 0 || !are_torso_and_legs(trees, places)) continue;
    marks[as_size(node)] = true;
    found = true;
  }
  return found;
}

double moving_share(const std::vector<Eigen::Vector3d>& places, const SceneSkeleton& skeleton,
                    const std::vector<bool>& moves) {
  double all = 0.0, moving = 0.0;
  for (std::size_t j = 1; j < skeleton.joints.size(); ++j) {
    const int parent = skeleton.joints[as_size(skeleton.parents[j])];
    const double length = (places[as_size(skeleton.joints[j])] - places[as_size(parent)]).norm();
    all += length;
    if (moves[as_size(parent)]) moving += length;
  }
  return all > 0.0 ? moving / all : 0.0;
}

std::size_t drop_still_copies(const SceneGraph& scene, int take, SceneSkeleton& skeleton) {
  constexpr double kSame = 0.01;       // Of the distance from the root to the farthest joint.
  constexpr double kMostOthers = 0.2;  // Share of a copy's joints without counterpart.
  if (take < 0 || skeleton.joints.empty()) return 0;
  const std::vector<bool>& moves = scene.takes[as_size(take)].moves;
  const std::vector<Eigen::Vector3d> places = node_rests(scene);
  const auto place_of = [&](std::size_t j) { return places[as_size(skeleton.joints[j])]; };
  const std::size_t count = skeleton.joints.size();

  // The root moves all joints, so it does not distinguish them.
  std::vector<bool> is_moved(count, false), has_movement(count);
  std::vector<std::size_t> end(count);  // Depth first: the joints below j end before end[j].
  double reach = 0.0;
  for (std::size_t j = 0; j < count; ++j) {
    has_movement[j] = moves[as_size(skeleton.joints[j])];
    is_moved[j] = j > 0 && (has_movement[j] || is_moved[as_size(skeleton.parents[j])]);
    end[j] = j + 1;
    reach = std::max(reach, (place_of(j) - place_of(0)).norm());
  }
  for (std::size_t j = count; j-- > 1;) {
    const std::size_t parent = as_size(skeleton.parents[j]);
    has_movement[parent] = has_movement[parent] || has_movement[j];
    end[parent] = std::max(end[parent], end[j]);
  }

  const auto has_counterpart = [&](std::size_t joint) {
    for (std::size_t other = 0; other < count; ++other) {
      if (is_moved[other] && (place_of(other) - place_of(joint)).norm() < kSame * reach)
        return true;
    }
    return false;
  };
  std::vector<std::size_t> others_before(count + 1);  // Joints without counterpart before each.
  for (std::size_t j = 0; j < count; ++j) {
    const bool may_be_copied = !is_moved[j] && !has_movement[j];
    others_before[j + 1] = others_before[j] + (may_be_copied && !has_counterpart(j) ? 1 : 0);
  }
  const auto is_copy = [&](std::size_t top) {
    if (is_moved[top] || has_movement[top] || end[top] - top < kMinBodyJoints) return false;
    const auto others = static_cast<double>(others_before[end[top]] - others_before[top]);
    return others <= kMostOthers * static_cast<double>(end[top] - top);
  };

  SceneSkeleton kept;
  kept.others = std::move(skeleton.others);
  std::vector<int> index(count, -1);
  for (std::size_t j = 0; j < count;) {
    if (j > 0 && is_copy(j)) {
      j = end[j];
      continue;
    }
    index[j] = static_cast<int>(kept.joints.size());
    kept.joints.push_back(skeleton.joints[j]);
    kept.parents.push_back(j == 0 ? -1 : index[as_size(skeleton.parents[j])]);
    ++j;
  }
  skeleton = std::move(kept);
  return count - skeleton.joints.size();
}

}  // namespace retarget
