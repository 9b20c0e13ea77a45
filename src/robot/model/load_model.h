#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "retarget/error.h"
#include "retarget/robot.h"
#include "robot/model/model_meshes.h"

namespace retarget {

/// Two bodies, by name, that an equality constraint ties together.
struct TiedBodies {
  std::string first, second;
};

/// A compiled model with MuJoCo's warnings and the changes made to it.
struct LoadedModel {
  ModelPtr model;
  std::vector<std::string> warnings;
  std::string floated_body;          ///< The body that received a free joint; empty if none did.
  std::vector<std::string> sliding;  ///< Joints of a sliding root, replaced by the free joint.
  std::vector<std::string> held;     ///< Ball joints that carry no other joint; removed.
  std::vector<TiedBodies> tied;      ///< Body pairs of equality constraints that were dropped.
  /// Coupled joints by the name of the joint that follows (joint equalities, a URDF's `mimic`). The
  /// equalities themselves are dropped; polynomial ones are linearised at 0.
  std::map<std::string, JointCoupling> couplings;
  /// Body pairs excluded from contact (`<exclude>`), by name.
  std::vector<std::pair<std::string, std::string>> excluded;
  std::vector<ModelMesh> meshes;     ///< Meshes of the bodies, if requested.
  std::vector<std::string> dropped;  ///< Bodies of deleted geoms that may take part in contacts.
};

/// Changes to make to a model, beyond dropping elements without effect on kinematics.
struct ModelChanges {
  /// Add a free joint if the robot has none (URDFs, fixed-base robots) to the topmost body with the
  /// most joints below it, which must not have its own joints. Slides of a planar root and the
  /// joints after them there are removed. Ball joints that carry no joint are locked.
  bool float_base = false;
  /// Name unnamed bodies and joints: body_1, joint_1, ...
  bool name_all = false;
  /// Compile the meshes too, for their vertices; their files must exist.
  bool keep_meshes = false;
  /// Find the meshes and their poses (LoadedModel::meshes) without reading the files. The compiled
  /// model has small spheres in their place.
  bool find_meshes = false;
  /// Compile height fields whose elevations are in the model itself.
  bool keep_heights = false;
};

/// Compiles an MJCF (or URDF) file without its meshes and other assets, for kinematics.
///
/// Bodies with an impossible mass or inertia, and moving bodies without a mass, get a negligible or
/// balanced one, with a warning. A joint whose range is a single position other than 0 is limited
/// to it. Nothing is printed. Accepts any model, not only robots; non-finite numbers and ranges
/// whose lower end exceeds the upper are errors. Thread-safe; concurrent calls are serialised.
[[nodiscard]] Result<LoadedModel> load_model(const std::string& path,
                                             const ModelChanges& changes = {});

/// Checks that a model is a mobile robot: its first joint is its only free joint, all others are
/// hinges or slides.
[[nodiscard]] Result<void> check_robot_joints(const mjModel_& model, const std::string& path);

}  // namespace retarget
