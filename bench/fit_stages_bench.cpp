// Times each stage of the whole-clip fit on one thread: walk4_subject1 on the G1.

#include <cstdint>
#include <vector>

#include "base/math/step_bounds.h"
#include "bench_support.h"
#include "retarget/so3.h"
#include "solve/fit/clip_fitter.h"
#include "solve/fit/fit_windows.h"
#include "solve/fit/frame_costs.h"
#include "solve/fit/joint_speeds.h"
#include "solve/fit/start_frames.h"
#include "solve/targets/solve_frames.h"

namespace retarget {
namespace {

constexpr const char* kClip = "walk4_subject1";

// The state of a fit before its first step, with the targets of the published method.
struct StagesCase {
  BenchCase bench = load_case(kClip);
  FitOptions options;
  FitModel model;
  SourceFeet feet;
  FitClip clip;
  RobotClip first;

  StagesCase() {
    options.dynamics = false;
    const TargetBuilder targets(bench.config, bench.human.height);
    BoneArray<int> target_of_bone;
    for (const Bone bone : kAllBones) target_of_bone[bone] = targets.target_of(bone);
    model = make_fit_model(*bench.robot, bench.config, bench.limits, target_of_bone, options);
    first = solve_frames(bench.human, bench.robot, bench.config, bench.limits).value().clip;
    clip.frame_count = bench.human.frame_count;
    clip.frame_time = bench.human.rate.frame_time();
    feet = SourceFeet(bench.human, bench.human.frame_count);
    take_targets(targets);
    plan();
    start();
  }

  void take_targets(const TargetBuilder& targets) {
    std::vector<Pose> world_from_target(static_cast<std::size_t>(targets.target_count()));
    clip.targets.clear();
    for (int frame = 0; frame < clip.frame_count; ++frame) {
      targets.build(bench.human.frame(frame), world_from_target);
      for (const FitTask& task : model.tasks) {
        const Pose& pose = world_from_target[static_cast<std::size_t>(task.target)];
        clip.targets.push_back({pose.translation, pose.rotation * task.link_from_body.conjugate()});
      }
    }
  }

  void plan() {
    std::vector<int> source_feet;
    for (const FitFoot& foot : model.feet) source_feet.push_back(foot.left ? 0 : 1);
    plan_feet(feet, find_contacts(feet, contact_options(options)), contact_options(options),
              source_feet, 0.75, clip.feet);
  }

  void start() {
    const std::vector<Eigen::Vector3d> path(static_cast<std::size_t>(clip.frame_count),
                                            Eigen::Vector3d::Zero());
    StartFrames starts(model, path, true, clip);
    for (int frame = 0; frame < clip.frame_count; ++frame) {
      starts.take(frame, std::as_const(first).qpos(frame));
    }
  }

  [[nodiscard]] FitWindow window() const { return plan_windows(clip, options).windows.front(); }
};

const StagesCase& stages() {
  static const StagesCase made;
  return made;
}

void per_frame(benchmark::State& state, int frames) {
  state.SetItemsProcessed(state.iterations() * frames);
}

// Targets and contact plan of the whole clip.
void fit_targets(benchmark::State& state) {
  StagesCase work = stages();
  const TargetBuilder targets(work.bench.config, work.bench.human.height);
  for (auto _ : state) work.take_targets(targets);
  per_frame(state, work.clip.frame_count);
}
BENCHMARK(fit_targets)->Unit(benchmark::kMillisecond);

void fit_contact_plan(benchmark::State& state) {
  StagesCase work = stages();
  for (auto _ : state) work.plan();
  per_frame(state, work.clip.frame_count);
}
BENCHMARK(fit_contact_plan)->Unit(benchmark::kMillisecond);

// The frame-by-frame pass from a settled start.
void fit_first_stage(benchmark::State& state) {
  const StagesCase& work = stages();
  SolveFramesOptions options;
  options.settle = true;
  for (auto _ : state) {
    benchmark::DoNotOptimize(solve_frames(work.bench.human, work.bench.robot, work.bench.config,
                                          work.bench.limits, options));
  }
  per_frame(state, work.clip.frame_count);
}
BENCHMARK(fit_first_stage)->Unit(benchmark::kMillisecond);

void fit_starts(benchmark::State& state) {
  StagesCase work = stages();
  for (auto _ : state) work.start();
  per_frame(state, work.clip.frame_count);
}
BENCHMARK(fit_starts)->Unit(benchmark::kMillisecond);

// All steps of one window, and the parts of one step.
void fit_window_steps(benchmark::State& state) {
  const StagesCase& work = stages();
  const FitWindow window = work.window();
  FitStatus status;
  for (auto _ : state) {
    state.PauseTiming();
    FitClip clip = work.clip;
    state.ResumeTiming();
    status = fit_window(work.model, work.options, window, clip, {});
  }
  per_frame(state, window.end - window.begin);
  state.counters["steps"] = status.steps;
}
BENCHMARK(fit_window_steps)->Unit(benchmark::kMillisecond);

void fit_step_assembly(benchmark::State& state) {
  const StagesCase& work = stages();
  const FitWindow window = work.window();
  const int dofs = work.model.dof_count();
  FrameTerms terms(work.model, work.options);
  TreeState pose(work.model.tree);
  std::vector<double> gradient(static_cast<std::size_t>(dofs)),
      hessian(gradient.size() * gradient.size());
  std::vector<std::uint32_t> pairs;
  for (auto _ : state) {
    for (int frame = window.begin; frame < window.end; ++frame) {
      TermCosts costs{};
      pose.update(work.clip.frame(frame, work.model.configuration_size));
      // Pairs are searched every fourth step.
      if (frame % 4 == 0) terms.find_near_pairs(pose, 0.04, pairs);
      terms.assemble(pose, work.clip.goals(frame, work.model.tasks.size()), pairs, gradient.data(),
                     hessian.data(), dofs, costs);
      benchmark::DoNotOptimize(costs.data());
    }
  }
  per_frame(state, window.end - window.begin);
}
BENCHMARK(fit_step_assembly)->Unit(benchmark::kMillisecond);

void fit_step_smoothing(benchmark::State& state) {
  const StagesCase& work = stages();
  const FitWindow window = work.window();
  JointSpeeds speeds(work.model, work.options, work.clip);
  for (auto _ : state) speeds.update(work.model, work.clip, window.begin, window.end);
  per_frame(state, window.end - window.begin);
}
BENCHMARK(fit_step_smoothing)->Unit(benchmark::kMillisecond);

// The costs of the terms in the report, which a line search would compute in every step.
void fit_costs(benchmark::State& state) {
  const StagesCase& work = stages();
  const FitWindow window = work.window();
  std::vector<TermCosts> costs(static_cast<std::size_t>(window.end - window.begin));
  for (auto _ : state) frame_costs(work.model, work.options, work.clip, window, costs);
  per_frame(state, window.end - window.begin);
}
BENCHMARK(fit_costs)->Unit(benchmark::kMillisecond);

// All joints of the whole clip, some of them too fast.
void fit_bounds(benchmark::State& state) {
  const StagesCase& work = stages();
  const auto frames = static_cast<std::size_t>(work.clip.frame_count);
  std::vector<double> values(frames);
  for (auto _ : state) {
    for (std::size_t link = 1; link < work.model.tree.links().size(); ++link) {
      const auto address = static_cast<std::size_t>(work.model.tree.links()[link].qpos_address);
      for (std::size_t t = 0; t < frames; ++t) {
        values[t] = work.clip.frame(static_cast<int>(t), work.model.configuration_size)[address];
      }
      benchmark::DoNotOptimize(bound_steps(values, -1.0, 1.0, 0.1));
    }
  }
  per_frame(state, work.clip.frame_count);
}
BENCHMARK(fit_bounds)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace retarget
