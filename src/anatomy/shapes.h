#pragma once

#include <string>
#include <vector>

#include "anatomy/limbs.h"
#include "retarget/robot.h"

namespace retarget {

/// Points of a body's surface in the body's frame, by body index; empty where nothing is known.
using BodyPoints = std::vector<std::vector<Eigen::Vector3d>>;

/// What a model's meshes tell of its bodies' surfaces.
struct MeshPoints {
  /// Vertices, and where these are far apart points of the triangles between them. Empty without files.
  BodyPoints bodies;
  std::size_t named = 0;   ///< Mesh files that the model names.
  std::size_t absent = 0;  ///< Of these, those that are not there or cannot be read.
  std::string example;     ///< The first absent one, as the model names it.
};

/// Where a robot's soles and shapes came from.
enum class ShapeSource : unsigned char {
  kModel,      ///< Primitive geoms of the model that take part in contacts.
  kMesh,       ///< Fitted to the vertices of its meshes.
  kEstimated,  ///< Guessed from the lengths of the limbs.
};

/// Where a shape is from: `mesh vertices`.
[[nodiscard]] std::string source_text(ShapeSource source);

/// A rough shape of a body.
struct RoughShape {
  CollisionShape shape;
  ShapeSource source = ShapeSource::kModel;
};

/// The soles and shapes of a robot.
struct RobotShapes {
  std::vector<RoughShape> shapes;
  /// Left, right: heel left, heel right, toe left, toe right; without legs none.
  std::vector<Sole> soles;
  ShapeSource sole_source = ShapeSource::kModel;
  /// Where the soles are from, for people: source_text, and where they are estimated why.
  std::string sole_note;
  double ankle_height = 0.0;  ///< From the soles up to the ankles (LimbPart::joint), metres.
};

/// The meshes of a model, as far as they are there: STL, OBJ and COLLADA files (read_body_surfaces), and
/// what MuJoCo reads besides.
[[nodiscard]] MeshPoints mesh_points(const Robot& robot, const std::string& model_path);

/// Soles and shapes. The model's own contact primitives are kept (cylinders become capsules); a
/// body without any gets up to three capsules around its mesh, a foot a box, the trunk whichever is
/// smaller; without these the limbs' segments and the feet have shapes of human proportions. A sole is what of a
/// foot lies lowest with the foot level, as four points: those that touch nearest to its corners.
[[nodiscard]] RobotShapes find_shapes(const Robot& robot, const RobotAnatomy& limbs,
                                      const MeshPoints& mesh);

}  // namespace retarget
