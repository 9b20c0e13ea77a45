// Measures the wall time of the whole-clip fit on one and several threads, including its first
// stage. The reference is the published method on the same clip in the same run.

#include "bench_support.h"
#include "solve/fit/fit.h"
#include "support/lafan1_map.h"

namespace retarget {
namespace {

struct FitCase {
  std::shared_ptr<const Robot> robot;
  ResolvedConfig config;
  LimitSet limits;
  Clip clip;
  Calibration calibration;
};

FitCase load_fit_case(const char* clip) {
  BenchCase bench = load_case(clip);
  auto file = load_bvh(clip_path(clip).string()).value();
  Calibration calibration = lafan1_calibration(file.clip.skeleton());
  return {std::move(bench.robot), std::move(bench.config), std::move(bench.limits),
          std::move(file.clip), std::move(calibration)};
}

void fit_clip(benchmark::State& state, const char* clip) {
  const FitCase bench = load_fit_case(clip);
  FitOptions options;
  options.threads = static_cast<int>(state.range(0));
  options.dynamics = state.range(1) != 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        fit(bench.clip, bench.calibration, bench.robot, bench.config, bench.limits, options));
  }
  state.SetItemsProcessed(state.iterations() * bench.clip.frame_count());
}

void published_method(benchmark::State& state, const char* clip) {
  const FitCase bench = load_fit_case(clip);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        solve_frames(bench.clip, bench.calibration, bench.robot, bench.config, bench.limits));
  }
  state.SetItemsProcessed(state.iterations() * bench.clip.frame_count());
}

BENCHMARK_CAPTURE(published_method, walk4, "walk4_subject1")
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fit_clip, walk4, "walk4_subject1")
    ->ArgNames({"threads", "dynamics"})
    ->ArgsProduct({{1, 2, 4}, {0, 1}})
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace retarget
