// The pairs of near shapes, against measurements of all pairs, on the G1.

#include "solve/fit/near_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "retarget/human.h"
#include "solve/targets/targets.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

// The indices of all pairs that are nearer than `within`, measured one by one.
std::vector<std::uint32_t> near_pairs_of(const FitModel& model, const TreeState& pose,
                                         double within) {
  std::vector<std::uint32_t> near;
  const auto in_world = [&](int shape) {
    const FitShape& own = model.shapes[static_cast<std::size_t>(shape)];
    return placed(own, pose.world_from_link[static_cast<std::size_t>(own.link)]);
  };
  for (std::uint32_t i = 0; i < model.pairs.size(); ++i) {
    const FitPair& pair = model.pairs[i];
    const double distance =
        shape_distance(in_world(pair.a), in_world(pair.b), NearestPoints::kEven).distance;
    if (distance < within) near.push_back(i);
  }
  return near;
}

class NearPairsTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto robot = load_g1();
    const ResolvedConfig config = published_config(*robot);
    const TargetBuilder targets(config, 1.75);
    BoneArray<int> target_of_bone;
    for (const Bone bone : kAllBones) target_of_bone[bone] = targets.target_of(bone);
    model_ = make_fit_model(*robot, config, robot->model_limits(), target_of_bone, FitOptions{});
    zero_ = robot->zero_configuration();
  }

  std::vector<double> random_configuration(double spread, double height) {
    std::normal_distribution<double> normal;
    std::vector<double> qpos = zero_;
    for (std::size_t i = 3; i < qpos.size(); ++i) qpos[i] += spread * normal(random_);
    qpos[2] = height;
    return qpos;
  }

  FitModel model_;
  std::vector<double> zero_;
  std::mt19937 random_{1};
};

TEST_F(NearPairsTest, FindsAllNearPairs) {
  constexpr double kWithin = 0.03;
  std::size_t max = 0;
  for (int round = 0; round < 5; ++round) {
    TreeState pose(model_.tree);
    pose.update(random_configuration(0.4, 0.8));
    std::vector<std::uint32_t> found;
    NearPairs(model_).find(pose, kWithin, found);
    EXPECT_EQ(found, near_pairs_of(model_, pose, kWithin));
    max = std::max(max, found.size());
  }
  EXPECT_GT(max, 0U);
}

// Cached pairs of earlier poses must not hide a pair: small and large steps, a travelling root,
// another distance.
TEST_F(NearPairsTest, FindsAllNearPairsAlongAPath) {
  NearPairs search(model_);
  TreeState pose(model_.tree);
  std::vector<double> from = random_configuration(0.4, 0.8), to = from;
  std::vector<std::uint32_t> found;
  std::size_t changes = 0, before = 0;
  constexpr int kSteps = 40;
  for (int step = 0; step < 10 * kSteps; ++step) {
    if (step % kSteps == 0) {
      from = std::exchange(to, random_configuration(0.4, 0.8));
      if (step % (3 * kSteps) == 0) from = to;  // A jump.
      for (std::size_t k = 0; k < 2; ++k) to[k] += 5.0;
    }
    const double share = (step % kSteps) / static_cast<double>(kSteps);
    std::vector<double> qpos(from.size());
    for (std::size_t i = 0; i < qpos.size(); ++i) qpos[i] = from[i] + share * (to[i] - from[i]);
    pose.update(qpos);
    const double within = step < 7 * kSteps ? 0.04 : 0.012;
    search.find(pose, within, found);
    ASSERT_EQ(found, near_pairs_of(model_, pose, within)) << step;
    if (found.size() != before) ++changes;
    before = found.size();
  }
  EXPECT_GT(changes, 50U);
}

// While a list is kept, no distance changes by more than `stay`.
TEST_F(NearPairsTest, KeepsAListWhileThePoseHardlyChanges) {
  constexpr double kWithin = 0.04, kStay = 0.015;
  NearPairs search(model_);
  TreeState pose(model_.tree);
  const std::vector<double> from = random_configuration(0.4, 0.8);
  const std::vector<double> to = random_configuration(0.4, 5.0);
  NearList list;
  int kept = 0;
  for (int step = 0; step < 400; ++step) {
    std::vector<double> qpos(from.size());
    for (std::size_t i = 0; i < qpos.size(); ++i)
      qpos[i] = from[i] + step / 400.0 * (to[i] - from[i]);
    pose.update(qpos);
    const NearList before = list;
    search.update(pose, kWithin, kStay, list);
    const std::vector<std::uint32_t> sure = near_pairs_of(model_, pose, kWithin - kStay);
    const std::vector<std::uint32_t> possible = near_pairs_of(model_, pose, kWithin + kStay);
    EXPECT_TRUE(std::ranges::includes(list.pairs, sure)) << step;
    EXPECT_TRUE(std::ranges::includes(possible, list.pairs)) << step;
    const bool is_same =
        !before.places.empty() && before.places.back().centre == list.places.back().centre;
    if (is_same) ++kept;
  }
  EXPECT_GT(kept, 100);
  EXPECT_LT(kept, 390);
  list.forget();
  search.update(pose, kWithin, kStay, list);
  EXPECT_EQ(list.pairs, near_pairs_of(model_, pose, kWithin));
}

}  // namespace
}  // namespace retarget
