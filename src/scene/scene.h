#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// An index of a list, which is not negative, as the library's containers want it.
[[nodiscard]] constexpr std::size_t as_size(int index) {
  return static_cast<std::size_t>(index);
}

/// A node's place in its parent: scale first, then rotation, then translation.
struct NodeTransform {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
};

struct SceneNode {
  std::string name;    ///< As in the file; may be empty.
  int parent = -1;     ///< Smaller than the node's own index; -1: none.
  NodeTransform rest;  ///< Where nothing is animated.
  /// Its rotation where all of its own angles are zero: of FBX what stands before and after them.
  Eigen::Quaterniond unturned = Eigen::Quaterniond::Identity();
  bool is_bone = false;    ///< A limb, or a joint of a skin.
  bool is_object = false;  ///< A mesh, a camera or a light stands there.
  /// What it was bound to its skin in; world axes and units. Nothing where no skin says so.
  std::optional<Eigen::Affine3d> world_from_bind;
};

/// An animation: glTF's `animation`, FBX's `AnimStack`.
struct SceneTake {
  std::string name;
  double begin = 0.0, end = 0.0;  ///< Seconds, of all nodes' keys; begin <= end.
  std::vector<bool> has_keys;     ///< Of each node.
  std::vector<bool> moves;        ///< Of each node: whether its keys differ by more than rounding.
};

/// The animations of a scene.
class SceneMotion {
 public:
  SceneMotion() = default;
  SceneMotion(const SceneMotion&) = delete;
  SceneMotion& operator=(const SceneMotion&) = delete;
  virtual ~SceneMotion() = default;

  /// A node's place at a time, seconds. Numbers of a broken file may be none.
  [[nodiscard]] virtual NodeTransform at(int take, int node, double seconds) const = 0;
  /// The times of the keys of these nodes, seconds, in any order, perhaps several times each.
  [[nodiscard]] virtual std::vector<double> key_times(int take,
                                                      const std::vector<bool>& nodes) const = 0;
};

/// What is read of a file of 3D scenes: a tree of nodes and how they move.
struct Scene {
  std::string format;            ///< `FBX`, `glTF`, `VRM`.
  std::vector<SceneNode> nodes;  ///< Parents first.
  std::vector<SceneTake> takes;
  std::unique_ptr<SceneMotion> motion;
  double metres_per_unit = 1.0;
  std::optional<Eigen::Vector3d> up;  ///< In the scene's axes; nothing where the file does not say.
  double fps = 0.0;                   ///< That the file says it is made for; 0: it says none.
  std::vector<Warning> warnings;
};

}  // namespace retarget
