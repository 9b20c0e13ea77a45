// The fast engine against the reference engine on real robots and clips: each frame from the same
// pose, and whole clips; and every robot with a published configuration against the reference
// trajectories.

#include <gtest/gtest.h>

#include "formats/bvh/read_bvh.h"
#include "retarget/motion_io.h"
#include "retarget/robots.h"
#include "solve/targets/solve_frames.h"
#include "solve/targets/targets.h"
#include "support/csv.h"
#include "support/lafan1_map.h"
#include "support/shared_data.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

struct RobotCase {
  const char* robot;      // Robot of the repository, and its folder of reference trajectories.
  const char* published;  // Its configuration, below the folder `reference`.
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
    const fs::path source = RETARGET_SOURCE_DIR;
    const auto files = find_robot(GetParam().robot, {source / "robots"}).value();
    robot_ = value_of(load_robot_files(files.model.string(), files.profile.string()));
    const std::string file = "lafan1_to_" + std::string(GetParam().robot) + ".json";
    const auto config = value_of(load_retargeting_config((source / "configs" / file).string()));
    read_ = config;
    config_ = value_of(resolve_config(config, *robot_));
    limits_ = value_of(load_limits(*robot_, robot_->limits_for("gmr")));
  }

  [[nodiscard]] HumanClip human(const std::string& clip, int frames) const {
    const auto file = load_bvh((shared_ / "data/lafan1" / (clip + ".bvh")).string()).value();
    return to_human(cut(file.clip, 0, std::min(frames, file.clip.frame_count())),
                    lafan1_calibration(file.clip.skeleton()));
  }

  fs::path shared_;
  std::shared_ptr<const Robot> robot_;
  RetargetingConfig read_;  // Source of config_.
  ResolvedConfig config_;
  LimitSet limits_;  // Limits of the published method.
};

TEST_P(Engines, UseThePublishedMapping) {
  const auto published =
      value_of(load_retargeting_config((shared_ / "reference" / GetParam().published).string()));
  EXPECT_EQ(read_.robot_root, published.robot_root);
  EXPECT_EQ(read_.human_root, published.human_root);
  EXPECT_EQ(read_.ground_height, published.ground_height);
  EXPECT_EQ(read_.human_height_assumption, published.human_height_assumption);
  EXPECT_EQ(read_.scales, published.scales);
  for (int number = 0; number < 2; ++number) {
    const IkMatchTable& ours = read_.match_tables[number];
    const IkMatchTable& theirs = published.match_tables[number];
    EXPECT_EQ(ours.used, theirs.used);
    ASSERT_EQ(ours.rows.size(), theirs.rows.size());
    for (std::size_t i = 0; i < ours.rows.size(); ++i) {
      const IkMatch &row = ours.rows[i], &expected = theirs.rows[i];
      EXPECT_EQ(row.body, expected.body);
      EXPECT_EQ(row.bone, expected.bone);
      EXPECT_EQ(row.position_weight, expected.position_weight);
      EXPECT_EQ(row.rotation_weight, expected.rotation_weight);
      EXPECT_EQ(row.position_offset, expected.position_offset);
      EXPECT_EQ(row.rotation_offset.coeffs(), expected.rotation_offset.coeffs());
    }
  }
}

TEST_P(Engines, AgreeInEveryFrameFromTheSameStart) {
  for (const char* clip : {"walk4_subject1", "dance1_subject2"}) {
    const HumanClip source = human(clip, 400);
    const TargetBuilder targets(config_, source.height);
    const auto problem = make_problem(robot_, config_, targets, limits_);
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

TEST_P(Engines, MatchReferenceTrajectories) {
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
      SolveFramesOptions options;
      options.engine = engine;
      const auto result = value_of(solve_frames(human(clip, static_cast<int>(expected.size())),
                                                robot_, config_, limits_, options));
      const auto difference =
          compare_tables(parse_csv(format_robot_csv(result.clip, csv_options)), expected, 1e-6);
      EXPECT_TRUE(difference.agree) << clip << ": " << difference.where;
    }
  }
  if (files == 0) GTEST_SKIP() << "no reference trajectories of this robot";
}

INSTANTIATE_TEST_SUITE_P(
    Robots, Engines,
    ::testing::Values(RobotCase{"unitree_g1", "ik_configs/bvh_to_g1.json"},
                      RobotCase{"booster_t1", "ik_configs/bvh_to_t1.json"},
                      RobotCase{"booster_t1_29dof", "ik_configs_2026/bvh_lafan1_to_t1_29dof.json"},
                      RobotCase{"fourier_n1", "ik_configs/bvh_to_n1.json"},
                      RobotCase{"stanford_toddy", "ik_configs/bvh_to_toddy.json"},
                      RobotCase{"engineai_pm01", "ik_configs/bvh_to_pm01.json"},
                      RobotCase{"pal_talos", "ik_configs_2026/bvh_to_talos.json"}),
    [](const auto& robot_case) { return std::string(robot_case.param.robot); });

}  // namespace
}  // namespace retarget
