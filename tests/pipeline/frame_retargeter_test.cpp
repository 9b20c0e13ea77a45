// The published method frame by frame: the bytes of a clip, state, errors, no allocations.

#include "retarget/frame_retargeter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "solve/targets/solve_frames.h"
#include "support/counted_allocations.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

constexpr const char* kConfigFile = RETARGET_SOURCE_DIR "/configs/lafan1_to_unitree_g1.json";

RetargetingConfig published_tables() {
  return load_retargeting_config(kConfigFile).value();
}

HumanClip sample(const char* name, int frames) {
  const Clip clip = recorded_clip(name);
  return to_human(cut(clip, 0, std::min(frames, clip.frame_count())),
                  lafan1_calibration(clip.skeleton()));
}

// A frame of the human in the order of the retargeter's bodies.
std::vector<Pose> poses_by_name(const FrameRetargeter& retargeter, const HumanPose& human) {
  std::vector<Pose> poses;
  for (const std::string& name : retargeter.human_bodies()) {
    poses.push_back(human[bone_from_name(name).value()]);
  }
  return poses;
}

FrameRetargeter make_g1(const FrameRetargeterOptions& options = {1.75},
                        const RetargetingConfig& tables = published_tables()) {
  const auto robot = load_g1();
  auto config = value_of(resolve_human_config(tables, *robot));
  return value_of(
      FrameRetargeter::make(robot, config, load_limits(*robot, "gmr").value(), options));
}

// The same tables for a human with other body names.
RetargetingConfig with_other_names(RetargetingConfig config) {
  const auto renamed = [](const std::string& name) { return name + "_of_mine"; };
  config.human_root = renamed(config.human_root);
  for (auto& [name, scale] : config.scales) name = renamed(name);
  for (IkMatchTable& table : config.match_tables) {
    for (IkMatch& row : table.rows) row.bone = renamed(row.bone);
  }
  return config;
}

TEST(FrameRetargeter, MatchesTheBytesOfAClip) {
  const HumanClip human = sample("walk", 120);
  for (const IkEngine engine : {IkEngine::kFast, IkEngine::kReference}) {
    FrameRetargeter retargeter = make_g1({1.75, 0.5, 10, engine});
    SolveFramesOptions options;
    options.engine = engine;
    const auto robot = load_g1();
    const auto clip = solve_frames(human, robot, published_config(*robot),
                                   load_limits(*robot, "gmr").value(), options);
    for (int frame = 0; frame < human.frame_count; ++frame) {
      ASSERT_TRUE(retargeter.update_targets(poses_by_name(retargeter, human.frame(frame))));
      ASSERT_TRUE(retargeter.solve());
      const auto expected = clip->clip.qpos(frame);
      const auto found = retargeter.qpos();
      // Quaternions of a clip keep their sign over time; those of a single frame need not.
      const double sign = found[3] * expected[3] < 0.0 ? -1.0 : 1.0;
      for (std::size_t i = 0; i < found.size(); ++i) {
        ASSERT_EQ(i >= 3 && i < 7 ? sign * found[i] : found[i], expected[i])
            << "frame " << frame << ", value " << i;
      }
    }
  }
}

TEST(FrameRetargeter, AcceptsAnyBodyNames) {
  FrameRetargeter known = make_g1();
  FrameRetargeter other = make_g1({1.75}, with_other_names(published_tables()));
  ASSERT_EQ(other.human_bodies().front(), "Hips_of_mine");
  const HumanClip human = sample("wave", 20);
  for (int frame = 0; frame < human.frame_count; ++frame) {
    const auto poses = poses_by_name(known, human.frame(frame));
    ASSERT_TRUE(known.update_targets(poses) && known.solve());
    ASSERT_TRUE(other.update_targets(poses) && other.solve());
    ASSERT_TRUE(std::ranges::equal(known.qpos(), other.qpos())) << frame;
  }
}

TEST(FrameRetargeter, KeepsItsStateAndAcceptsAnother) {
  const HumanClip human = sample("squat", 30);
  FrameRetargeter whole = make_g1();
  std::vector<double> half;
  for (int frame = 0; frame < 30; ++frame) {
    if (frame == 15) half.assign(whole.qpos().begin(), whole.qpos().end());
    ASSERT_TRUE(whole.update_targets(poses_by_name(whole, human.frame(frame))) && whole.solve());
  }
  FrameRetargeter second = make_g1();
  ASSERT_TRUE(second.set_qpos(half));
  for (int frame = 15; frame < 30; ++frame) {
    ASSERT_TRUE(second.update_targets(poses_by_name(second, human.frame(frame))) && second.solve());
  }
  EXPECT_TRUE(std::ranges::equal(whole.qpos(), second.qpos()));

  half[3] *= 2.0;
  half[4] *= 2.0;
  half[5] *= 2.0;
  half[6] *= 2.0;
  ASSERT_TRUE(second.set_qpos(half));
  EXPECT_NEAR(std::hypot(std::hypot(second.qpos()[3], second.qpos()[4]),
                         std::hypot(second.qpos()[5], second.qpos()[6])),
              1.0, 1e-15);
}

TEST(FrameRetargeter, ErrorsEqualThoseOfThePasses) {
  const HumanClip human = sample("walk", 1);
  FrameRetargeter retargeter = make_g1();
  EXPECT_EQ(retargeter.error(1).error().kind, ErrorKind::kUsage);
  EXPECT_EQ(retargeter.solve().error().kind, ErrorKind::kUsage);
  EXPECT_TRUE(retargeter.world_from_target().empty());
  ASSERT_TRUE(retargeter.update_targets(poses_by_name(retargeter, human.frame(0))));

  // The reference: the engine's own errors, before the first step and after the last.
  const auto robot = load_g1();
  const ResolvedConfig config = published_config(*robot);
  const TargetBuilder targets(config, 1.75);
  std::vector<Pose> world_from_target(targets.target_count());
  targets.build(human.frame(0), world_from_target);
  const auto solver = make_reference_solver(
      make_problem(robot, config, targets, load_limits(*robot, "gmr").value()));
  std::vector<double> qpos = robot->zero_configuration();
  const PassResult first = solver->solve_pass(0, world_from_target, qpos);
  EXPECT_NEAR(retargeter.error(1).value(), first.errors[0], 1e-12);
  const PassResult second = solver->solve_pass(1, world_from_target, qpos);
  ASSERT_TRUE(retargeter.solve());
  EXPECT_NEAR(retargeter.error(2).value(), second.errors[second.steps], 1e-9);
  EXPECT_EQ(retargeter.error(1).value(), retargeter.error(2).value());  // the same rows, no weights
  EXPECT_EQ(retargeter.error(3).error().kind, ErrorKind::kUsage);

  RetargetingConfig fewer_rows = published_tables();
  fewer_rows.match_tables[1].rows.pop_back();
  FrameRetargeter fewer = make_g1({1.75}, fewer_rows);
  ASSERT_TRUE(fewer.update_targets(poses_by_name(fewer, human.frame(0))));
  EXPECT_GT(fewer.error(1).value(), fewer.error(2).value());

  RetargetingConfig one_table = published_tables();
  one_table.match_tables[0].used = false;
  FrameRetargeter last = make_g1({1.75}, one_table);
  ASSERT_TRUE(last.update_targets(poses_by_name(last, human.frame(0))) && last.solve());
  EXPECT_FALSE(last.error(1));
  EXPECT_GT(last.error(2).value(), 0.0);
}

TEST(FrameRetargeter, MovesTargetsDownAndToTheGround) {
  const HumanClip human = sample("walk", 1);
  FrameRetargeter retargeter = make_g1();
  const auto poses = poses_by_name(retargeter, human.frame(0));
  ASSERT_TRUE(retargeter.update_targets(poses));
  const std::vector<Pose> plain(retargeter.world_from_target().begin(),
                                retargeter.world_from_target().end());
  ASSERT_TRUE(retargeter.update_targets(poses, {0.25, false}));
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_EQ(retargeter.world_from_target()[i].translation.z(), plain[i].translation.z() - 0.25);
  }
  for (const double down : {0.0, 3.0}) {
    ASSERT_TRUE(retargeter.update_targets(poses, {down, true}));
    double lowest = 10.0;
    for (std::size_t i = 0; i < plain.size(); ++i) {
      const std::string& body = retargeter.human_bodies()[retargeter.target_bodies()[i]];
      const Eigen::Vector3d& there = retargeter.world_from_target()[i].translation;
      if (body.find("Foot") != std::string::npos) lowest = std::min(lowest, there.z());
      EXPECT_EQ(there.x(), plain[i].translation.x());
    }
    EXPECT_NEAR(lowest, 0.1, 1e-15);
  }
  RetargetingConfig no_feet = published_tables();
  for (IkMatchTable& table : no_feet.match_tables) {
    std::erase_if(table.rows, [](const IkMatch& row) { return row.bone.ends_with("FootMod"); });
  }
  FrameRetargeter footless = make_g1({1.75}, no_feet);
  const auto to_ground =
      footless.update_targets(poses_by_name(footless, human.frame(0)), {0.0, true});
  ASSERT_FALSE(to_ground);
  EXPECT_NE(to_ground.error().message.find("foot"), std::string::npos);
}

TEST(FrameRetargeter, InvalidFramesAreErrorsAndDoNotChangeTheState) {
  const HumanClip human = sample("walk", 2);
  FrameRetargeter retargeter = make_g1();
  const auto good = poses_by_name(retargeter, human.frame(0));
  ASSERT_TRUE(retargeter.update_targets(good) && retargeter.solve());
  const std::vector<double> before(retargeter.qpos().begin(), retargeter.qpos().end());
  const double error = retargeter.error(2).value();

  auto bad = good;
  bad[3].translation.x() = std::nan("");
  const auto not_finite = retargeter.update_targets(bad);
  ASSERT_FALSE(not_finite);
  EXPECT_EQ(not_finite.error().message,
            "the position of \"" + retargeter.human_bodies()[3] + "\" is not finite");
  bad = good;
  bad[0].rotation.coeffs().setZero();
  EXPECT_FALSE(retargeter.update_targets(bad));
  bad[0].rotation.coeffs().setConstant(std::numeric_limits<double>::infinity());
  EXPECT_FALSE(retargeter.update_targets(bad));
  EXPECT_FALSE(retargeter.update_targets(std::span(good).first(3)));
  EXPECT_EQ(retargeter.error(2).value(), error);  // the targets are still the ones before

  bad = good;
  for (Pose& pose : bad) pose.translation.setConstant(1e200);
  ASSERT_TRUE(retargeter.update_targets(bad));
  EXPECT_EQ(retargeter.solve().error().kind, ErrorKind::kInput);
  for (Pose& pose : bad) pose.translation.setConstant(1e90);
  ASSERT_TRUE(retargeter.update_targets(bad));
  (void)retargeter.solve();  // The solve may fail; the results must be finite.
  EXPECT_TRUE(std::ranges::all_of(retargeter.qpos(), [](double v) { return std::isfinite(v); }));

  EXPECT_FALSE(retargeter.set_qpos(std::span(before).first(7)));
  std::vector<double> unset = before;
  unset[9] = std::nan("");
  EXPECT_FALSE(retargeter.set_qpos(unset));
  unset = before;
  std::fill_n(unset.begin() + 3, 4, 0.0);
  EXPECT_FALSE(retargeter.set_qpos(unset));
}

TEST(FrameRetargeter, OptionsOutOfRangeAreErrors) {
  const auto robot = load_g1();
  const HumanConfig config = resolve_human_config(published_tables(), *robot).value();
  const auto fails = [&](const FrameRetargeterOptions& options) {
    const auto made = FrameRetargeter::make(robot, config, robot->model_limits(), options);
    return !made && made.error().kind == ErrorKind::kUsage;
  };
  EXPECT_TRUE(fails({0.0}));
  EXPECT_TRUE(fails({std::nan("")}));
  EXPECT_TRUE(fails({1.75, 0.0}));
  EXPECT_TRUE(fails({1.75, 0.5, -1}));
  EXPECT_TRUE(fails({1.75, 0.5, 31}));
  HumanConfig nameless = config;
  nameless.bodies.resize(2);
  EXPECT_FALSE(FrameRetargeter::make(robot, nameless, robot->model_limits()));
}

TEST(FrameRetargeter, AllocatesNothingPerFrame) {
  const HumanClip human = sample("walk", 20);
  FrameRetargeter retargeter = make_g1();
  std::vector<std::vector<Pose>> frames;
  for (const HumanPose& frame : human.world_from_bone) {
    frames.push_back(poses_by_name(retargeter, frame));
  }
  const long before = allocations;
  for (const auto& frame : frames) {
    ASSERT_TRUE(retargeter.update_targets(frame, {0.0, true}));
    ASSERT_TRUE(retargeter.solve());
    ASSERT_TRUE(retargeter.error(1));
  }
  EXPECT_EQ(allocations, before);
}

TEST(HumanConfig, ReportsUnknownNamesAndTooManyRows) {
  const auto robot = load_g1();
  RetargetingConfig tables = published_tables();
  tables.match_tables[0].rows[1].body = "left_hip_yaw_lnk";
  tables.match_tables[1].rows[1].bone = "left_hip";  // no scale
  const auto unknown = resolve_human_config(tables, *robot);
  ASSERT_FALSE(unknown);
  EXPECT_NE(full_message(unknown.error()).find("left_hip_yaw_link"), std::string::npos);
  EXPECT_NE(full_message(unknown.error()).find("\"left_hip\" has no entry"), std::string::npos);

  tables = published_tables();
  for (int i = 0; i < 20; ++i) {
    IkMatch row = tables.match_tables[0].rows[1];
    row.bone = "part" + std::to_string(i);
    tables.match_tables[0].rows.push_back(row);
  }
  EXPECT_FALSE(resolve_human_config(tables, *robot));
}

}  // namespace
}  // namespace retarget
