// Times inverse kinematics per frame and per step, over whole clips, for each engine.

#include "bench_support.h"
#include "solve/ik/ik_solver.h"

namespace retarget {
namespace {

void solve_clip(benchmark::State& state, const char* clip, bool fast) {
  const BenchCase bench = load_case(clip);
  const TargetBuilder targets(bench.config, bench.human.height);
  const auto problem = make_problem(bench.robot, bench.config, targets, bench.limits);
  const auto solver = fast ? make_fast_solver(problem) : make_reference_solver(problem);
  std::vector<Pose> world_from_target(targets.target_count());
  long steps = 0, frames = 0;
  for (auto _ : state) {
    std::vector<double> qpos = bench.robot->zero_configuration();
    for (int frame = 0; frame < bench.human.frame_count; ++frame) {
      targets.build(bench.human.frame(frame), world_from_target);
      for (std::size_t pass = 0; pass < problem->passes.size(); ++pass) {
        steps += solver->solve_pass(static_cast<int>(pass), world_from_target, qpos).steps;
      }
    }
    frames += bench.human.frame_count;
  }
  state.SetItemsProcessed(frames);
  state.counters["steps_per_frame"] = static_cast<double>(steps) / static_cast<double>(frames);
  state.counters["time_per_step"] = benchmark::Counter(
      static_cast<double>(steps), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK_CAPTURE(solve_clip, walk4_fast, "walk4_subject1", true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(solve_clip, walk4_reference, "walk4_subject1", false)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(solve_clip, dance1_fast, "dance1_subject2", true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(solve_clip, dance1_reference, "dance1_subject2", false)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace retarget
