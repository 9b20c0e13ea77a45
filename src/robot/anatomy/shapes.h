#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "retarget/robot.h"
#include "robot/anatomy/limbs.h"

namespace retarget {

/// Surface points of bodies, by body index, in the body's frame; empty if unknown.
using BodyPoints = std::vector<std::vector<Eigen::Vector3d>>;

/// Surface points of bodies, from a model's meshes.
struct MeshPoints {
  /// Vertices, and points inside triangles whose vertices are far apart. Empty if files are
  /// missing.
  BodyPoints bodies;
  std::size_t named = 0;   ///< Number of mesh files that the model names.
  std::size_t absent = 0;  ///< Number of those that are missing or unreadable.
  std::string example;     ///< The first of those, as the model names it.
};

/// Source of a robot's soles and shapes.
enum class ShapeSource : unsigned char {
  kModel,      ///< Primitive geoms of the model that take part in contacts.
  kMesh,       ///< Fitted to the vertices of its meshes.
  kEstimated,  ///< Estimated from the lengths of the limbs.
};

/// An approximate shape of a body.
struct RoughShape {
  CollisionShape shape;
  ShapeSource source = ShapeSource::kModel;
};

/// The soles and shapes of a robot.
struct RobotShapes {
  std::vector<RoughShape> shapes;
  /// Left, right; points are heel left, heel right, toe left, toe right. Empty without legs.
  std::vector<Sole> soles;
  ShapeSource sole_source = ShapeSource::kModel;
  /// Human-readable source of the soles: source_text, with the reason if they are estimated.
  std::string sole_note;
  double ankle_height = 0.0;  ///< Height of the ankles (LimbPart::joint) above the soles, metres.
};

/// Samples a model's meshes, as far as the files exist: STL, OBJ and COLLADA files
/// (read_body_surfaces), and the formats that only MuJoCo reads.
[[nodiscard]] MeshPoints mesh_points(const Robot& robot, const std::string& model_path);

/// Finds soles and shapes. The model's own contact primitives are kept (cylinders become capsules).
/// A body without any gets up to three capsules around its mesh, a foot a box, the trunk whichever
/// has less volume. Without meshes, limb segments and feet get shapes of human proportions. Shapes
/// of bodies fixed to a body count as its own where they cover its mesh or segment. A sole is the
/// lowest part of a level foot (RobotAnatomy::legs), as four points: the touching points nearest to
/// its corners.
[[nodiscard]] RobotShapes find_shapes(const Robot& robot, const RobotAnatomy& limbs,
                                      const MeshPoints& mesh);

/// Thins points to one per grid cell, the first, so that the density no longer depends on the
/// vertex density of a mesh.
/// @param cell  edge length of a grid cell, in the points' unit.
[[nodiscard]] std::vector<Eigen::Vector3d> thinned(const std::vector<Eigen::Vector3d>& points,
                                                   double cell);

/// Returns the diagonal of the points' bounding box along the axes.
[[nodiscard]] double diagonal_of(const std::vector<Eigen::Vector3d>& points);

/// Returns the bounding box of points in a body's frame.
/// @param axes  the columns are the box's axes, in the body's frame.
[[nodiscard]] CollisionShape box_around(int body, const std::vector<Eigen::Vector3d>& points,
                                        const Eigen::Matrix3d& axes);

/// Fits one to three capsules (or spheres) tightly around surface points. Another capsule is added
/// only if it reduces the volume considerably. Each capsule has the smallest volume found by a
/// search from the points' principal axes.
/// @param points  at least one, evenly spread (thinned), in the body's frame, metres.
[[nodiscard]] std::vector<CollisionShape> capsules_around(
    int body, const std::vector<Eigen::Vector3d>& points);

/// Returns the volume of a sphere, a capsule or a box, cubic metres.
[[nodiscard]] double volume(const CollisionShape& shape);

}  // namespace retarget
