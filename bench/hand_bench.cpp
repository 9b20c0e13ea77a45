// Times human hand shapes, targets and joints per hand and frame, for hands that open and close
// within a second.

#include <benchmark/benchmark.h>

#include <memory>
#include <string>

#include "retarget/load_robot.h"
#include "retarget/trigonometry.h"
#include "solve/hands/hand_solver.h"
#include "solve/hands/hand_target.h"
#include "support/finger_clip.h"

namespace retarget {
namespace {

constexpr int kFrames = 300;

void solve_hand(benchmark::State& state, const std::shared_ptr<const Robot>& robot) {
  const RobotHand hand = *find_hands(*robot)[0];
  const auto count = static_cast<Eigen::Index>(hand.variables.size());
  Eigen::VectorXd lower(count), upper(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const int joint = hand.variables[static_cast<std::size_t>(i)];
    lower[i] = robot->model_limits().lower[joint];
    upper[i] = robot->model_limits().upper[joint];
  }
  FingerClip source(kFrames);
  for (int frame = 0; frame < kFrames; ++frame) {
    const double bend = 0.7 * (1.0 + portable::sin_cos(0.2 * frame).sine);
    for (const Finger finger : kFingers) source.bend(frame, 0, finger, {bend, bend, 0.6 * bend});
  }
  const SourceHands found = source.hands();
  HandPoser poser(source.clip(), *found[0]);
  const HandMatch match(hand);
  HandSolver solver(hand, lower, upper);
  HandShape shape;
  HandTarget target;
  int frame = 0;
  for (auto _ : state) {
    poser.shape(frame++ % kFrames, shape);
    match.target(shape, target);
    benchmark::DoNotOptimize(solver.solve(target)[0]);
  }
}

void three_fingers(benchmark::State& state) {
  const std::string folder = RETARGET_SOURCE_DIR "/robots/unitree_g1_with_hands";
  const auto robot = load_robot_files(folder + "/model.xml", folder + "/robot.json");
  if (!robot) {
    state.SkipWithError("the robot cannot be loaded");
    return;
  }
  solve_hand(state, *robot);
}
BENCHMARK(three_fingers);

}  // namespace
}  // namespace retarget
