// The exact method against independent results: frame by frame, stage by stage.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "formats/bvh/read_bvh.h"
#include "retarget/motion_io.h"
#include "retarget/so3.h"
#include "solve/ik/box_qp.h"
#include "solve/targets/solve_frames.h"
#include "solve/targets/targets.h"
#include "support/box_qp_residual.h"
#include "support/csv.h"
#include "support/lafan1_map.h"
#include "support/shared_data.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path kSource = RETARGET_SOURCE_DIR;
constexpr double kTolerance = 1e-6;  // rad and m

ResolvedConfig g1_tables(const Robot& robot) {
  return value_of(load_config((kSource / "configs" / "lafan1_to_unitree_g1.json").string(), robot));
}

LimitSet gmr_limits(const Robot& robot) {
  return value_of(load_limits(robot, "gmr"));
}

// The first frames of a clip, without resampling.
HumanClip load_human(const fs::path& bvh, int frames) {
  const auto file = value_of(load_bvh(bvh.string()));
  const Clip& clip = file.clip;
  return to_human(cut(clip, 0, std::min(frames, clip.frame_count())),
                  lafan1_calibration(clip.skeleton()));
}

std::vector<std::vector<double>> retarget_rows(const fs::path& bvh, int frames, IkEngine engine) {
  const auto robot = load_g1();
  SolveFramesOptions retarget_options;
  retarget_options.engine = engine;
  const auto result = value_of(solve_frames(load_human(bvh, frames), robot, g1_tables(*robot),
                                            gmr_limits(*robot), retarget_options));
  RobotCsvOptions options;
  options.precision = 17;
  return parse_csv(format_robot_csv(result.clip, options));
}

class Samples : public ::testing::TestWithParam<const char*> {};

// Values of an independent implementation (Python, another QP solver) on the same clips.
TEST_P(Samples, MatchTheOracleInEveryFrame) {
  const auto expected =
      read_csv(kSource / "tests" / "golden" / "oracle" / (std::string(GetParam()) + ".csv"));
  for (const IkEngine engine : {IkEngine::kFast, IkEngine::kReference}) {
    const auto found =
        retarget_rows(kSource / "data" / (std::string(GetParam()) + ".bvh"), 100000, engine);
    EXPECT_EQ(found.size(), expected.size());
    const TableDifference difference = compare_tables(found, expected, kTolerance);
    EXPECT_TRUE(difference.agree) << difference.where;
  }
}

TEST_P(Samples, SolveEveryQp) {
  const auto robot = load_g1();
  const HumanClip human = load_human(kSource / "data" / (std::string(GetParam()) + ".bvh"), 100000);
  const ResolvedConfig config = g1_tables(*robot);
  const TargetBuilder targets(config, human.height);
  const auto problem = make_problem(robot, config, targets, gmr_limits(*robot));
  long count = 0, bounded = 0;
  double worst = 0.0;
  const auto solver = make_reference_solver(problem, {}, [&](const QpRecord& qp) {
    ++count;
    worst = std::max(worst, box_qp_residual(qp.H, qp.g, qp.lower, qp.upper, qp.x));
    const bool at_bound =
        ((qp.x - qp.lower).array() <= 0.0).any() || ((qp.upper - qp.x).array() <= 0.0).any();
    bounded += at_bound ? 1 : 0;
  });
  std::vector<double> qpos = robot->zero_configuration();
  std::vector<Pose> world_from_target(targets.target_count());
  for (int frame = 0; frame < human.frame_count; ++frame) {
    targets.build(human.frame(frame), world_from_target);
    for (int pass = 0; pass < 2; ++pass) solver->solve_pass(pass, world_from_target, qpos);
  }
  EXPECT_LT(worst, 1e-9) << count << " QPs, " << bounded << " with an active bound";
  EXPECT_GT(count, 2 * human.frame_count);
}

INSTANTIATE_TEST_SUITE_P(All, Samples,
                         ::testing::Values("walk", "turn_in_place", "squat", "wave", "get_up"),
                         [](const auto& sample) { return std::string(sample.param); });

TEST(Reference, TwelveClipsMatchInEveryFrame) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  int clips = 0;
  for (const char* folder : {"lafan1", "lafan1_cuts"}) {
    for (const auto& entry : fs::directory_iterator(*shared / "data" / folder)) {
      const fs::path bvh = entry.path();
      const fs::path csv = *shared / "reference" / "gmr_output" / "unitree_g1" /
                           bvh.filename().replace_extension(".csv");
      if (bvh.extension() != ".bvh" || !fs::exists(csv)) continue;
      const auto expected = read_csv(csv);
      for (const IkEngine engine : {IkEngine::kFast, IkEngine::kReference}) {
        const auto found = retarget_rows(bvh, static_cast<int>(expected.size()), engine);
        const TableDifference difference = compare_tables(found, expected, kTolerance);
        EXPECT_TRUE(difference.agree) << bvh.filename() << ": " << difference.where;
      }
      ++clips;
    }
  }
  EXPECT_EQ(clips, 12);
}

Eigen::Vector3d vector_of(const Json& json) {
  const auto v = json.get<std::vector<double>>();
  return Eigen::Vector3d(v[0], v[1], v[2]);
}

// Angle between two rotations, radians.
double angle_between(const Eigen::Quaterniond& a, const Json& json) {
  const auto wxyz = json.get<std::vector<double>>();
  const Eigen::Quaterniond b(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  return log_so3(a.conjugate() * b).norm();
}

TEST(Reference, EveryStageMatches) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  std::ifstream file(*shared / "reference/gmr_output/unitree_g1/walk4_subject1_stages.json");
  const Json stages = Json::parse(file);
  const auto robot = load_g1();
  const ResolvedConfig config = g1_tables(*robot);
  const HumanClip human = load_human(*shared / "data/lafan1/walk4_subject1.bvh",
                                     static_cast<int>(stages["frames"].size()));
  const TargetBuilder targets(config, human.height);
  const auto problem = make_problem(robot, config, targets, gmr_limits(*robot));
  const auto solver = make_reference_solver(problem);
  std::vector<double> qpos = robot->zero_configuration();
  std::vector<Pose> world_from_target(targets.target_count());
  for (int frame = 0; frame < human.frame_count; ++frame) {
    SCOPED_TRACE("frame " + std::to_string(frame));
    const Json& stage = stages["frames"][frame];
    ASSERT_EQ(stage["bones"].size(), kBoneCount);
    for (const auto& [name, pose] : stage["bones"].items()) {
      const Pose& bone = human.frame(frame)[bone_from_name(name).value()];
      EXPECT_LT((bone.translation - vector_of(pose["pos"])).norm(), 1e-12) << name;
      EXPECT_LT(angle_between(bone.rotation, pose["quat"]), 1e-12) << name;
    }
    targets.build(human.frame(frame), world_from_target);
    ASSERT_EQ(stage["targets"].size(), world_from_target.size());
    for (const auto& [name, pose] : stage["targets"].items()) {
      const Pose& target = world_from_target[targets.target_of(bone_from_name(name).value())];
      EXPECT_LT((target.translation - vector_of(pose["pos"])).norm(), 1e-12) << name;
      EXPECT_LT(angle_between(target.rotation, pose["quat"]), 1e-12) << name;
    }
    for (int pass = 0; pass < 2; ++pass) {
      SCOPED_TRACE("pass " + std::to_string(pass + 1));
      const Json& expected = stage["passes"][pass];
      const PassResult result = solver->solve_pass(pass, world_from_target, qpos);
      ASSERT_EQ(result.steps + 1, static_cast<int>(expected["errors"].size()));
      for (int k = 0; k <= result.steps; ++k) {
        EXPECT_NEAR(result.errors[k], expected["errors"][k].get<double>(), 1e-8) << "step " << k;
      }
      for (std::size_t i = 0; i < qpos.size(); ++i) {
        EXPECT_NEAR(qpos[i], expected["qpos"][i].get<double>(), 1e-8) << "entry " << i;
      }
    }
  }
}

}  // namespace
}  // namespace retarget
