#include "human/gait/seats.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "support/still_human.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// A posture by the places of its middle and left joints; the right ones mirror these.
struct Seated {
  Vector3d hips, neck, knee, foot, elbow, hand;
};

bool is_seated(const Seated& body) {
  std::vector<std::pair<std::string, Vector3d>> places = {{"Hips", body.hips}, {"Neck", body.neck}};
  const std::vector<std::pair<std::string, Vector3d>> left = {
      {"UpLeg", body.hips + Vector3d(0.0, 0.1, 0.0)},
      {"Leg", body.knee},
      {"Foot", body.foot},
      {"ForeArm", body.elbow},
      {"Hand", body.hand}};
  for (const auto& [name, place] : left) {
    places.emplace_back("Left" + name, place);
    places.emplace_back("Right" + name, Vector3d(place.x(), -place.y(), place.z()));
  }
  const HumanClip human = still_human(places, 60);
  return !find_seats(human, poses_of(human), ContactPlan()).empty();
}

TEST(Seats, CarryBodiesOnChairsAndBenches) {
  const Vector3d hips(0.0, 0.0, 0.5), knee(0.42, 0.1, 0.5), foot(0.45, 0.1, 0.1);
  EXPECT_TRUE(is_seated({hips, {0.0, 0.0, 1.0}, knee, foot, {0.05, 0.3, 0.7}, {0.3, 0.2, 0.6}}));
  // Leaning back on low hands, lying on a bench with a weight, and on a bed.
  EXPECT_TRUE(is_seated({hips, {-0.2, 0.0, 0.95}, knee, foot, {-0.3, 0.3, 0.6}, {-0.4, 0.3, 0.3}}));
  EXPECT_TRUE(is_seated({hips, {-0.5, 0.0, 0.5}, knee, foot, {-0.4, 0.4, 0.6}, {-0.4, 0.4, 0.8}}));
  EXPECT_TRUE(is_seated({hips,
                         {-0.5, 0.0, 0.5},
                         {0.42, 0.1, 0.5},
                         {0.85, 0.1, 0.5},
                         {-0.2, 0.3, 0.45},
                         {0.0, 0.3, 0.45}}));
}

TEST(Seats, DoNotCarryPlanksAndBridges) {
  const Vector3d knee(-0.42, 0.1, 0.28), foot(-0.84, 0.1, 0.12);
  EXPECT_FALSE(is_seated(
      {{0.0, 0.0, 0.42}, {0.5, 0.0, 0.58}, knee, foot, {0.4, 0.25, 0.3}, {0.45, 0.2, 0.05}}));
  EXPECT_FALSE(is_seated(
      {{0.0, 0.0, 0.36}, {0.5, 0.0, 0.4}, knee, foot, {0.4, 0.25, 0.04}, {0.65, 0.2, 0.04}}));
  EXPECT_FALSE(is_seated({{0.0, 0.0, 0.36},
                          {-0.45, 0.0, 0.12},
                          {0.38, 0.1, 0.5},
                          {0.4, 0.1, 0.1},
                          {-0.2, 0.3, 0.04},
                          {0.0, 0.3, 0.04}}));
}

}  // namespace
}  // namespace retarget
