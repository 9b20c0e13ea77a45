// Runs the stages one by one, to inspect and replace decisions before solving and measure quality:
//     03_stages_by_hand walk.bvh unitree_g1 walk.csv

#include <retarget/retarget.h>

#include <cstdio>

namespace {

int fail(const retarget::Error& error) {
  std::fprintf(stderr, "%s\n", retarget::describe(error).c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: %s MOTION ROBOT OUTPUT\n", argv[0]);
    return 2;
  }
  const auto robot = retarget::load_robot(argv[2]);
  if (!robot) return fail(robot.error());
  auto clip = retarget::load_clip(argv[1]);
  if (!clip) return fail(clip.error());

  retarget::Options options;
  options.part.end_s = 2.0;  // the first two seconds
  options.time.fps = 60.0;
  auto plan = retarget::make_plan(std::move(*clip), *robot, options);
  if (!plan) return fail(plan.error());
  // Narrow the robot's joint ranges by 2 degrees on either side.
  for (std::size_t i = 0; i < plan->limits.lower.size(); ++i) {
    plan->limits.lower[i] += 0.035;
    plan->limits.upper[i] -= 0.035;
  }

  retarget::SolveControl control;
  control.keep_going = [](const retarget::Progress& progress) {
    std::fprintf(stderr, "\r%d of %d ", progress.done, progress.total);
    return true;  // false stops with ErrorKind::kInterrupted
  };
  const auto motion = retarget::solve(std::move(*plan), control);
  if (!motion) return fail(motion.error());
  const auto report = retarget::evaluate(*motion);
  if (!report) return fail(report.error());
  std::printf("\n%s", retarget::report_text({&*report, 1}).c_str());
  const auto saved = retarget::save(*motion, argv[3]);
  return saved ? 0 : fail(saved.error());
}
