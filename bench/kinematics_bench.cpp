// Times single steps of inverse kinematics, forward kinematics and resampling over whole clips.

#include "bench_support.h"
#include "retarget/clip.h"
#include "retarget/resample.h"
#include "solve/ik/ik_solver.h"

namespace retarget {
namespace {

constexpr const char* kClip = "walk4_subject1";

// Poses along a clip, each with the targets of a few frames later: the input of a step.
struct StepCases {
  std::shared_ptr<const IkProblem> problem;
  std::vector<std::vector<double>> qpos;
  std::vector<std::vector<Pose>> world_from_target;
};

StepCases make_step_cases() {
  constexpr int kCases = 32;
  constexpr int kFramesAhead = 3;
  const BenchCase bench = load_case(kClip);
  const TargetBuilder targets(bench.config, bench.human.height);
  StepCases cases;
  cases.problem = make_problem(bench.robot, bench.config, targets, bench.limits);
  const auto solver = make_fast_solver(cases.problem);
  std::vector<double> qpos = bench.robot->zero_configuration();
  std::vector<Pose> world_from_target(targets.target_count());
  const int frames = std::min(kCases + kFramesAhead, bench.human.frame_count);
  for (int frame = 0; frame < frames; ++frame) {
    targets.build(bench.human.frame(frame), world_from_target);
    for (std::size_t pass = 0; pass < cases.problem->passes.size(); ++pass) {
      solver->solve_pass(static_cast<int>(pass), world_from_target, qpos);
    }
    if (frame < frames - kFramesAhead) cases.qpos.push_back(qpos);
    if (frame >= kFramesAhead) cases.world_from_target.push_back(world_from_target);
  }
  return cases;
}

// One step of the second pass from fixed poses, which are copied every time.
void ik_step(benchmark::State& state, bool fast) {
  const StepCases cases = make_step_cases();
  IkOptions options;
  options.max_extra_steps = 0;
  const auto solver = fast ? make_fast_solver(cases.problem, options)
                           : make_reference_solver(cases.problem, options);
  const int pass = static_cast<int>(cases.problem->passes.size()) - 1;
  std::vector<double> qpos = cases.qpos.front();
  std::size_t next = 0;
  long steps = 0;
  for (auto _ : state) {
    const std::size_t i = next++ % cases.qpos.size();
    std::ranges::copy(cases.qpos[i], qpos.begin());
    steps += solver->solve_pass(pass, cases.world_from_target[i], qpos).steps;
    benchmark::DoNotOptimize(qpos.data());
  }
  state.counters["steps"] = static_cast<double>(steps) / static_cast<double>(state.iterations());
}
BENCHMARK_CAPTURE(ik_step, fast, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(ik_step, reference, false)->Unit(benchmark::kMicrosecond);

void clip_forward_kinematics(benchmark::State& state) {
  const Clip clip = load_bvh(clip_path(kClip).string()).value().clip;
  std::vector<Pose> world_from_joint(clip.skeleton().joint_count());
  for (auto _ : state) {
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      forward_kinematics(clip, frame, world_from_joint);
      benchmark::DoNotOptimize(world_from_joint.data());
    }
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(clip.frame_count()) * state.iterations());
}
BENCHMARK(clip_forward_kinematics)->Unit(benchmark::kMillisecond);

void robot_forward_kinematics(benchmark::State& state) {
  const StepCases cases = make_step_cases();
  const Robot& robot = *cases.problem->robot;
  const int frames = load_case(kClip).human.frame_count;
  std::vector<Pose> world_from_body(robot.bodies().size());
  for (auto _ : state) {
    for (int frame = 0; frame < frames; ++frame) {
      forward_kinematics(robot, cases.qpos[frame % cases.qpos.size()], world_from_body);
      benchmark::DoNotOptimize(world_from_body.data());
    }
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(frames) * state.iterations());
}
BENCHMARK(robot_forward_kinematics)->Unit(benchmark::kMillisecond);

// The clip is treated as one of 120 frames per second; items are source frames.
void resample_120_to_30(benchmark::State& state, bool antialias) {
  Clip clip = load_bvh(clip_path(kClip).string()).value().clip;
  clip.set_rate(frame_rate_from_fps(120.0));
  ResampleOptions options;
  options.antialias = antialias;
  for (auto _ : state) {
    benchmark::DoNotOptimize(resample(clip, frame_rate_from_fps(30.0), options));
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(clip.frame_count()) * state.iterations());
}
BENCHMARK_CAPTURE(resample_120_to_30, antialias, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(resample_120_to_30, plain, false)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace retarget
