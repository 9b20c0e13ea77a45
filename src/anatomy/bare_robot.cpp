#include "anatomy/bare_robot.h"

#include <mujoco/mujoco.h>

#include <utility>
#include <vector>

#include "anatomy/limbs.h"
#include "anatomy/neighbours.h"
#include "anatomy/shapes.h"
#include "base/try.h"

namespace retarget {

Result<CompletedRobot> complete_bare_robot(const Robot& bare, const std::string& model_path) {
  TRY_ASSIGN(const auto limbs, find_limbs(bare, model_path));
  RobotShapes found = find_shapes(bare, limbs, mesh_points(model_path));
  RobotProfile profile = bare.profile();
  profile.soles = std::move(found.soles);
  if (profile.allowed_self_contact.empty()) profile.allowed_self_contact = neighbours(bare);
  std::vector<CollisionShape> shapes;
  int shapeless = 0;
  for (const RoughShape& rough : found.shapes) {
    const bool measured = rough.shape.geom >= 0 || rough.source == ShapeSource::kMesh;
    if (measured) shapes.push_back(rough.shape);
    if (!measured) ++shapeless;
  }

  ModelPtr model(mj_copyModel(nullptr, bare.model()));
  auto robot = std::make_shared<Robot>(std::move(model), std::move(profile), bare.warnings());
  robot->set_collision_shapes(std::move(shapes));
  const bool guessed = found.sole_source == ShapeSource::kEstimated;
  return CompletedRobot{std::move(robot), (guessed ? "" : "from ") + source_text(found.sole_source),
                        guessed, shapeless};
}

}  // namespace retarget
