#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "retarget/hash.h"
#include "retarget/human_skeleton.h"
#include "retarget/so3.h"
#include "retarget/view.h"
#include "support/test_robots.h"
#include "view/page.h"
#include "view/page_data.h"

namespace retarget {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kArm = R"(
<mujoco><worldbody><body name="base"><freejoint/><geom type="box" size="0.1 0.1 0.1"/>
  <body name="arm" pos="0 0 0.2"><joint name="shoulder" axis="0 1 0" range="-1 1"/>
    <geom type="capsule" size="0.05" fromto="0 0 0 0 0 0.4"/></body></body></worldbody></mujoco>)";

std::string between(const std::string& text, std::string_view from, std::string_view to) {
  const std::size_t begin = text.find(from);
  if (begin == std::string::npos) return {};
  const std::size_t at = begin + from.size();
  return text.substr(at, text.find(to, at) - at);
}

std::string page_of(const std::string& label, const std::string& title = {}) {
  const RobotClip clip(robot_from_text(kArm), FrameRate{30, 1}, 4);
  const PageMotion motion{label, &clip, nullptr, nullptr, nullptr};
  return view_page({&motion, 1}, {title, {}}).value();
}

TEST(Page, IsSelfContained) {
  const std::string page = page_of("arm");
  EXPECT_THAT(page, testing::StartsWith("<!doctype html>"));
  EXPECT_THAT(page, testing::EndsWith("</html>\n"));
  for (const char* outside :
       {" src=", "<link", "@import", "url(", "@POLICY@", "@STYLE@", "@TRACKS@"}) {
    EXPECT_THAT(page.substr(0, page.rfind("<script>")), Not(HasSubstr(outside)));
  }
  EXPECT_TRUE(std::ranges::all_of(page, [](char c) { return static_cast<signed char>(c) > 0; }));
}

TEST(Page, PolicyNamesTheHashesOfScriptAndStyle) {
  const std::string page = page_of("arm");
  const std::string policy = between(page, "Content-Security-Policy\" content=\"", "\"");
  EXPECT_THAT(policy, HasSubstr("default-src 'none'"));
  EXPECT_THAT(policy, Not(HasSubstr("unsafe")));
  // The text of the elements, not of the files.
  for (const auto& [asset, begin, end] :
       {std::tuple{&kPageScript, "<script>", "</script>"}, {&kPageStyle, "<style>", "</style>"}}) {
    const std::string content = between(page, begin, end);
    EXPECT_EQ(content, asset->text());
    EXPECT_EQ("sha256:" + std::string(asset->sha256), hash_bytes(content).value());
    EXPECT_THAT(policy, HasSubstr(asset->policy_source()));
  }
  // The digest of empty input, as in every description of such policies.
  const PageAsset empty{{}, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"};
  EXPECT_EQ(empty.policy_source(), "'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='");
}

TEST(Page, NamesStayText) {
  const std::string bad = "</script><script>alert(1)</script>\"'&\xFF\xE2\x80\xA8@SCRIPT@";
  const std::string page = page_of(bad, bad);
  const std::string plain = page_of("arm");
  const auto count = [](const std::string& text, std::string_view part) {
    std::size_t found = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
      ++found;
    }
    return found;
  };
  for (const char* tag : {"<script", "</script", "alert(1)</script>"}) {
    EXPECT_EQ(count(page, tag), count(plain, tag)) << tag;
  }
  EXPECT_EQ(between(page, "<title>", "</title>").substr(0, 30),
            std::string("&lt;/script&gt;&lt;script&gt;alert(1)").substr(0, 30));
}

TEST(Page, IsDeterministic) {
  EXPECT_EQ(page_of("arm"), page_of("arm"));
}

TEST(FaultKind, CoversTheFaultsOfReports) {
  EXPECT_EQ(fault_kind("jumps"), "jump");
  EXPECT_EQ(fault_kind("body_pen_1cm_pct"), "penetration");
  EXPECT_EQ(fault_kind("stance_slip_mean"), "slip");
  EXPECT_EQ(fault_kind("self_all_1cm_pct"), "self-collision");
  EXPECT_EQ(fault_kind("speed_limit_pct"), "speed");
  EXPECT_EQ(fault_kind("flight_peak_max_cm"), "other");
}

HumanClip walking_human(int frames, double speed) {
  HumanClip human;
  human.frame_count = frames;
  human.sources[Bone::kHips] = "Hips";
  human.world_from_bone.resize(static_cast<std::size_t>(frames));
  for (int i = 0; i < frames; ++i) {
    human.world_from_bone[static_cast<std::size_t>(i)][Bone::kHips] = {
        Eigen::Quaterniond(canonical_t_pose(Bone::kHips)), {1.0 + speed * i, 2.0, 1.0}};
  }
  return human;
}

TEST(PlaceHuman, AlignsItsPathWithTheRobots) {
  constexpr int kFrames = 100;
  RobotClip clip(robot_from_text(kArm), FrameRate{30, 1}, kFrames);
  for (int i = 0; i < kFrames; ++i) {
    clip.qpos(i)[0] = 5.0 + 0.8 * 0.04 * i;
    clip.qpos(i)[1] = -1.0;
    clip.qpos(i)[2] = 0.7;
  }
  const HumanPlacement walks = place_human(clip, walking_human(kFrames, 0.04));
  EXPECT_NEAR(walks.scale, 0.8, 1e-9);
  EXPECT_NEAR(walks.scale * 1.0 + walks.shift.x(), 5.0, 1e-9);
  EXPECT_NEAR(walks.scale * 2.0 + walks.shift.y(), -1.0, 1e-9);
  EXPECT_NEAR(walks.yaw, 0.0, 1e-9);
  // Without a path, the height determines the scale.
  EXPECT_NEAR(place_human(clip, walking_human(kFrames, 0.0)).scale, 0.7, 1e-9);
}

TEST(PlaceHuman, DoesNotTurnAHumanThatLeans) {
  constexpr int kFrames = 10;
  RobotClip clip(robot_from_text(kArm), FrameRate{30, 1}, kFrames);
  HumanClip leaning = walking_human(kFrames, 0.0);
  for (HumanPose& pose : leaning.world_from_bone) {
    Eigen::Quaterniond& hips = pose[Bone::kHips].rotation;
    hips = exp_so3({0.2, 0.1, 0.0}) * hips;
  }
  EXPECT_EQ(place_human(clip, leaning).yaw, 0.0);
}

// A quarter turn to the left about the vertical.
void turn_left(RobotClip& clip, int frame) {
  const double half = std::sqrt(0.5);
  const double turned[] = {half, 0.0, 0.0, half};
  for (std::size_t i = 0; i < 4; ++i) clip.qpos(frame)[3 + i] = turned[i];
}

TEST(PlaceHuman, FollowsTheRotationOfTheMotion) {
  constexpr int kFrames = 100;
  RobotClip clip(robot_from_text(kArm), FrameRate{30, 1}, kFrames);
  for (int i = 0; i < kFrames; ++i) {
    // The human moves along x from (1, 2), the robot along y from (5, -1).
    clip.qpos(i)[0] = 5.0;
    clip.qpos(i)[1] = -1.0 + 0.8 * 0.04 * i;
    clip.qpos(i)[2] = 0.7;
    turn_left(clip, i);
  }
  const HumanPlacement walks = place_human(clip, walking_human(kFrames, 0.04));
  EXPECT_NEAR(walks.scale, 0.8, 1e-9);
  EXPECT_NEAR(walks.yaw, 1.5707963267948966, 1e-9);
  EXPECT_NEAR(-walks.scale * 2.0 + walks.shift.x(), 5.0, 1e-9);
  EXPECT_NEAR(walks.scale * 1.0 + walks.shift.y(), -1.0, 1e-9);
  // Without a path, the facing determines the heading.
  for (int i = 0; i < kFrames; ++i) clip.qpos(i)[1] = -1.0;
  const HumanPlacement stands = place_human(clip, walking_human(kFrames, 0.0));
  EXPECT_NEAR(stands.scale, 0.7, 1e-9);
  EXPECT_NEAR(stands.yaw, 1.5707963267948966, 1e-9);
  EXPECT_NEAR(-stands.scale * 2.0 + stands.shift.x(), 5.0, 1e-9);
  EXPECT_NEAR(stands.scale * 1.0 + stands.shift.y(), -1.0, 1e-9);
}

}  // namespace
}  // namespace retarget
