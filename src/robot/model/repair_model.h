#pragma once

#include <mujoco/mujoco.h>
#include <tinyxml2.h>
#include <optional>
#include <string>
#include <vector>

#include "robot/model/load_model.h"
#include "robot/model/model_meshes.h"

namespace retarget {

/// MuJoCo accepts a free joint only at the top of the tree, and reports others when it compiles.
inline constexpr const char* kNestedFreeJoint = "free joint can only be used on top level";

/// Repairs the XML of a model that MuJoCo rejects for a reason other than its kinematics: sensors
/// and actuators that MuJoCo does not know, and bodies that represent the world.
///
/// The XML is that of the model with its included files, so lines of errors are not those of the
/// file.
class ModelRepair {
 public:
  /// @param path  a model that check_model has accepted.
  explicit ModelRepair(std::string path) : path_(std::move(path)) {}

  /// Removes the part that MuJoCo rejects, or the section that may contain it.
  /// @return the changed XML; nothing if the error concerns kinematics.
  [[nodiscard]] std::optional<std::string> repair(const std::string& complaint);

  /// Removes links of a URDF above the base: without mass, and fixed to a single link, which
  /// they do not tilt (ROS' base_footprint). The root of motions is then the base.
  /// @return the changed XML; nothing if there are none.
  [[nodiscard]] std::optional<std::string> drop_links_above_base();

  /// The removed parts, one sentence each.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  bool load();
  [[nodiscard]] std::string text() const;
  bool apply(const std::string& complaint);
  bool drop_attribute(const std::string& complaint);
  bool drop_sections(const std::string& complaint);
  bool free_world_bodies();
  bool free_world_links();

  std::string path_;
  tinyxml2::XMLDocument document_;
  bool dropped_sections_ = false;
  std::vector<std::string> notes_;
};

/// Returns the elements of a kind, in order; elements may be deleted while iterating over the list.
[[nodiscard]] std::vector<mjsElement*> elements_of(mjSpec* spec, mjtObj kind);

/// Gives bodies with a negative mass or moment of inertia small ones, which do not affect
/// kinematics. MuJoCo would reject them, or replace them without a message.
/// @return the names of those bodies.
std::vector<std::string> repair_negative_inertials(mjSpec* spec);

/// Gives bodies with an inertia matrix that MuJoCo rejects (without three positive principal
/// moments: dummies, rods, export errors) a small one.
/// @return the names of those bodies.
std::vector<std::string> repair_degenerate_inertias(mjSpec* spec);

/// Returns the first body whose given mass, inertia or centre of mass is not finite.
[[nodiscard]] std::optional<std::string> body_with_infinite_inertial(mjSpec* spec);

/// Returns notes about masses and inertias that a compiled model does not have as given, because
/// they affect the dynamics metrics: repaired ones, zero and impossible inertias, which MuJoCo
/// replaces without a message, and moving bodies without a mass (neither their own nor that of a
/// body fixed to them).
/// @param model  the compiled spec.
/// @param repaired  bodies with invalid masses or inertias, by name.
[[nodiscard]] std::vector<std::string> notes_about_inertials(
    mjSpec* spec, const mjModel& model, const std::vector<std::string>& repaired);

/// Limits joints whose range is a single position other than 0 to it. MuJoCo leaves them unlimited.
/// @param model  the compiled spec.
/// @return the names of the joints.
std::vector<std::string> lock_single_positions(mjSpec* spec, mjModel& model, bool is_urdf);

/// Removes the joints that move a model's root through the world, if one of them is a slide: those
/// of the topmost body and of the unbranched chain below it. The robot is the subtree with the most
/// joints.
/// @param spec  a model without a free joint.
/// @return the names of the joints; empty if the root does not slide.
std::vector<std::string> free_sliding_root(mjSpec* spec);

/// Locks ball joints that carry no other joint, such as rod ends and tendon hooks.
/// @return the names of the joints.
std::vector<std::string> hold_loose_balls(mjSpec* spec);

/// Returns the robot's topmost body: the one with the most joints below it; null in an empty model.
[[nodiscard]] mjsBody* robot_base(mjSpec* spec);

/// Returns the body pairs of `connect` and `weld` constraints, except those attached to the world.
[[nodiscard]] std::vector<TiedBodies> tied_bodies(mjSpec* spec);

/// Finds the poses of meshes on bodies. MuJoCo moves a mesh's own frame to its centre; a point geom
/// in place of the mesh keeps the model's pose, with frames, defaults and angles resolved.
class MeshGeoms {
 public:
  /// Replaces every mesh geom of an uncompiled model with a small sphere.
  void replace(mjSpec* spec);

  /// @param model  the compiled model.
  [[nodiscard]] std::vector<ModelMesh> find(const mjModel& model) const;

 private:
  struct Replaced {
    mjsElement* geom = nullptr;
    ModelMesh mesh;  // Without carriers.
  };
  std::vector<Replaced> replaced_;
};

}  // namespace retarget
