// The main interface: a clip, a robot, a plan, a motion.

#include "retarget/retarget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "retarget/so3.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kSource = RETARGET_SOURCE_DIR;

std::string sample(const std::string& name) {
  return kSource + "/data/" + name + ".bvh";
}

RobotChoice named(const std::string& name) {
  RobotChoice choice;
  choice.name = name;
  return choice;
}

Result<LoadedRobot> g1() {
  return load_robot(named("g1"), {kSource});
}

// One second of a sample.
Options short_options(Method method = Method::kFit) {
  Options options;
  options.part.frames = "0:30";
  options.solve.method = method;
  return options;
}

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(FrontDoor, FindsProfilesWithoutADataFolder) {
  auto clip = value_of(load_clip(sample("walk")));
  const auto human = find_human(clip, {}, "");
  ASSERT_TRUE(human) << describe(human.error());
}

TEST(FrontDoor, RetargetsAClipToAFile) {
  const TemporaryFolder folder;
  const auto robot = value_of(g1());
  const auto clip = value_of(load_clip(sample("walk")));
  const auto plan = value_of(make_plan(clip, robot, short_options()));
  EXPECT_THAT(plan.summary(), HasSubstr("taken as"));
  EXPECT_THAT(plan.summary(), HasSubstr("unitree_g1, 29 joints"));
  EXPECT_EQ(plan.frame_count(), 30);
  const auto motion = value_of(solve(plan));
  EXPECT_EQ(motion.clip.frame_count(), 30);
  ASSERT_TRUE(motion.fit);
  ASSERT_TRUE(save(motion, (folder.path() / "walk.csv").string()));
  const std::string text = content(folder.path() / "walk.csv");
  EXPECT_EQ(std::ranges::count(text, '\n'), 30);
  EXPECT_EQ(text, format_robot_csv(motion.clip));
  const auto report = value_of(evaluate(motion));
  EXPECT_NE(report.find("limb_angle_deg"), nullptr);
}

TEST(FrontDoor, ReproducesTheGoldenFile) {
  const auto robot = value_of(g1());
  Options options;
  options.solve.method = Method::kGmr;
  const auto plan = value_of(make_plan(load_clip(sample("walk")).value(), robot, options));
  const auto motion = value_of(solve(plan));
  const auto golden = value_of(load_robot_motion(kSource + "/tests/golden/walk.csv", robot.robot));
  ASSERT_EQ(motion.clip.frame_count(), golden.clip.frame_count());
  for (int frame = 0; frame < motion.clip.frame_count(); ++frame) {
    const auto found = std::as_const(motion.clip).qpos(frame);
    const auto expected = std::as_const(golden.clip).qpos(frame);
    for (std::size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], expected[i], 1e-6);
  }
}

TEST(FrontDoor, DecisionsCanBeReplaced) {
  const auto robot = value_of(g1());
  auto clip = value_of(load_clip(sample("walk")));
  auto plan = value_of(make_plan(std::move(clip), robot, short_options(Method::kGmr)));
  plan.part = {10, 20};
  plan.scale = ScaleRule::kHeight;
  const auto motion = value_of(solve(plan));
  EXPECT_EQ(motion.clip.frame_count(), 10);
  auto limbs = plan;
  limbs.scale = ScaleRule::kLimbs;
  const auto other = solve(std::move(limbs));
  ASSERT_TRUE(other);
  EXPECT_NE(format_robot_csv(motion.clip), format_robot_csv(other->clip));
}

TEST(FrontDoor, SolvingReportsProgressAndCanBeStopped) {
  const auto robot = value_of(g1());
  auto clip = value_of(load_clip(sample("walk")));
  const auto plan = value_of(make_plan(std::move(clip), robot, short_options()));
  int told = 0;
  SolveControl control;
  control.frame_solved = [&](int frame, std::span<const double>) { EXPECT_EQ(frame, told++); };
  ASSERT_TRUE(solve(plan, control));
  EXPECT_EQ(told, 30);
  control.keep_going = [](const Progress&) { return false; };
  const auto stopped = solve(plan, control);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kInterrupted);
}

// A clip of 12,000 frames, as a program makes it from arrays.
Clip long_clip(FrameRate rate) {
  const auto walk = value_of(load_clip(sample("walk")));
  Clip clip(walk.shared_skeleton(), rate, 12000);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const int step = frame % (2 * walk.frame_count() - 2);
    copy_frame(walk, std::min(step, 2 * walk.frame_count() - 2 - step), clip, frame);
  }
  return clip;
}

TEST(FrontDoor, AClipWithoutAFileNeedsMemoryInProportionToItself) {
  const auto robot = value_of(g1());
  Options options;
  options.save.formats = {MotionFormat::kNpzMjlab};
  Clip clip = long_clip({30, 1});
  ASSERT_TRUE(make_plan(clip, robot, options));

  options.source.memory_gb = 0.1;
  const auto limited = make_plan(clip, robot, options);
  ASSERT_FALSE(limited);
  EXPECT_THAT(limited.error().hint, HasSubstr("memory"));

  options.source.memory_gb = 0.0;
  ClipOrigin origin;
  origin.bytes = 1000;
  clip.set_origin(origin);
  EXPECT_FALSE(make_plan(clip, robot, options));
}

TEST(FrontDoor, ALowRateOfAClipWithoutAFileIsDoubted) {
  const auto robot = value_of(g1());
  Options options;
  options.source.memory_gb = 1000.0;
  Clip clip = value_of(load_clip(sample("walk")));
  clip.set_origin({});
  clip.set_rate({1, 100});
  const auto plan = make_plan(clip, robot, options);
  ASSERT_FALSE(plan);
  EXPECT_THAT(plan.error().message, HasSubstr("for a source of this size"));
}

TEST(FrontDoor, ErrorsNameOptionFields) {
  const auto robot = load_robot(named("unitree_g2"), {kSource});
  ASSERT_FALSE(robot);
  EXPECT_EQ(robot.error().kind, ErrorKind::kConfig);
  EXPECT_EQ(load_clip("nowhere.bvh").error().location.file, "nowhere.bvh");
  auto options = short_options(Method::kGmr);
  options.solve.without = {"floor"};
  const auto known = value_of(g1());
  const auto plan = make_plan(load_clip(sample("walk")).value(), known, options);
  ASSERT_FALSE(plan);
  EXPECT_THAT(describe(plan.error()),
              HasSubstr("fit_config, with, without and window require method"));
  EXPECT_THAT(describe(plan.error(), option_as_flag), HasSubstr("--without"));
}

// If the solver meets non-finite numbers, the motion is written, and its verdict is a miss.
TEST(FrontDoor, AFailedSolverMissesTheVerdict) {
  Options options = short_options();
  options.part.frames = "60:90";  // Standing frames need no forces that the contacts lack.
  auto plan = value_of(make_plan(*load_clip(sample("walk")), *g1(), options));
  const auto sound = value_of(solve(plan));
  EXPECT_TRUE(sound.solver_failures.empty());
  EXPECT_EQ(evaluate(sound)->find("solver_failures")->value, 0.0);

  plan.fit.com_weight = 1e200;
  const auto failed = value_of(solve(std::move(plan)));
  ASSERT_EQ(failed.solver_failures.size(), 1U);
  QualityReport report = evaluate(failed).value();
  EXPECT_EQ(report.find("solver_failures")->value, 1.0);
  EXPECT_FALSE(report.passed());
  report.file = "walk.csv";
  EXPECT_THAT(report_text({&report, 1}),
              HasSubstr("walk.csv: solver_failures is 1, expected at most 0\n"
                        "  fit with dynamics: 30 frames, frames 0-29, worst 0\n"));
  const auto json = nlohmann::json::parse(report_json({&report, 1}))["motions"][0];
  EXPECT_EQ(json["solver_failures"], 1.0);
  EXPECT_EQ(json["passed"], false);
  EXPECT_EQ(json["fit"]["solver"]["dynamics_failed"], true);
}

// With noise in the joints, contacts of hands and knees would pull the feet off their anchors.
TEST(FrontDoor, LowersWeightsOfBodyContactsForNoisySources) {
  const auto robot = value_of(g1());
  const Clip clip = load_clip(sample("wave")).value();
  const auto with_noise = [&](double radians) {
    Clip noisy = clip;
    std::mt19937 random(1);
    std::normal_distribution<double> angle(0.0, radians);
    for (int frame = 0; frame < noisy.frame_count(); ++frame) {
      for (Eigen::Quaterniond& rotation : noisy.rotations(frame)) {
        rotation = rotation * exp_so3({angle(random), angle(random), angle(random)});
      }
    }
    return noisy;
  };
  const Clip noisy = with_noise(0.05);
  const double usual = make_plan(clip, robot, Options()).value().fit.body_contact_weight;
  EXPECT_EQ(usual, FitOptions().body_contact_weight);
  const FitOptions lowered = make_plan(noisy, robot, Options()).value().fit;
  EXPECT_LT(lowered.body_contact_weight, 0.8 * usual);
  EXPECT_GT(lowered.body_contact_weight, 0.6 * usual);
  EXPECT_EQ(lowered.contact_weight, FitOptions().contact_weight);
  // Less noise lowers them less.
  const double slightly =
      make_plan(with_noise(0.03), robot, Options()).value().fit.body_contact_weight;
  EXPECT_LT(slightly, 0.95 * usual);
  EXPECT_GT(slightly, 1.05 * lowered.body_contact_weight);
  Options unchanged;
  unchanged.human.clean = CleanRule::kOff;
  EXPECT_EQ(make_plan(noisy, robot, unchanged).value().fit.body_contact_weight, usual);
}

TEST(FrontDoor, DoubtsAPathThatContradictsTheFeet) {
  const auto robot = value_of(g1());
  const Clip clip = load_clip(sample("walk")).value();
  EXPECT_TRUE(make_plan(clip, robot, Options()).value().doubts().empty());
  Clip mirrored = clip;
  for (int frame = 0; frame < clip.frame_count(); ++frame)
    mirrored.translations(frame)[0].x() *= -1;
  const auto doubts = make_plan(mirrored, robot, Options()).value().doubts();
  ASSERT_EQ(doubts.size(), 1U);
  EXPECT_THAT(doubts[0].message, HasSubstr("the horizontal path of the root is mirrored"));
}

TEST(FrontDoor, DoubtsASourceThatJumps) {
  const auto robot = value_of(g1());
  Clip clip = load_clip(sample("walk")).value();
  // 80 cm in one frame.
  for (int frame = 150; frame < clip.frame_count(); ++frame) {
    clip.translations(frame)[0].x() += 80.0;
  }
  const auto doubts = make_plan(clip, robot, Options()).value().doubts();
  EXPECT_THAT(doubts,
              testing::Contains(testing::Field(
                  &Warning::message, testing::AllOf(HasSubstr("the hips move at 2"),
                                                    HasSubstr("in 1 frame, first in frame 150")))));
}

// A file of 60 frames per second with 30 poses per second: every second frame repeats a pose.
TEST(FrontDoor, RepeatedPosesAreNotJitter) {
  const auto robot = value_of(g1());
  const Clip clip = load_clip(sample("walk")).value();
  Clip held(clip.shared_skeleton(), FrameRate{60, 1}, 2 * clip.frame_count());
  for (int frame = 0; frame < held.frame_count(); ++frame) {
    copy_frame(clip, frame / 2, held, frame);
  }
  const Plan plan = make_plan(held, robot, Options()).value();
  EXPECT_THAT(plan.summary(), HasSubstr("300 repeated frames interpolated"));
  EXPECT_THAT(plan.summary(), Not(HasSubstr("jitter")));
  EXPECT_THAT(plan.summary(), Not(HasSubstr("root moved")));
}

}  // namespace
}  // namespace retarget
