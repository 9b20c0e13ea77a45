#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "retarget/error.h"
#include "retarget/robot.h"
#include "robot/model_meshes.h"

namespace retarget {

/// Two bodies that an equality ties together, by name.
struct TiedBodies {
  std::string first, second;
};

/// A compiled model and what MuJoCo found odd in it.
struct LoadedModel {
  ModelPtr model;
  std::vector<std::string> warnings;
  std::string floated_body;          ///< The body that was given a free joint; empty: none was.
  std::vector<std::string> sliding;  ///< Joints of a sliding root that the free joint replaces.
  std::vector<std::string> held;     ///< Ball joints that carry no other joint, taken away.
  std::vector<TiedBodies> tied;      ///< By equalities that were dropped.
  /// What the model says of joints that others move (equalities of joints, a URDF's `mimic`), by the
  /// joint that is moved. Equalities are dropped; of curved ones the slope at 0 is kept.
  std::map<std::string, JointCoupling> couplings;
  /// Bodies whose contact the model says is none (`<exclude>`), by name.
  std::vector<std::pair<std::string, std::string>> excluded;
  std::vector<ModelMesh> meshes;  ///< What bodies are drawn with, if it was asked for.
};

/// What is done to a model beyond dropping what plays no part in kinematics.
struct ModelChanges {
  /// Give the robot a free joint if it has none (URDFs, robots bolted down): the topmost body with
  /// the most joints below it moves freely, which needs it to have no joints of its own; slides and
  /// what follows them there (planar roots) are taken away. Ball joints that carry no joint are held.
  bool float_base = false;
  /// Give bodies and joints that have no name one: body_1, joint_1, ...
  bool name_all = false;
  /// Compile the meshes too, for their vertices; their files must be there then.
  bool keep_meshes = false;
  /// Tell where which mesh files are (LoadedModel::meshes), without reading them. The compiled model has
  /// small spheres in their places.
  bool find_meshes = false;
};

/// Compiles an MJCF (or URDF) file without its meshes and other assets, for kinematics.
///
/// Bodies whose mass or inertia MuJoCo refuses get next to none, with a warning.
/// Nothing is printed. Models of any kind are taken; a number that is not finite and a range
/// whose lower end is above the upper are errors.
/// Safe to call from several threads, which wait for each other.
[[nodiscard]] Result<LoadedModel> load_model(const std::string& path,
                                             const ModelChanges& changes = {});

/// Checks that a model is a robot that can move about: one free joint, its first, and else hinges
/// and slides.
[[nodiscard]] Result<void> check_robot_joints(const mjModel_& model, const std::string& path);

}  // namespace retarget
