// One model per fault of limbs: the message, and the repair.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <string>

#include "rig/model_faults.h"
#include "support/built_humanoids.h"

namespace retarget {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class LimbFaults : public ModelFaults {};

TEST_F(LimbFaults, ReportRigidKneesAndElbows) {
  expect_refused(changed([](BuiltHumanoid& built) { built.leg.joints[3].type = "slide"; }).mjcf(),
                 "has a slide, \"left_knee\"");
  expect_refused(changed([](BuiltHumanoid& built) {
                   built.leg.joints[4].at += built.leg.joints[3].at;
                   built.leg.joints.erase(built.leg.joints.begin() + 3);
                 }).mjcf(),
                 "has no knee");
  expect_refused(changed([](BuiltHumanoid& built) {
                   built.arm.end += built.arm.joints[3].at;
                   built.arm.joints.pop_back();
                 }).mjcf(),
                 "has no elbow");
}

TEST_F(LimbFaults, NameASlideBeforeTheAnkle) {
  const std::string text =
      changed([](BuiltHumanoid& built) { built.leg.joints[4].type = "slide"; }).mjcf();
  expect_refused(text, "has a slide, \"left_ankle_pitch\", before its end");
  EXPECT_THAT(refusal(text), Not(HasSubstr("stand or wheels")));
}

// One arm hangs, the other points ahead: both have the same joints.
TEST_F(LimbFaults, SidesMayNotDifferInTheZeroPose) {
  std::string text = plain_humanoid().mjcf();
  const std::string arm = "<body name=\"left_shoulder_pitch\"";
  replace_all(text, arm, arm + " euler=\"0 -1.2 0\"");
  expect_refused(text,
                 "the limbs starting at \"left_shoulder_pitch\" and \"right_shoulder_pitch\" have "
                 "the same number of joints but do not mirror each other");
  EXPECT_THAT(refusal(text), HasSubstr("mirrored zero pose"));
}

TEST_F(LimbFaults, NameTheLimbWithoutACounterpart) {
  // Removes a body with everything below it.
  const auto without = [](std::string text, const std::string& body) {
    const std::size_t begin = text.find("<body name=\"" + body + "\"");
    EXPECT_NE(begin, std::string::npos);
    std::size_t end = begin;
    for (int depth = 0; depth > 0 || end == begin;) {
      const std::size_t open = text.find("<body", end), close = text.find("</body>", end);
      depth += open < close ? 1 : -1;
      end = open < close ? open + 5 : close + 7;
    }
    return text.erase(begin, end - begin);
  };
  const std::string whole = plain_humanoid().mjcf();
  expect_refused(without(whole, "left_hip_pitch"),
                 "the limb starting at \"right_hip_pitch\" has no counterpart");
  expect_refused(without(whole, "right_shoulder_pitch"),
                 "the limb starting at \"left_shoulder_pitch\" has no counterpart");
  expect_refused(without(whole, "right_ankle_roll"),
                 "have 6 and 5 joints: \"left_ankle_roll\" has no counterpart");
  std::string text = whole;
  const std::size_t elbow = text.find("<joint name=\"left_elbow\"");
  text.erase(elbow, text.find("/>", elbow) + 2 - elbow);
  expect_refused(text, "\"right_elbow\" has no counterpart");
}

TEST_F(LimbFaults, ReportWristsMistakenForElbows) {
  expect_refused(changed([](BuiltHumanoid& built) {
                   built.arm.joints.pop_back();
                   built.arm.joints.push_back({"wrist_pitch", kAxisY, {0, 0, -0.33}, -1, 1});
                   built.arm.joints.push_back({"wrist_roll", kAxisX, {0, 0, 0}, -1, 1});
                   built.arm.end = {0, 0, -0.1};
                 }).mjcf(),
                 "elbow");
}

// Arms with a full wrist whose elbows do not move. No name or body marks the hand.
TEST_F(LimbFaults, ReportFixedElbowsWithoutNames) {
  const auto with_forearm = [](const Eigen::Vector3d& axis, const Eigen::Vector3d& wrist) {
    return changed([&](BuiltHumanoid& built) {
             built.arm.joints.pop_back();
             built.arm.joints.push_back({"a5", axis, {0, 0, -0.18}});
             built.arm.joints.push_back({"a6", kAxisY, wrist, -1, 1});
             built.arm.joints.push_back({"a7", kAxisX, {0, 0, 0}, -1, 1});
             for (std::size_t i = 0; i < 3; ++i) built.arm.joints[i].name = fmt::format("a{}", i);
             built.arm.joints.back().centre = built.arm.end = 0.5 * wrist;
             built.arm.marked = false;
           })
        .mjcf();
  };
  expect_refused(with_forearm(kAxisZ, {0, 0, -0.15}), "has no elbow");
  expect_refused(with_forearm(kAxisX, {0.15, 0, 0}), "has no elbow");
}

// An unmarked hand whose mass makes the part beyond the wrist long.
TEST_F(LimbFaults, NamesTellWristsFromElbows) {
  const auto with_last = [](const std::string& joint) {
    return changed([&](BuiltHumanoid& built) {
             built.arm.joints.back().at = {0, 0, -0.28};
             built.arm.joints.back().name = joint;
             built.arm.marked = false;
           })
        .mjcf();
  };
  expect_refused(with_last("wrist_pitch"), "has no elbow");
  std::string text = with_last("joint_4");
  replace_all(text, "<body name=\"left_joint_4\"", "<body name=\"left_hand\"");
  replace_all(text, "<body name=\"right_joint_4\"", "<body name=\"right_hand\"");
  EXPECT_THAT(findings(text, true), ::testing::IsEmpty());
}

TEST_F(LimbFaults, ReportSidesOfDifferentLength) {
  const auto with_shins = [](const std::string& left) {
    std::string text = plain_humanoid().mjcf();
    replace_all(text, "<body name=\"left_ankle_pitch\" pos=\"0 0 -0.25\">",
                "<body name=\"left_ankle_pitch\" pos=\"0 0 " + left + "\">");
    return text;
  };
  expect_noted(with_shins("-0.28"), "left and right differ in length: shins 0.28 and 0.25 m");
  EXPECT_THAT(notes(with_shins("-0.255")), Not(Contains(HasSubstr("differ in length"))));
}

}  // namespace
}  // namespace retarget
