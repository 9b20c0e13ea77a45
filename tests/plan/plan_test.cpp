// The front door: a clip, a robot, a plan, a motion.

#include "retarget/retarget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/temporary_folder.h"

namespace retarget {
namespace {

using testing::HasSubstr;

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
  return load_robot(named("g1"), {kSource, {}});
}

// a second of a sample
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

TEST(FrontDoor, RetargetsAClipToAFile) {
  const TemporaryFolder folder;
  const auto robot = g1();
  ASSERT_TRUE(robot) << describe(robot.error());
  const auto clip = load_clip(sample("walk"));
  ASSERT_TRUE(clip) << describe(clip.error());
  const auto plan = make_plan(*clip, *robot, short_options());
  ASSERT_TRUE(plan) << describe(plan.error());
  EXPECT_THAT(plan->summary(), HasSubstr("taken as"));
  EXPECT_THAT(plan->summary(), HasSubstr("unitree_g1, 29 joints"));
  EXPECT_EQ(plan->frame_count(), 30);
  const auto motion = solve(*plan);
  ASSERT_TRUE(motion) << describe(motion.error());
  EXPECT_EQ(motion->clip.frame_count(), 30);
  ASSERT_TRUE(motion->fit);
  ASSERT_TRUE(save(*motion, (folder.path() / "walk.csv").string()));
  const std::string text = content(folder.path() / "walk.csv");
  EXPECT_EQ(std::ranges::count(text, '\n'), 30);
  EXPECT_EQ(text, format_robot_csv(motion->clip));
  const auto report = evaluate(*motion);
  ASSERT_TRUE(report) << describe(report.error());
  EXPECT_NE(report->find("limb_angle_deg"), nullptr);
}

TEST(FrontDoor, ReproducesTheGoldenFile) {
  const auto robot = g1();
  ASSERT_TRUE(robot) << describe(robot.error());
  Options options;
  options.solve.method = Method::kGmr;
  const auto plan = make_plan(load_clip(sample("walk")).value(), *robot, options);
  ASSERT_TRUE(plan) << describe(plan.error());
  const auto motion = solve(*plan);
  ASSERT_TRUE(motion) << describe(motion.error());
  const auto golden = load_robot_motion(kSource + "/tests/golden/walk.csv", robot->robot);
  ASSERT_TRUE(golden) << describe(golden.error());
  ASSERT_EQ(motion->clip.frame_count(), golden->clip.frame_count());
  for (int frame = 0; frame < motion->clip.frame_count(); ++frame) {
    const auto found = std::as_const(motion->clip).qpos(frame);
    const auto expected = std::as_const(golden->clip).qpos(frame);
    for (std::size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], expected[i], 1e-6);
  }
}

TEST(FrontDoor, DecisionsCanBeReplaced) {
  const auto robot = g1();
  ASSERT_TRUE(robot);
  auto clip = load_clip(sample("walk"));
  ASSERT_TRUE(clip);
  auto plan = make_plan(std::move(*clip), *robot, short_options(Method::kGmr));
  ASSERT_TRUE(plan) << describe(plan.error());
  plan->part = {10, 20};
  plan->scale = ScaleRule::kHeight;
  const auto motion = solve(*plan);
  ASSERT_TRUE(motion) << describe(motion.error());
  EXPECT_EQ(motion->clip.frame_count(), 10);
  auto limbs = *plan;
  limbs.scale = ScaleRule::kLimbs;
  const auto other = solve(std::move(limbs));
  ASSERT_TRUE(other);
  EXPECT_NE(format_robot_csv(motion->clip), format_robot_csv(other->clip));
}

TEST(FrontDoor, PlansRoundTrip) {
  const TemporaryFolder folder;
  const auto robot = g1();
  ASSERT_TRUE(robot);
  for (const char* name : {"walk", "get_up"}) {
    Options options = short_options();
    options.human.rest = RestPose::kZero;
    options.time.fps = 24.0;
    const auto plan = make_plan(load_clip(sample(name)).value(), *robot, options);
    ASSERT_TRUE(plan) << describe(plan.error());
    const std::string text = plan_json(*plan);
    const std::string file = (folder.path() / "plan.json").string();
    std::ofstream(file) << text;
    const auto back = load_plan(file, {kSource, {}});
    ASSERT_TRUE(back) << describe(back.error());
    EXPECT_EQ(plan_json(*back), text);
    EXPECT_EQ(format_robot_csv(solve(*back).value().clip),
              format_robot_csv(solve(*plan).value().clip));
  }
}

TEST(FrontDoor, PlansAreUtf8WhateverNamesTheClipHas) {
  const TemporaryFolder folder;
  const auto robot = g1();
  ASSERT_TRUE(robot);
  // Latin-1, as old files have it, before the names of all joints
  std::string bvh = content(sample("walk"));
  for (const std::string word : {"ROOT ", "JOINT "}) {
    for (std::size_t at = bvh.find(word); at != std::string::npos; at = bvh.find(word, at + 1)) {
      bvh.insert(at + word.size(), "Andr\xe9:");
    }
  }
  const auto plan =
      make_plan(load_clip(folder.write("walk.bvh", bvh)).value(), *robot, short_options());
  ASSERT_TRUE(plan) << describe(plan.error());
  const std::string text = plan_json(*plan);
  EXPECT_THAT(text, HasSubstr("\"Andr\xef\xbf\xbd:LeftToe\""));
  const auto back = load_plan(folder.write("plan.json", text), {kSource, {}});
  ASSERT_TRUE(back) << describe(back.error());
  EXPECT_EQ(plan_json(*back), text);
  // a file whose own text is none is refused at its line
  std::string wrong = text;
  wrong.replace(wrong.find("\xef\xbf\xbd"), 3, "\xe9");
  const auto refused = load_plan(folder.write("plan.json", wrong), {kSource, {}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kConfig);
  EXPECT_GT(refused.error().location.line, 1U);
  EXPECT_THAT(refused.error().message, HasSubstr("invalid JSON"));
}

TEST(FrontDoor, SolvesAnEditedPlan) {
  const TemporaryFolder folder;
  const auto robot = g1();
  ASSERT_TRUE(robot);
  const auto plan = make_plan(load_clip(sample("walk")).value(), *robot, short_options());
  ASSERT_TRUE(plan);
  auto json = nlohmann::ordered_json::parse(plan_json(*plan));
  json["part"] = {5, 15};
  const std::string file = (folder.path() / "plan.json").string();
  std::ofstream(file) << json.dump();
  const auto back = load_plan(file, {kSource, {}});
  ASSERT_TRUE(back) << describe(back.error());
  EXPECT_EQ(solve(*back).value().clip.frame_count(), 10);
  json["part"] = {15, 5};
  json["scale"] = "limb";
  json["human"]["bones"]["Hips"]["position_joint"] = 1000;
  std::ofstream(file) << json.dump();
  const auto wrong = load_plan(file, {kSource, {}});
  ASSERT_FALSE(wrong);
  EXPECT_THAT(describe(wrong.error()), HasSubstr("is not a joint of the clip"));
  json["human"]["bones"]["Hips"]["position_joint"] = 0;
  std::ofstream(file) << json.dump();
  const auto odd = load_plan(file, {kSource, {}});
  ASSERT_FALSE(odd);
  EXPECT_THAT(describe(odd.error()), HasSubstr("\"part\" is not a part of the clip"));
  EXPECT_THAT(describe(odd.error()), HasSubstr("\"scale\" is not table"));
}

TEST(FrontDoor, SolvingReportsProgressAndCanBeStopped) {
  const auto robot = g1();
  ASSERT_TRUE(robot);
  auto clip = load_clip(sample("walk"));
  ASSERT_TRUE(clip);
  const auto plan = make_plan(std::move(*clip), *robot, short_options());
  ASSERT_TRUE(plan);
  int told = 0;
  SolveControl control;
  control.frame_solved = [&](int frame, std::span<const double>) { EXPECT_EQ(frame, told++); };
  ASSERT_TRUE(solve(*plan, control));
  EXPECT_EQ(told, 30);
  control.keep_going = [](const Progress&) { return false; };
  const auto stopped = solve(*plan, control);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kInterrupted);
}

TEST(FrontDoor, ErrorsNameOptionFields) {
  const auto robot = load_robot(named("unitree_g2"), {kSource, {}});
  ASSERT_FALSE(robot);
  EXPECT_EQ(robot.error().kind, ErrorKind::kConfig);
  EXPECT_EQ(load_clip("nowhere.bvh").error().location.file, "nowhere.bvh");
  auto options = short_options(Method::kGmr);
  options.solve.without = {"floor"};
  const auto known = g1();
  ASSERT_TRUE(known);
  const auto plan = make_plan(load_clip(sample("walk")).value(), *known, options);
  ASSERT_FALSE(plan);
  EXPECT_THAT(describe(plan.error()),
              HasSubstr("fit_config, with, without and window belong to method"));
  EXPECT_THAT(describe(plan.error(), option_as_flag), HasSubstr("--without"));
}

}  // namespace
}  // namespace retarget
