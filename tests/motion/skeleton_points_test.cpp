#include "retarget/skeleton_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "support/processor_time.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;

Joint joint(const std::string& name, int parent, const Eigen::Vector3d& offset,
            std::vector<Eigen::Vector3d> end_sites = {}) {
  Joint result;
  result.name = name;
  result.parent = parent;
  result.offset = offset;
  result.end_sites = std::move(end_sites);
  return result;
}

std::vector<std::string> names_of(const Skeleton& skeleton) {
  std::vector<std::string> names;
  for (const SkeletonPoint& point : skeleton_points(skeleton)) names.push_back(point.name);
  return names;
}

TEST(SkeletonPoints, EndSitesFollowTheirJointWithUniqueNames) {
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  const Skeleton skeleton({joint("Hand", -1, zero, {zero, zero, zero}), joint("Hand_end2", 0, zero),
                           joint("Tip", 0, zero, {zero})});
  EXPECT_THAT(names_of(skeleton), ElementsAre("Hand", "Hand_end", "Hand_end3", "Hand_end4",
                                              "Hand_end2", "Tip", "Tip_end"));
}

TEST(SkeletonPoints, ManyEndSitesAreHandledInLinearTime) {
  const auto list_points = [](int joint_count) {
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    std::vector<Joint> joints;
    for (int i = 0; i < joint_count; ++i) {
      joints.push_back(joint("joint" + std::to_string(i), i - 1, zero, {zero}));
    }
    const Skeleton skeleton(std::move(joints));
    EXPECT_EQ(skeleton_points(skeleton).size(), 2U * joint_count);
    EXPECT_EQ(points_below(skeleton, 10).size(), 2U * joint_count - 20);
  };
  EXPECT_LT(time_growth(list_points, 4'000, 40'000), 35) << "10 is linear, 100 quadratic";
}

TEST(Extents, CoverJointsAndEndSitesOfAllFrames) {
  auto skeleton = std::make_shared<const Skeleton>(std::vector<Joint>{
      joint("Root", -1, {1, 0, 0}), joint("Tip", 0, {0, 2, 0}, {Eigen::Vector3d(0, 0, 3)})});
  Clip clip(skeleton, {30, 1}, 2);
  const double half = std::sqrt(0.5);
  clip.rotations(1)[1] = Eigen::Quaterniond(half, 0, half, 0);  // z to x
  const Eigen::AlignedBox3d box = extents(clip);
  EXPECT_LT((box.min() - Eigen::Vector3d(1, 0, 0)).norm(), 1e-12);
  EXPECT_LT((box.max() - Eigen::Vector3d(4, 2, 3)).norm(), 1e-12);
  // Without frames, the skeleton at rest.
  EXPECT_EQ(extents(Clip(skeleton, {30, 1}, 0)).max(), Eigen::Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace retarget
