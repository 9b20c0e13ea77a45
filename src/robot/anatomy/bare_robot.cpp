#include "robot/anatomy/bare_robot.h"

#include <mujoco/mujoco.h>
#include <utility>

#include "base/try.h"
#include "robot/anatomy/limbs.h"
#include "robot/anatomy/overlaps.h"
#include "robot/anatomy/shapes.h"
#include "robot/model/load_model.h"

namespace retarget {

Result<CompletedRobot> complete_bare_robot(const Robot& bare, const std::string& model_path) {
  TRY_ASSIGN(const auto limbs, find_limbs(bare, model_path));
  RobotShapes found = find_shapes(bare, limbs, mesh_points(bare, model_path));
  RobotProfile profile = bare.profile();
  profile.soles = std::move(found.soles);
  profile.soles_source = found.sole_note;
  profile.soles_estimated = found.sole_source == ShapeSource::kEstimated;
  const bool contacts_known = !profile.allowed_self_contact.empty();
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
  std::vector<std::string> overlaps;
  if (!contacts_known) {
    TRY_ASSIGN(const LoadedModel loaded, load_model(model_path));
    const std::vector<std::vector<double>> poses = {reference_configuration(bare)};
    AllowedContacts allowed = find_allowed_contacts(*robot, limbs, loaded.excluded, poses);
    for (const ModelOverlap& overlap : allowed.overlaps) {
      overlaps.push_back(overlap_text(bare, overlap));
    }
    RobotProfile with_contacts = robot->profile();
    with_contacts.allowed_self_contact = std::move(allowed.pairs);
    robot->set_profile(std::move(with_contacts));
  }
  const bool guessed = robot->profile().soles_estimated;
  return CompletedRobot{std::move(robot), (guessed ? "" : "from ") + found.sole_note, guessed,
                        shapeless, std::move(overlaps)};
}

}  // namespace retarget
