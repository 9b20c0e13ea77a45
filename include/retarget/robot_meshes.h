#pragma once

#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/robot.h"
#include "retarget/triangle_mesh.h"

namespace RETARGET_API retarget {

/// Visual mesh of a body.
struct BodyMesh {
  int body = 0;
  TriangleMesh mesh;  ///< Mesh in the body's frame.
};

/// Visual meshes of a robot.
struct RobotMeshes {
  std::vector<BodyMesh> bodies;    ///< Bodies with a mesh, each at most once.
  std::vector<std::string> notes;  ///< Meshes that are missing or unreadable, one sentence each.
};

/// Loads the meshes of a robot from STL, OBJ and COLLADA files and simplifies them to keep pages
/// small.
///
/// The files are those named in a model (MJCF: `<mesh file>` with meshdir, scale, refpos and
/// refquat; URDF: `<visual>`, also `package://`), with the poses and the unit given there. If a
/// body has geoms without contacts, only these are visual; otherwise all of its meshes are.
/// Without a choice of the user, the folder `meshes/NAME` of the user's own data (user_data_folder)
/// comes first, if it exists: a model in it, or its files. It gives notes, not errors.
/// @param model  the robot's own model; its mesh files are in its folder or the parent folder. A
///     missing or unreadable file gives a note, not an error. Empty: no model is known.
/// @param named  the user's choice; empty: none. Either another model of the robot, used instead of
///     its own, or a folder. The folder is searched first for the model's files, then for files
///     named like bodies: in the bodies' frames, in metres, or in millimetres if larger than 10 m.
/// @return errors only for `named`: no such folder (kUsage); no readable mesh of a body (kInput); an
///     unreadable model (kConfig).
[[nodiscard]] Result<RobotMeshes> load_robot_meshes(const Robot& robot, const std::string& model,
                                                    const std::string& named = {});

}  // namespace retarget
