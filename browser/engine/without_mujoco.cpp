// Replacements for the places of the core, besides load_model, that use MuJoCo.

#include <algorithm>
#include <vector>

#include "judge/quality/mujoco_contacts.h"
#include "retarget/write_scene.h"
#include "robot/model/check_model.h"
#include "robot/model/collision.h"
#include "solve/ik/ik_solver.h"

namespace retarget {

// The reference engine computes with MuJoCo's kinematics. The engine of the page refuses the option,
// so nothing calls this.
std::unique_ptr<IkSolver> make_reference_solver(std::shared_ptr<const IkProblem> problem,
                                                const IkOptions& options,
                                                std::function<void(const QpRecord&)> /*observe*/) {
  return make_fast_solver(std::move(problem), options);
}

// Scenes whose file is a model, and their files for other programs.
Result<void> check_model(const std::string& path, bool /*with_meshes*/) {
  return config_failure(path, "the page does not read models", "use the command line tool");
}

Result<std::string> format_scene_mjcf(const RobotClip& /*motion*/, const SceneClip& /*scene*/) {
  return run_failure("", "the page does not write models", "use the command line tool");
}

MujocoContacts::MujocoContacts(std::shared_ptr<const Robot> robot) : robot_(std::move(robot)) {}

MujocoContacts::~MujocoContacts() = default;

// The exact depth, where MuJoCo's differs for boxes (docs/browser.md).
double MujocoContacts::depth(std::span<const double> qpos,
                             std::span<const std::pair<int, int>> geoms) {
  if (geoms.empty()) return 0.0;
  std::vector<Pose> world_from_body(robot_->bodies().size());
  forward_kinematics(*robot_, qpos, world_from_body);
  const CollisionModel collisions(*robot_);
  std::vector<RoundedShape> placed(collisions.shapes().size());
  collisions.place(world_from_body, placed);
  const auto shape_of = [&](int geom) {
    const auto& shapes = collisions.shapes();
    const auto found = std::ranges::find(shapes, geom, &CollisionShape::geom);
    return found - shapes.begin();
  };
  double deepest = 0.0;
  for (const auto& [first, second] : geoms) {
    const auto a = static_cast<std::size_t>(shape_of(first));
    const auto b = static_cast<std::size_t>(shape_of(second));
    deepest = std::max(deepest, -shape_distance(placed[a], placed[b]).distance);
  }
  return deepest;
}

}  // namespace retarget
