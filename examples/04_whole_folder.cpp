// Retargets every BVH below a folder to one robot, loaded once. A bad file does not stop the run:
//     04_whole_folder clips unitree_g1 out

#include <retarget/retarget.h>

#include <cstdio>
#include <filesystem>

namespace fs = std::filesystem;

namespace {

retarget::Result<void> convert(const std::string& file, const retarget::RobotSetup& robot,
                               const retarget::Options& options, const std::string& output) {
  auto clip = retarget::load_clip(file);
  if (!clip) return retarget::failure(clip.error());
  auto plan = retarget::make_plan(std::move(*clip), robot, options);
  if (!plan) return retarget::failure(plan.error());
  const auto motion = retarget::solve(std::move(*plan));
  if (!motion) return retarget::failure(motion.error());
  return retarget::save(*motion, output);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: %s FOLDER ROBOT OUTPUT\n", argv[0]);
    return 2;
  }
  const retarget::Options options;
  auto loaded = retarget::load_robot(argv[2]);
  if (!loaded) {
    std::fprintf(stderr, "%s\n", retarget::describe(loaded.error()).c_str());
    return 1;
  }
  const auto robot = retarget::set_up_robot(std::move(*loaded), options);
  if (!robot) {
    std::fprintf(stderr, "%s\n", retarget::describe(robot.error()).c_str());
    return 1;
  }
  int failed = 0;
  for (const auto& entry : fs::recursive_directory_iterator(argv[1])) {
    if (entry.path().extension() != ".bvh") continue;
    fs::path output = argv[3] / entry.path().lexically_relative(argv[1]);
    fs::create_directories(output.parent_path());
    output.replace_extension(".csv");
    if (const auto done = convert(entry.path().string(), *robot, options, output.string()); !done) {
      std::fprintf(stderr, "%s\n", retarget::describe(done.error()).c_str());
      ++failed;
    }
  }
  return failed == 0 ? 0 : 1;
}
