#pragma once

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "solve/ik/ik_solver.h"
#include "support/test_robots.h"

namespace retarget {

/// A problem of two passes with targets and a configuration to start from.
struct IkCase {
  std::shared_ptr<IkProblem> problem;
  std::vector<Pose> targets;
  std::vector<double> start;
};

/// A configuration inside the limits, with the root moved and rotated by about `spread`.
inline std::vector<double> random_configuration(const Robot& robot, std::mt19937& engine,
                                                double spread) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const LimitSet& limits = robot.model_limits();
  std::vector<double> qpos = robot.zero_configuration();
  for (int i = 0; i < 3; ++i) qpos[i] += spread * uniform(engine);
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(1.0, spread * uniform(engine), spread * uniform(engine),
                         spread * uniform(engine))
          .normalized();
  qpos[3] = turn.w();
  for (int i = 0; i < 3; ++i) qpos[4 + i] = turn.vec()[i];
  for (std::size_t j = 0; j < robot.joints().size(); ++j) {
    const double middle = std::clamp(0.0, limits.lower[j], limits.upper[j]);
    const double q = middle + spread * uniform(engine);
    qpos[robot.joints()[j].qpos_address] = std::clamp(q, limits.lower[j], limits.upper[j]);
  }
  return qpos;
}

/// Random bodies, weights (some zero) and near targets that are not exactly reachable.
inline IkCase random_case(std::shared_ptr<const Robot> robot, int tasks, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  IkCase result;
  result.problem = std::make_shared<IkProblem>();
  const LimitSet& limits = robot->model_limits();
  const auto joints = static_cast<Eigen::Index>(robot->joints().size());
  result.problem->lower = Eigen::Map<const Eigen::VectorXd>(limits.lower.data(), joints);
  result.problem->upper = Eigen::Map<const Eigen::VectorXd>(limits.upper.data(), joints);
  result.start = random_configuration(*robot, engine, 0.5);
  std::vector<Pose> world_from_body(robot->bodies().size());
  forward_kinematics(*robot, random_configuration(*robot, engine, 0.6), world_from_body);

  std::vector<int> bodies(robot->bodies().size() - 1);
  for (std::size_t b = 0; b < bodies.size(); ++b) bodies[b] = static_cast<int>(b) + 1;
  std::shuffle(bodies.begin(), bodies.end(), engine);
  bodies.resize(std::min<std::size_t>(bodies.size(), tasks));
  result.problem->passes.resize(2);
  for (const int body : bodies) {
    Pose target = world_from_body[body];
    for (int i = 0; i < 3; ++i) target.translation[i] += 0.02 * uniform(engine);
    result.targets.push_back(target);
    const int index = static_cast<int>(result.targets.size()) - 1;
    const double heavy = 10.0 + 90.0 * std::abs(uniform(engine));
    result.problem->passes[0].push_back({body, index, index % 3 == 0 ? 0.0 : heavy, 10.0});
    result.problem->passes[1].push_back({body, index, heavy, index % 4 == 0 ? 0.0 : 5.0});
  }
  result.problem->robot = std::move(robot);
  return result;
}

}  // namespace retarget
