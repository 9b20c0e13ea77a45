#include <gmock/gmock.h>

#include <cmath>

#include "edit_sample.h"
#include "retarget/ground_path.h"
#include "retarget/text.h"
#include "support/angles.h"

namespace retarget {
namespace {

using namespace edit_test;

TEST(GroundPaths, AreParametrisedByArcLength) {
  const GroundPath path({{0, 0}, {1, 2}, {3, -2}, {4, 1}, {5, 4}, {2, 5}, {2, 5}});
  for (double along = 0.01; along < path.length(); along += 0.01) {
    const Eigen::Vector2d step = path.at(along).position - path.at(along - 0.01).position;
    EXPECT_NEAR(step.norm(), 0.01, 1e-5);
    EXPECT_LT(angle_between(path.at(along - 0.005).heading, std::atan2(step.y(), step.x())), 0.01);
  }
  // The path continues straight at both ends.
  EXPECT_LT((path.at(-2.0).position - Eigen::Vector2d(-2.0, -4.0) / std::sqrt(5.0)).norm(), 1e-12);
  EXPECT_LT((path.at(path.length() + 1.5).position -
             (Eigen::Vector2d(2.0, 5.0) +
              1.5 * (path.at(path.length()).position - path.at(path.length() - 1e-5).position)
                        .normalized()))
                .norm(),
            1e-3);
}

TEST(GroundPaths, BuildLinesCirclesAndFigureEights) {
  const GroundPose start{{1.0, -2.0}, 0.6};
  const GroundPath circle = circle_path(start, 3.0, 2.5 * kPi * 3.0);
  EXPECT_NEAR(circle.length(), 7.5 * kPi, 1e-4);
  const Eigen::Vector2d centre = start * Eigen::Vector2d(0.0, 3.0);
  for (double along = 0.0; along < circle.length(); along += 0.1) {
    EXPECT_NEAR((circle.at(along).position - centre).norm(), 3.0, 2e-5);
    EXPECT_LT(angle_between(circle.at(along).heading, 0.6 + along / 3.0), 1e-4);
  }
  const GroundPath eight = figure8_path(start, 10.0);
  EXPECT_NEAR(eight.length(), 10.0, 1e-4);
  EXPECT_LT((eight.at(5.0).position - start.position).norm(), 1e-3);
  EXPECT_LT((eight.at(10.0).position - start.position).norm(), 1e-3);
  EXPECT_LT(circle_path(start, -1.0, 1.0).at(1.0).heading, 0.6);
  EXPECT_NEAR(line_path(start, 4.0).length(), 4.0, 1e-12);
}

TEST(GroundPaths, HandleCoincidentPoints) {
  // Zero-length handles, a zero-length segment, a path of one point.
  for (const GroundPath& path :
       {GroundPath({{0, 0}, {0, 0}, {2, 0}, {2, 0}}),
        GroundPath(
            {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 0}, {3, 0}, {3, 0}, {4, 0}, {5, 0}, {6, 0}}),
        GroundPath({{1, 1}, {1, 1}, {1, 1}, {1, 1}})}) {
    for (double along = -1.0; along < path.length() + 1.0; along += 0.05) {
      const GroundPose pose = path.at(along);
      ASSERT_TRUE(pose.position.allFinite());
      ASSERT_NEAR(pose.heading, 0.0, 1e-9);
    }
    EXPECT_NEAR(path.at(path.length()).heading, 0.0, 1e-9);
  }
  const GroundPath through = path_through({{0, 0}, {0, 0}, {1, 0}, {1, 1}, {1, 1}});
  EXPECT_EQ(through.segment_count(), 2u);
  EXPECT_EQ(path_through({{2, 3}}).at(1.0).position.y(), 3.0);
}

TEST(GroundPaths, RoundTripThroughJson) {
  const GroundPath path = path_of(data_sample("walk")).path;
  EXPECT_EQ(parse_path(format_path(path), "p.json").value().control_points(),
            path.control_points());
  EXPECT_EQ(parse_path(R"({"waypoints": [[0, 0], [1, 1], [2, 0]]})", "p")->segment_count(), 2u);
  for (const char* wrong :
       {"{}", "[]", R"({"control_points": [[0, 0], [1, 0], [2, 0]]})", R"({"waypoints": []})",
        R"({"waypoints": [[0, 0], [1, "a"]]})", R"({"waypoints": [[0, 1e300]]})",
        R"({"waypoints": [[0, 0]], "control_points": []})", R"({"waypoints": 3})"}) {
    const auto read = parse_path(wrong, "p.json");
    ASSERT_FALSE(read) << wrong;
    EXPECT_EQ(read.error().kind, ErrorKind::kConfig);
    EXPECT_EQ(read.error().location.file, "p.json");
  }
}

}  // namespace
}  // namespace retarget
