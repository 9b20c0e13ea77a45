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

/// Converts a non-negative index for use with standard containers.
[[nodiscard]] constexpr std::size_t as_size(int index) {
  return static_cast<std::size_t>(index);
}

/// Transform of a node relative to its parent: scale first, then rotation, then translation.
struct NodeTransform {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
};

struct SceneNode {
  std::string name;    ///< Name in the file; may be empty.
  int parent = -1;     ///< Smaller than the node's own index; -1: none.
  NodeTransform rest;  ///< Transform without animation.
  /// Rotation when all animated angles are zero: in FBX the pre- and post-rotation.
  Eigen::Quaterniond unturned = Eigen::Quaterniond::Identity();
  bool is_bone = false;    ///< A limb, or a joint of a skin.
  bool is_object = false;  ///< A mesh, a camera or a light is attached.
  /// Bind pose in world axes and units; nothing if no skin defines it.
  std::optional<Eigen::Affine3d> world_from_bind;
};

/// An animation: glTF's `animation`, FBX's `AnimStack`.
struct SceneTake {
  std::string name;
  double begin = 0.0, end = 0.0;  ///< Seconds, over the keys of all nodes; begin <= end.
  std::vector<bool> has_keys;     ///< Whether a node has keys, one entry per node.
  std::vector<bool> moves;  ///< Whether the keys of a node differ by more than rounding, one entry
                            ///< per node.
};

/// The animations of a scene.
class SceneMotion {
 public:
  SceneMotion() = default;
  SceneMotion(const SceneMotion&) = delete;
  SceneMotion& operator=(const SceneMotion&) = delete;
  virtual ~SceneMotion() = default;

  /// Transform of a node at a time in seconds. In a broken file it may contain NaN.
  [[nodiscard]] virtual NodeTransform at(int take, int node, double seconds) const = 0;
  /// Key times of these nodes, seconds, in any order, possibly with duplicates.
  [[nodiscard]] virtual std::vector<double> key_times(int take,
                                                      const std::vector<bool>& nodes) const = 0;
};

/// The content of a scene file: a tree of nodes and their motion.
struct SceneGraph {
  std::string format;            ///< `FBX`, `glTF`, `VRM`.
  std::vector<SceneNode> nodes;  ///< Parents precede children.
  std::vector<SceneTake> takes;
  std::unique_ptr<SceneMotion> motion;
  double metres_per_unit = 1.0;
  std::optional<Eigen::Vector3d> up;  ///< Up direction in the scene's axes; nothing if the file
                                      ///< does not define it.
  double fps = 0.0;                   ///< Nominal rate of the file; 0 if it has none.
  std::vector<Warning> warnings;
};

}  // namespace retarget
