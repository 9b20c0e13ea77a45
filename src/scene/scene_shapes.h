#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/scene.h"
#include "retarget/triangle_mesh.h"
#include "robot/model/read_mesh.h"

namespace retarget {

/// Maximum number of triangles of a mesh.
inline constexpr std::size_t kMaxSceneTriangles = 2'000'000;
/// Maximum size of a shape, and distance of a shape or body from the origin of its frame, metres.
inline constexpr double kMaxSceneReach = 1000.0;
/// "1000 m", or the number in units of a file that is not in metres.
[[nodiscard]] std::string reach_text(double reach);
/// The bottom of a height field is at least this far below its heights, metres.
inline constexpr double kHeightDepth = 1.0;

/// Reads a mesh file of a scene. A vertex v becomes scale * (file_from_mesh^-1 * v), metres.
/// @param axes   kOfFile for the meshes of robot models.
/// @param reach  bound of the coordinates of the result.
/// Errors: those of read_file and read_mesh_as_written; more than kMaxSceneTriangles triangles;
/// vertices beyond the bound.
[[nodiscard]] Result<TriangleMesh> load_scene_mesh(
    const std::string& file, ColladaAxes axes, double reach,
    const Eigen::Vector3d& scale = Eigen::Vector3d::Ones(), const Pose& file_from_mesh = {});

/// Loads a mesh that a scene names: next to the scene's file or one folder up.
[[nodiscard]] Result<TriangleMesh> find_scene_mesh(
    const std::string& named, const std::string& scene_file, ColladaAxes axes, double reach,
    const Eigen::Vector3d& scale = Eigen::Vector3d::Ones(), const Pose& file_from_mesh = {});

/// Shapes with the surface of a mesh: a box for each component (a set of triangles that share
/// corners) that is exactly a box, up to 0.001 % of its size, and one mesh for the rest.
[[nodiscard]] std::vector<SceneShape> shapes_of_mesh(const TriangleMesh& mesh,
                                                     const Pose& body_from_mesh);

/// The solid below a height field, with side walls and a bottom.
/// @param heights  heights by row, metres; row r and column c lie at (c * spacing.x, r * spacing.y)
/// @param columns  at least 2; the rows must be complete, and at least 2.
/// @param bottom   z of the bottom, below all heights, metres.
[[nodiscard]] TriangleMesh height_mesh(const std::vector<double>& heights, std::size_t columns,
                                       const Eigen::Vector2d& spacing, double bottom);

/// An ellipsoid about the origin whose surface is 0.2 % of its size inside the exact one.
[[nodiscard]] TriangleMesh ellipsoid_mesh(const Eigen::Vector3d& radii);

/// The surface of a shape as triangles with outward normals, in the frame of the shape's body,
/// metres. Round shapes have 32 sides; a plane is a square of 100 m.
[[nodiscard]] TriangleMesh mesh_of_shape(const SceneShape& shape);

}  // namespace retarget
