#pragma once

#include <string>
#include <vector>

#include "anatomy/limbs.h"
#include "retarget/robot.h"

namespace retarget {

/// Points of a body's surface in the body's frame, by body index; empty where nothing is known.
using BodyPoints = std::vector<std::vector<Eigen::Vector3d>>;

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
  std::vector<Sole> soles;  ///< Left, right: heel left, heel right, toe left, toe right.
  ShapeSource sole_source = ShapeSource::kModel;
  double ankle_height = 0.0;  ///< From the soles up to the ankles (LimbPart::joint), metres.
};

/// Vertices of a model's meshes by body; empty when one of its files cannot be read. Files that
/// MuJoCo does not read as meshes count as missing.
[[nodiscard]] BodyPoints mesh_points(const std::string& model_path);

/// Soles and shapes. The model's own contact primitives are kept (cylinders become capsules); a
/// body without any gets a capsule, foot and trunk a box, around its mesh's vertices; without
/// these the limbs' segments and the feet have shapes of human proportions. A sole is what of a
/// foot lies lowest with the foot level, as four points: those that touch nearest to its corners.
[[nodiscard]] RobotShapes find_shapes(const Robot& robot, const RobotAnatomy& limbs,
                                      const BodyPoints& mesh);

}  // namespace retarget
