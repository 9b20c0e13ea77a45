#include "retarget/rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "retarget/load_robot.h"
#include "retarget/motion_io.h"
#include "solve/robot_setup/check_robot.h"
#include "support/humanoids.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

namespace fs = std::filesystem;

void replace(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
}

std::string refusal_of(const TemporaryFolder& folder, const std::string& text) {
  const auto made = make_robot(folder.write("robot.xml", text), "robot");
  EXPECT_FALSE(made.has_value());
  if (made) return {};
  EXPECT_EQ(made.error().kind, ErrorKind::kConfig);
  EXPECT_EQ(made.error().message.find('\n'), std::string::npos);
  return made.error().message;
}

// Bodies with equal names have equal positions.
void expect_same_poses(const Robot& original, const Robot& robot, const std::vector<double>& qpos) {
  std::vector<Pose> expected(original.bodies().size());
  std::vector<Pose> found(robot.bodies().size());
  forward_kinematics(original, qpos, expected);
  forward_kinematics(robot, qpos, found);
  for (std::size_t b = 0; b < expected.size(); ++b) {
    const Pose& pose =
        b == 0 ? found[0] : found[robot.find_body(original.bodies()[b].name).value()];
    EXPECT_NEAR((pose.translation - expected[b].translation).norm(), 0.0, 1e-12);
    EXPECT_NEAR((pose.rotation.coeffs() - expected[b].rotation.coeffs()).norm(), 0.0, 1e-12);
  }
}

TEST(MakeRobot, WrittenFolderHasTheSameKinematics) {
  const TemporaryFolder folder;
  std::string text = tiny_humanoid(true);
  // An anchor off the origin, a rotated body, a reference position.
  replace(text, "<joint name=\"left_knee\"", "<joint pos=\"0 0.01 0.003\" name=\"left_knee\"");
  replace(text, "<body name=\"torso\" pos=\"0 0 0.05\">",
          "<body name=\"torso\" pos=\"0 0 0.05\" quat=\"0.9999 0.001 0.002 0.003\">");
  replace(text, "<joint name=\"waist\"", "<joint ref=\"0.1\" name=\"waist\"");
  const std::string model = folder.write("any.xml", text);
  const auto made = value_of(make_robot(model, "mine"));
  const auto written = value_of(save_robot(made, folder.path(), false));

  const auto original = value_of(load_robot_files(model));
  const auto robot = load_robot_in(written);
  // A frame body holds the joint with the anchor.
  std::vector<std::string> names = robot->body_names();
  EXPECT_THAT(robot->profile().joint_frames, ::testing::ElementsAre("left_knee_frame"));
  std::erase(names, "left_knee_frame");
  ASSERT_EQ(names, original->body_names());
  ASSERT_EQ(robot->joint_names(), original->joint_names());
  EXPECT_EQ(robot->model_limits().lower, original->model_limits().lower);
  EXPECT_EQ(robot->model_limits().upper, original->model_limits().upper);
  std::vector<double> qpos = original->zero_configuration();
  EXPECT_EQ(robot->zero_configuration(), qpos);
  for (std::size_t i = 7; i < qpos.size(); ++i) qpos[i] += 0.1 * static_cast<double>(i % 5) - 0.2;
  expect_same_poses(*original, *robot, qpos);

  const auto config = value_of(load_retargeting_config((written / "ik.json").string()));
  EXPECT_TRUE(resolve_config(config, *robot));
  for (const RobotFinding& finding : check_robot(*robot, &config)) {
    EXPECT_FALSE(finding.fault) << finding.text;
  }
  EXPECT_TRUE(fs::is_regular_file(written / "decisions.md"));
}

TEST(MakeRobot, HoldsSeveralJointsOfABodyByFrames) {
  const TemporaryFolder folder;
  std::string text = tiny_humanoid(true);
  // The two ankle joints on the foot, the first one anchored and without limits.
  for (const std::string side : {"left", "right"}) {
    replace(text, "<joint name=\"" + side + "_ankle_pitch\" axis=\"0 1 0\" range=\"-1 0.8\"/>", "");
    replace(text, "<joint name=\"" + side + "_ankle_roll\"",
            "<joint name=\"" + side +
                "_ankle_pitch\" axis=\"0 1 0\" pos=\"0 0 0.01\"/>"
                "<joint name=\"" +
                side + "_ankle_roll\"");
  }
  const std::string model = folder.write("any.xml", text);
  const auto made = value_of(make_robot(model, "mine"));
  const auto written = value_of(save_robot(made, folder.path(), false));
  const auto original = load_robot_files(model).value();
  const auto robot = load_robot_in(written);
  EXPECT_EQ(robot->joint_names(), original->joint_names());
  EXPECT_THAT(robot->warnings(), ::testing::IsEmpty());
  EXPECT_EQ(robot->model_limits().lower, original->model_limits().lower);
  std::vector<double> qpos = original->zero_configuration();
  for (std::size_t i = 7; i < qpos.size(); ++i) qpos[i] += 0.1 * static_cast<double>(i % 5) - 0.2;
  expect_same_poses(*original, *robot, qpos);
  const int frame = robot->find_body("left_ankle_pitch_frame").value();
  EXPECT_EQ(robot->joints()[robot->find_joint("left_ankle_pitch").value()].body, frame);
  EXPECT_EQ(robot->moved_body(frame), robot->find_body("left_foot"));
  EXPECT_EQ(robot->moved_body(robot->root_body()), robot->root_body());
  // Motion files have the bodies of the original.
  const auto bodies_of = [](const Robot& of) {
    std::vector<std::string> names;
    for (const int body : tracking_layout(of, MotionFormat::kNpzHolosoma).bodies) {
      names.push_back(of.bodies()[body].name);
    }
    return names;
  };
  EXPECT_EQ(bodies_of(*robot), bodies_of(*original));
}

TEST(MakeRobot, FindsSolesOfABoxFoot) {
  const TemporaryFolder folder;
  const auto made = value_of(make_robot(folder.write("any.xml", tiny_humanoid(true)), "mine"));
  const auto written = value_of(save_robot(made, folder.path(), false));
  const auto robot = load_robot_in(written);
  const std::vector<Sole>& soles = robot->profile().soles;
  ASSERT_EQ(soles.size(), 2U);
  // The lower corners of the box: heel left, heel right, toe left, toe right.
  const std::vector<Eigen::Vector3d> corners = {
      {-0.05, 0.03, -0.05}, {-0.05, -0.03, -0.05}, {0.11, 0.03, -0.05}, {0.11, -0.03, -0.05}};
  for (const Sole& sole : soles) {
    ASSERT_EQ(sole.points.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR((sole.points[i] - corners[i]).norm(), 0.0, 1e-5) << sole.side << i;
    }
  }
}

TEST(MakeRobot, ReplacesAFolderOnlyWhenForced) {
  const TemporaryFolder folder;
  const auto made = value_of(make_robot(folder.write("any.xml", tiny_humanoid(true)), "mine"));
  ASSERT_TRUE(save_robot(made, folder.path(), false));
  std::ofstream(folder.path() / "mine" / "own.txt") << "kept";
  const auto again = save_robot(made, folder.path(), false);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().kind, ErrorKind::kUsage);
  EXPECT_TRUE(fs::exists(folder.path() / "mine" / "own.txt"));
  ASSERT_TRUE(save_robot(made, folder.path(), true));
  EXPECT_FALSE(fs::exists(folder.path() / "mine" / "own.txt"));
  // No other files remain.
  int entries = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder.path())) ++entries;
  EXPECT_EQ(entries, 2);
  // The folder is created, but not its parent.
  EXPECT_TRUE(save_robot(made, folder.path() / "missing", false));
  EXPECT_FALSE(save_robot(made, folder.path() / "none" / "missing", false));
}

TEST(MakeRobot, RejectsNamesThatAreNotUtf8) {
  const TemporaryFolder folder;
  std::string text = tiny_humanoid(true);
  const std::size_t at = text.find("name=\"");
  ASSERT_NE(at, std::string::npos);
  text.insert(at + 6, "\xE9");
  const auto made = make_robot(folder.write("latin1.xml", text), "mine");
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().kind, ErrorKind::kConfig);
  EXPECT_NE(made.error().message.find("is not UTF-8"), std::string::npos) << made.error().message;
}

TEST(MakeRobot, ReplacesOnlyRobotFolders) {
  const TemporaryFolder folder;
  const auto made = value_of(make_robot(folder.write("any.xml", tiny_humanoid(true)), "mine"));
  const fs::path place = folder.path() / "mine";
  const auto is_kept = [&](const char* what) {
    const auto saved = save_robot(made, folder.path(), true);
    ASSERT_FALSE(saved) << what;
    EXPECT_EQ(saved.error().kind, ErrorKind::kUsage) << what;
    EXPECT_NE(saved.error().message.find("robots add did not create it"), std::string::npos);
  };
  fs::create_directory(place);
  is_kept("an empty folder");
  folder.write("mine/thesis.txt", "years");
  is_kept("another folder");
  for (const char* profile : {"", "[]", "{}", R"({"name": "mine"})", R"({"name": "other"})"}) {
    folder.write("mine/robot.json", profile);
    is_kept(profile);
  }
  EXPECT_TRUE(fs::exists(place / "thesis.txt"));
  fs::remove_all(place);
  folder.write("mine", "a file");
  is_kept("a file");
  fs::remove(place);
  // A robot with another name, and one behind a link.
  MadeRobot other = made;
  other.name = "other";
  ASSERT_TRUE(save_robot(other, folder.path(), false));
  fs::rename(folder.path() / "other", folder.path() / "kept");
  fs::create_directory_symlink("kept", place);
  is_kept("a link");
  EXPECT_TRUE(fs::exists(folder.path() / "kept" / "model.xml"));
}

TEST(MakeRobot, KeepsForeignFoldersWithTemporaryNames) {
  const TemporaryFolder folder;
  const auto made = value_of(make_robot(folder.write("any.xml", tiny_humanoid(true)), "mine"));
  for (const char* name : {".mine.new", ".mine.old"}) {
    fs::create_directory(folder.path() / name);
    folder.write(std::string(name) + "/precious.txt", "kept");
  }
  ASSERT_TRUE(save_robot(made, folder.path(), true));
  ASSERT_TRUE(save_robot(made, folder.path(), true));
  EXPECT_TRUE(fs::exists(folder.path() / ".mine.new" / "precious.txt"));
  EXPECT_TRUE(fs::exists(folder.path() / ".mine.old" / "precious.txt"));
  MadeRobot up = made;
  for (const char* name : {"..", ".", "", "a/b", "../mine"}) {
    up.name = name;
    EXPECT_FALSE(save_robot(up, folder.path() / ".mine.old", true)) << name;
  }
}

TEST(MakeRobot, AddsAMissingFreeJoint) {
  const TemporaryFolder folder;
  std::string text = tiny_humanoid(true);
  replace(text, "<freejoint/>", "");
  const auto made = value_of(make_robot(folder.write("fixed.xml", text), "mine"));
  EXPECT_THAT(made.notes, Contains(HasSubstr("\"pelvis\" was given one")));
  EXPECT_THAT(made.model, HasSubstr("<freejoint"));
}

TEST(MakeRobot, NotesSolesAtDifferentHeights) {
  std::string text = tiny_humanoid(true);
  const TemporaryFolder folder;
  const auto even = make_robot(folder.write("even.xml", text), "even");
  replace(text, "<body name=\"left_ankle\" pos=\"0 0 -0.25\">",
          "<body name=\"left_ankle\" pos=\"0 0 -0.28\">");
  const auto uneven = make_robot(folder.write("uneven.xml", text), "uneven");
  ASSERT_TRUE(even && uneven);
  EXPECT_THAT(even->notes, Not(Contains(HasSubstr("lower than the other"))));
  EXPECT_THAT(uneven->notes, Contains(HasSubstr("the left sole is 0.03 m lower")));
}

TEST(MakeRobot, RejectsUnsupportedModels) {
  const TemporaryFolder folder;
  std::string looped = tiny_humanoid(true);
  replace(looped, "</mujoco>",
          "<equality><connect body1=\"left_shin\" body2=\"left_foot\" anchor=\"0 0 0\"/>"
          "</equality></mujoco>");
  EXPECT_THAT(refusal_of(folder, looped), HasSubstr("closed chain"));
  std::string two = tiny_humanoid(true);
  replace(two, "</worldbody>", "<body><freejoint/><geom size=\"0.1\"/></body></worldbody>");
  EXPECT_THAT(refusal_of(folder, two), HasSubstr("2 free joints"));
  EXPECT_THAT(refusal_of(folder,
                         "<mujoco><worldbody><body><joint/><geom size=\"1\"/></body>"
                         "</worldbody></mujoco>"),
              AnyOf(HasSubstr("no free joint"), HasSubstr("single arm")));
}

// An empty "t_pose" is right for a robot whose zero pose is the T-pose.
TEST(CheckRobot, ZeroPoseMayBeTheTPose) {
  for (const bool arms_down : {false, true}) {
    std::string texts;
    for (const RobotFinding& finding :
         check_robot(*robot_from_text(tiny_humanoid(arms_down)), nullptr)) {
      texts += finding.text + "\n";
    }
    EXPECT_EQ(texts.find("the T-pose is unknown") != std::string::npos, arms_down) << texts;
  }
}

TEST(CheckRobot, ReportsErrorsAndWarnings) {
  const TemporaryFolder folder;
  const auto made = value_of(make_robot(folder.write("any.xml", tiny_humanoid(true)), "mine"));
  const auto robot = robot_from_text(tiny_humanoid(true));
  auto config = parse_retargeting_config(made.config, "ik.json").value();
  const auto texts = [&](bool faults) {
    std::vector<std::string> found;
    for (const RobotFinding& finding : check_robot(*robot, &config)) {
      if (finding.fault == faults) found.push_back(finding.text);
    }
    return found;
  };
  EXPECT_TRUE(texts(true).empty());
  EXPECT_THAT(texts(false), Contains(HasSubstr("no speed limit")));
  EXPECT_THAT(texts(false), Contains(HasSubstr("soles")));

  // One arm rotated over, another weight on the other side, legs twice as long.
  const RetargetingConfig sound = config;
  for (IkMatchTable& table : config.match_tables) {
    for (IkMatch& row : table.rows) {
      if (row.bone == "LeftArm")
        row.rotation_offset = Eigen::Quaterniond(0, 0, 1, 0) * row.rotation_offset;
      if (row.bone == "RightLeg") row.rotation_weight = 3.0;
    }
  }
  for (auto& [bone, scale] : config.scales) {
    if (bone.find("Foot") != std::string::npos) scale *= 2.0;
  }
  EXPECT_THAT(texts(true), Contains(HasSubstr("(LeftArm) leaves it 180.0 degrees")));
  EXPECT_THAT(texts(true), Contains(HasSubstr("farther from the hip")));
  EXPECT_THAT(texts(false), Contains(HasSubstr("weights of LeftLeg")));

  // All missing names are reported.
  config = sound;
  config.match_tables[0].rows[0].body = "pelvsi";
  config.match_tables[1].rows[1].bone = "LeftUpLge";
  EXPECT_THAT(texts(true), Contains(HasSubstr("pelvsi")));
  EXPECT_THAT(texts(true), Contains(HasSubstr("LeftUpLge")));
}

}  // namespace
}  // namespace retarget
