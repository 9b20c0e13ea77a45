// Times the stages around inverse kinematics: reading, kinematics, targets, writing.

#include "bench_support.h"
#include "retarget/file.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "support/lafan1_map.h"

namespace retarget {
namespace {

void read_clip(benchmark::State& state) {
  const std::string path = clip_path("walk4_subject1").string();
  const std::string bytes(read_file(path).value().view());
  for (auto _ : state) benchmark::DoNotOptimize(read_bvh(bytes, path));
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes.size()) * state.iterations());
}
BENCHMARK(read_clip)->Unit(benchmark::kMillisecond);

void human_poses(benchmark::State& state) {
  const auto file = load_bvh(clip_path("walk4_subject1").string()).value();
  const Calibration calibration = lafan1_calibration(file.clip.skeleton());
  for (auto _ : state) benchmark::DoNotOptimize(to_human(file.clip, calibration));
  state.SetItemsProcessed(static_cast<std::int64_t>(file.clip.frame_count()) * state.iterations());
}
BENCHMARK(human_poses)->Unit(benchmark::kMillisecond);

void build_targets(benchmark::State& state) {
  const BenchCase bench = load_case("walk4_subject1");
  const TargetBuilder targets(bench.config, bench.human.height);
  std::vector<Pose> world_from_target(targets.target_count());
  for (auto _ : state) {
    for (int frame = 0; frame < bench.human.frame_count; ++frame) {
      targets.build(bench.human.frame(frame), world_from_target);
      benchmark::DoNotOptimize(world_from_target.data());
    }
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(bench.human.frame_count) * state.iterations());
}
BENCHMARK(build_targets)->Unit(benchmark::kMillisecond);

void write_csv(benchmark::State& state) {
  const BenchCase bench = load_case("walk4_subject1");
  const RobotClip clip(bench.robot, bench.human.rate, bench.human.frame_count);
  std::int64_t bytes = 0;
  for (auto _ : state) {
    const std::string text = format_robot_csv(clip);
    bytes += static_cast<std::int64_t>(text.size());
  }
  state.SetBytesProcessed(bytes);
}
BENCHMARK(write_csv)->Unit(benchmark::kMillisecond);

void load_g1(benchmark::State& state) {
  const std::filesystem::path folder =
      std::filesystem::path(RETARGET_SOURCE_DIR) / "robots" / "unitree_g1";
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        load_robot_files((folder / "model.xml").string(), (folder / "robot.json").string()));
  }
}
BENCHMARK(load_g1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace retarget
