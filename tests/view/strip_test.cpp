#include "retarget/view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "retarget/appearance.h"
#include "support/still_human.h"
#include "support/test_robots.h"
#include "view/figure.h"

namespace retarget {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr const char* kPillar = R"(
<mujoco><worldbody><body name="base"><freejoint/>
  <geom type="capsule" size="0.1" fromto="0 0 0 0 0 1"/>
</body></worldbody></mujoco>)";

// Three lines in a row, without collisions.
constexpr const char* kBare = R"(
<mujoco><worldbody><body name="base"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
  <body name="a" pos="0 0 0.5"><joint name="a" axis="1 0 0"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
    <body name="b" pos="0 0 -0.5"><joint name="b" axis="1 0 0"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
    </body></body></body></worldbody></mujoco>)";

std::size_t count(const std::string& text, std::string_view part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++found;
  }
  return found;
}

// One time below each pose.
std::size_t poses_in(const std::string& svg) {
  return count(svg, "<text ");
}

RobotClip clip_of(const char* mjcf, int frames) {
  return RobotClip(robot_from_text(mjcf), FrameRate{30, 1}, frames);
}

HumanClip standing_human(int frames) {
  return still_human({{"Hips", {5.0, 3.0, 1.0}},
                      {"LeftUpLeg", {5.0, 3.1, 1.0}},
                      {"LeftFoot", {5.0, 3.1, 0.1}},
                      {"Head", {5.0, 3.0, 1.6}}},
                     frames);
}

TEST(Strip, HasTheRequestedNumberOfPoses) {
  const RobotClip clip = clip_of(kPillar, 61);
  const std::string svg = draw_strip(clip, nullptr, {5, {}});
  EXPECT_THAT(svg, StartsWith("<svg xmlns="));
  EXPECT_THAT(svg, EndsWith("</svg>\n"));
  EXPECT_EQ(poses_in(svg), 5);
  for (const char* time : {">0 s<", ">0.5 s<", ">1 s<", ">1.5 s<", ">2 s<"}) {
    EXPECT_THAT(svg, HasSubstr(time));
  }
  EXPECT_EQ(poses_in(draw_strip(clip, nullptr, {1, {}})), 1);
}

TEST(Strip, HasAtMostOnePosePerFrame) {
  EXPECT_EQ(poses_in(draw_strip(clip_of(kPillar, 3), nullptr, {50, {}})), 3);
  EXPECT_EQ(poses_in(draw_strip(clip_of(kPillar, 1), nullptr, {6, {}})), 1);
}

TEST(Strip, SizeIsIndependentOfClipLength) {
  const auto robot = load_g1();
  const std::string svg = draw_strip(RobotClip(robot, FrameRate{30, 1}, 200'000), nullptr, {6, {}});
  EXPECT_EQ(poses_in(svg), 6);
  EXPECT_THAT(svg, HasSubstr(">6666.63 s<"));
  EXPECT_LT(svg.size(), 200'000U);
}

TEST(Strip, IsDeterministic) {
  const RobotClip clip(load_g1(), FrameRate{30, 1}, 30);
  const HumanClip human = standing_human(30);
  EXPECT_EQ(draw_strip(clip, &human), draw_strip(clip, &human));
}

TEST(Strip, DrawsRobotWithoutShapesAsLines) {
  const RobotClip clip = clip_of(kBare, 4);
  ASSERT_TRUE(clip.robot().collision_shapes().empty());
  EXPECT_EQ(visible_shapes(clip.robot()).size(), 3);
  const std::string svg = draw_strip(clip, nullptr, {2, {}});
  EXPECT_EQ(poses_in(svg), 2);
  // An outline and the part itself.
  EXPECT_EQ(count(svg, "<path d="), 2 * 2 * 3 + 1);
}

TEST(Strip, DrawsTheHumanAboveTheRobotUntilItEnds) {
  const RobotClip clip = clip_of(kPillar, 10);
  const HumanClip all = standing_human(10), half = standing_human(5);
  const std::string alone = draw_strip(clip, nullptr, {4, {}});
  const std::string with_all = draw_strip(clip, &all, {4, {}});
  const std::string with_half = draw_strip(clip, &half, {4, {}});
  // Hips to thigh, thigh to foot (the shank is missing), hips to head, head: twice each; a floor.
  EXPECT_EQ(count(with_all, "<path d="), count(alone, "<path d=") + 4 * 4 * 2 + 1);
  EXPECT_EQ(count(with_half, "<path d="), count(alone, "<path d=") + 2 * 4 * 2 + 1);
  EXPECT_EQ(poses_in(with_half), 4);
}

TEST(Strip, OmitsADistantFloor) {
  RobotClip clip = clip_of(kPillar, 10);
  const std::string standing = draw_strip(clip, nullptr, {2, {}});
  for (int i = 0; i < 10; ++i) clip.qpos(i)[2] = 50.0;
  const std::string high = draw_strip(clip, nullptr, {2, {}});
  EXPECT_EQ(count(high, "<path d="), count(standing, "<path d=") - 1);
  const auto height = [](const std::string& svg) {
    const std::size_t at = svg.find("height=\"") + 8;
    return std::stod(svg.substr(at));
  };
  EXPECT_NEAR(height(high), height(standing), 1.0);
}

TEST(Strip, EscapesTheTitle) {
  const std::string svg =
      draw_strip(clip_of(kPillar, 2), nullptr, {2, "a<b> & \"c\".csv\x1b[31m\xff\xef\xbf\xbf"});
  EXPECT_THAT(svg,
              HasSubstr("<title>a&lt;b&gt; &amp; &quot;c&quot;.csv?[31m\xef\xbf\xbd?</title>"));
}

TEST(Camera, FacingDirectionIsToTheRight) {
  for (const double yaw : {0.0, 1.0, 2.5, -2.0}) {
    const Eigen::Vector3d ahead(std::cos(yaw), std::sin(yaw), 0.3);
    const Camera camera = Camera::beside(ahead);
    EXPECT_GT(camera.project(ahead).x(), 0.7);
    EXPECT_NEAR(camera.right.dot(camera.up), 0.0, 1e-12);
    EXPECT_NEAR(camera.up.norm(), 1.0, 1e-12);
    EXPECT_NEAR(camera.right.z(), 0.0, 1e-12);
    EXPECT_GT(camera.up.z(), 0.9);
    // The right hand is nearer than the left one.
    EXPECT_GT(camera.nearer.dot(Eigen::Vector3d(std::sin(yaw), -std::cos(yaw), 0.0)), 0.7);
  }
  EXPECT_EQ(Camera::beside(Eigen::Vector3d::UnitZ()).right, Camera::beside({1.0, 0.0, 0.0}).right);
}

TEST(Figure, DrawsNearerPartsLater) {
  const auto robot = load_g1();
  const Camera camera = Camera::beside(Eigen::Vector3d::UnitX());
  const std::vector<double> qpos = robot->zero_configuration();
  const Figure figure = robot_figure(*robot, visible_shapes(*robot), qpos, camera);
  ASSERT_GT(figure.size(), 20U);
  EXPECT_TRUE(std::ranges::is_sorted(figure, {}, &FigurePart::nearness));
  // A G1 is 1.3 m high, and 0.5 m wide.
  const Eigen::Vector2d size = extent(figure).sizes();
  EXPECT_NEAR(size.y(), 1.32, 0.1);
  EXPECT_NEAR(size.x(), 0.5, 0.3);
}

TEST(Figure, ABoxShowsThreeFaces) {
  const RobotClip clip = clip_of(R"(<mujoco><worldbody><body name="base"><freejoint/>
    <geom type="box" size="0.1 0.2 0.3"/></body></worldbody></mujoco>)",
                                 1);
  const Figure figure = robot_figure(clip.robot(), visible_shapes(clip.robot()), clip.qpos(0),
                                     Camera::beside(Eigen::Vector3d::UnitX()));
  ASSERT_EQ(figure.size(), 1U);
  ASSERT_EQ(figure[0].pieces.size(), 3U);
  for (const auto& piece : figure[0].pieces) EXPECT_EQ(piece.points.cols(), 4);
}

}  // namespace
}  // namespace retarget
