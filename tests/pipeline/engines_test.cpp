// The fast engine against the reference engine on real robots and clips: each frame from the same
// pose, and whole clips; and other robots against the reference trajectories.

#include <gtest/gtest.h>

#include "retarget/bvh/read_bvh.h"
#include "retarget/io/robot_csv.h"
#include "retarget/pipeline/retarget.h"
#include "retarget/pipeline/targets.h"
#include "support/csv.h"
#include "support/shared_data.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

struct RobotCase {
  const char* robot;    // folder of reference trajectories
  const char* model;    // below reference/robots
  const char* mapping;  // below reference
};

void PrintTo(const RobotCase& robot_case, std::ostream* out) {
  *out << robot_case.robot;
}

class Engines : public ::testing::TestWithParam<RobotCase> {
 protected:
  void SetUp() override {
    const auto shared = shared_folder();
    if (!shared) GTEST_SKIP() << kNoSharedFolder;
    shared_ = *shared;
    const auto robot = load_robot((shared_ / "reference/robots" / GetParam().model).string());
    ASSERT_TRUE(robot) << describe(robot.error());
    robot_ = *robot;
    const auto tables = load_ik_tables((shared_ / "reference" / GetParam().mapping).string());
    ASSERT_TRUE(tables) << describe(tables.error());
    tables_ = *tables;
  }

  [[nodiscard]] HumanClip human(const std::string& clip, int frames) const {
    const auto file = load_bvh((shared_ / "data/lafan1" / (clip + ".bvh")).string()).value();
    return to_human(cut(file.clip, 0, std::min(frames, file.clip.frame_count())),
                    lafan1_mapping(file.clip.skeleton(), clip).value());
  }

  fs::path shared_;
  std::shared_ptr<const Robot> robot_;
  IkTables tables_;
};

TEST_P(Engines, AgreeInEveryFrameFromTheSamePose) {
  for (const char* clip : {"walk4_subject1", "dance1_subject2"}) {
    const HumanClip source = human(clip, 400);
    const TargetBuilder targets(tables_, source.height);
    const auto problem = make_problem(robot_, tables_, targets, robot_->model_limits());
    const auto reference = make_reference_solver(problem);
    const auto fast = make_fast_solver(problem);
    std::vector<Pose> world_from_target(targets.target_count());
    std::vector<double> pose = robot_->zero_configuration();
    int frames_with_other_steps = 0;
    for (int frame = 0; frame < source.frame_count; ++frame) {
      targets.build(source.frame(frame), world_from_target);
      std::vector<double> found = pose;
      int steps = 0, fast_steps = 0;
      for (std::size_t pass = 0; pass < problem->passes.size(); ++pass) {
        const int index = static_cast<int>(pass);
        steps += reference->solve_pass(index, world_from_target, pose).steps;
        fast_steps += fast->solve_pass(index, world_from_target, found).steps;
      }
      if (steps != fast_steps) {
        ++frames_with_other_steps;
        continue;
      }
      for (std::size_t i = 0; i < pose.size(); ++i) {
        ASSERT_NEAR(found[i], pose[i], 1e-9) << clip << ", frame " << frame << ", entry " << i;
      }
    }
    EXPECT_LE(frames_with_other_steps, 1) << clip;
  }
}

TEST_P(Engines, AgreeWithTheReferenceTrajectories) {
  int files = 0;
  for (const char* clip : {"walk4_subject1", "dance1_subject2"}) {
    const fs::path csv =
        shared_ / "reference/gmr_output" / GetParam().robot / (clip + std::string(".csv"));
    if (!fs::exists(csv)) continue;
    ++files;
    const auto expected = read_csv(csv);
    RobotCsvOptions csv_options;
    csv_options.precision = 17;
    for (const IkEngine engine : {IkEngine::kFast, IkEngine::kReference}) {
      RetargetOptions options;
      options.engine = engine;
      const auto result = retarget(human(clip, static_cast<int>(expected.size())), clip, robot_,
                                   tables_, robot_->model_limits(), options);
      ASSERT_TRUE(result) << describe(result.error());
      const auto difference =
          compare_tables(parse_csv(format_robot_csv(result->clip, csv_options)), expected, 1e-6);
      EXPECT_TRUE(difference.agree) << clip << ": " << difference.where;
    }
  }
  if (files == 0) GTEST_SKIP() << "no reference trajectories of this robot";
}

INSTANTIATE_TEST_SUITE_P(
    Robots, Engines,
    ::testing::Values(
        RobotCase{"unitree_g1", "unitree_g1/g1_mocap_29dof.xml", "ik_configs/bvh_to_g1.json"},
        RobotCase{"booster_t1", "booster_t1/t1_mocap.xml", "ik_configs/bvh_to_t1.json"},
        RobotCase{"booster_t1_29dof", "booster_t1_29dof/t1_mocap.xml",
                  "ik_configs_2026/bvh_lafan1_to_t1_29dof.json"},
        RobotCase{"fourier_n1", "fourier_n1/n1_mocap.xml", "ik_configs/bvh_to_n1.json"},
        RobotCase{"stanford_toddy", "stanford_toddy/toddy_mocap.xml",
                  "ik_configs/bvh_to_toddy.json"},
        RobotCase{"engineai_pm01", "engineai_pm01/pm_v2.xml", "ik_configs/bvh_to_pm01.json"},
        RobotCase{"pal_talos", "pal_talos/talos.xml", "ik_configs_2026/bvh_to_talos.json"}),
    [](const auto& robot_case) { return std::string(robot_case.param.robot); });

}  // namespace
}  // namespace retarget
