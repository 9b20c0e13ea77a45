// Sets up your own robot from its MJCF or URDF, without meshes, and retargets a motion to it:
//     02_own_robot my_robot.xml walk.bvh walk.csv
// Writes the folder my_robot here; check decisions.md in it before using it.

#include <retarget/retarget.h>
#include <retarget/rig.h>

#include <cstdio>
#include <filesystem>

namespace {

int fail(const retarget::Error& error) {
  std::fprintf(stderr, "%s\n", retarget::describe(error).c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: %s MODEL MOTION OUTPUT\n", argv[0]);
    return 2;
  }
  const std::string name = std::filesystem::path(argv[1]).stem().string();
  const auto made = retarget::make_robot(argv[1], name);
  if (!made) return fail(made.error());
  for (const std::string& line : made->summary) std::printf("%s\n", line.c_str());
  for (const std::string& note : made->notes) std::printf("look at: %s\n", note.c_str());
  const auto folder = retarget::save_robot(*made, ".", true);
  if (!folder) return fail(folder.error());

  const auto robot = retarget::load_robot(folder->string());
  if (!robot) return fail(robot.error());
  auto clip = retarget::load_clip(argv[2]);
  if (!clip) return fail(clip.error());
  auto plan = retarget::make_plan(std::move(*clip), *robot);
  if (!plan) return fail(plan.error());
  const auto motion = retarget::solve(std::move(*plan));
  if (!motion) return fail(motion.error());
  const auto saved = retarget::save(*motion, argv[3]);
  return saved ? 0 : fail(saved.error());
}
