// Retargets a motion file to a robot with the defaults of the command line:
//     01_bvh_to_csv walk.bvh unitree_g1 walk.csv

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
  auto plan = retarget::make_plan(std::move(*clip), *robot);
  if (!plan) return fail(plan.error());
  std::printf("%s", plan->summary().c_str());
  const auto motion = retarget::solve(std::move(*plan));
  if (!motion) return fail(motion.error());
  const auto saved = retarget::save(*motion, argv[3]);
  return saved ? 0 : fail(saved.error());
}
