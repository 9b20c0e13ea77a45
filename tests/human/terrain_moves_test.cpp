// Terrain under a walk, changed scenes, and scenes found from motion.

#include "human/gait/move_contacts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "retarget/human.h"
#include "retarget/scene_from_motion.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// A clip on its terrain.
struct OnTerrain {
  Clip clip;
  Calibration calibration;
  Terrain terrain;
  ContactPlan flat;  // Contacts before the change.
  ContactMoves moves;
};

OnTerrain put_walk_on(Terrain terrain, const std::string& name = "walk") {
  OnTerrain result{recorded_clip(name), {}, terrain, {}, {}};
  result.calibration = lafan1_calibration(result.clip.skeleton());
  const HumanClip human = to_human(result.clip, result.calibration);
  const SourceFeet feet(human, human.frame_count);
  result.flat = find_contacts(feet);
  std::vector<Eigen::Vector2d> hips;
  for (const HumanPose& pose : human.world_from_bone) {
    hips.emplace_back(pose[Bone::kHips].translation.head<2>());
  }
  result.moves = put_on_terrain(hips, feet, result.flat, result.terrain);
  move_contacts(result.clip, 0, result.calibration, result.moves);
  return result;
}

Terrain stairs(double rise, double tread) {
  Terrain terrain;
  terrain.rise = rise;
  terrain.tread = tread;
  return terrain;
}

// Calls check(toe, ankle, offset) for both feet in all frames of their stances.
template <typename Check>
void for_each_stand(const OnTerrain& on, const Check& check) {
  const HumanClip human = to_human(on.clip, on.calibration);
  for (std::size_t foot = 0; foot < 2; ++foot) {
    for (const ContactMove& move : on.moves.feet[foot]) {
      for (int frame = move.begin; frame < move.end; ++frame) {
        const HumanPose& pose = human.frame(frame);
        check(frame, static_cast<int>(foot),
              pose[side_bone(kSides[foot], LimbBone::kToe)].translation);
      }
    }
  }
}

TEST(TerrainMoves, FeetStandOnStairs) {
  const OnTerrain on = put_walk_on(stairs(0.12, 0.4));
  ASSERT_FALSE(on.moves.empty());
  EXPECT_GE(on.terrain.count, 4);
  std::set<int> steps;
  for_each_stand(on, [&](int frame, int foot, const Vector3d& toe) {
    if (!on.flat.in_contact(foot, kToeEnd, frame)) return;
    const double ground = on.terrain.height_at(on.terrain.distance(toe.head<2>()));
    EXPECT_NEAR(toe.z() - ground, on.flat.standing.toe, 0.03) << "frame " << frame;
    steps.insert(on.terrain.step_at(on.terrain.distance(toe.head<2>())));
  });
  EXPECT_GE(steps.size(), 4u);
}

TEST(TerrainMoves, TheBodyClimbsAndMovesSmoothly) {
  const OnTerrain on = put_walk_on(stairs(0.12, 0.4));
  const HumanClip before = to_human(recorded_clip("walk"), on.calibration);
  const HumanClip after = to_human(on.clip, on.calibration);
  const int last = after.frame_count - 1;
  const auto height = [](const HumanClip& human, int frame) {
    return human.frame(frame)[Bone::kHips].translation.z();
  };
  const double climbed = height(after, last) - height(before, last);
  EXPECT_NEAR(climbed, 0.12 * on.terrain.count, 0.15);
  EXPECT_EQ(height(after, 0), height(before, 0));
  for (int frame = 1; frame < last; ++frame) {
    const auto acceleration = [&](const HumanClip& human) {
      const double fps = human.rate.fps();
      return (height(human, frame + 1) - 2.0 * height(human, frame) + height(human, frame - 1)) *
             fps * fps;
    };
    EXPECT_LT(std::abs(acceleration(after) - acceleration(before)), 6.0) << "frame " << frame;
  }
}

TEST(TerrainMoves, WholeFeetAreOnOneStep) {
  const OnTerrain on = put_walk_on(stairs(0.1, 0.5));
  const HumanClip human = to_human(on.clip, on.calibration);
  for (std::size_t foot = 0; foot < 2; ++foot) {
    for (const ContactMove& move : on.moves.feet[foot]) {
      const int middle = (move.begin + move.end - 1) / 2;
      const auto step_of = [&](LimbBone part) {
        const Vector3d at = human.frame(middle)[side_bone(kSides[foot], part)].translation;
        return on.terrain.step_at(on.terrain.distance(at.head<2>()));
      };
      EXPECT_EQ(step_of(LimbBone::kFoot), step_of(LimbBone::kToe)) << "frame " << middle;
    }
  }
}

TEST(TerrainMoves, FeetTiltWithASlope) {
  Terrain slope;
  slope.slope = 0.15;
  const OnTerrain on = put_walk_on(slope);
  const HumanClip before = to_human(recorded_clip("walk"), on.calibration);
  const HumanClip after = to_human(on.clip, on.calibration);
  int tilted = 0;
  for_each_stand(on, [&](int frame, int foot, const Vector3d& toe) {
    const double distance = on.terrain.distance(toe.head<2>());
    if (distance < 0.3 || !on.flat.in_contact(foot, kToeEnd, frame)) return;
    EXPECT_NEAR(toe.z() - on.terrain.height_at(distance), on.flat.standing.toe, 0.035)
        << "frame " << frame;
    const Bone ankle = side_bone(kSides[static_cast<std::size_t>(foot)], LimbBone::kFoot);
    const double turn =
        before.frame(frame)[ankle].rotation.angularDistance(after.frame(frame)[ankle].rotation);
    EXPECT_NEAR(turn, 0.15, 1e-3);
    ++tilted;
  });
  EXPECT_GT(tilted, 30);
}

TEST(TerrainMoves, DoesNotMoveAStandingHuman) {
  EXPECT_TRUE(put_walk_on(stairs(0.1, 0.3), "squat").moves.empty());
}

TEST(TerrainMoves, SceneFromMotionFindsTheSteps) {
  const OnTerrain on = put_walk_on(stairs(0.12, 0.4));
  const auto found = value_of(scene_from_motion(on.clip, on.calibration));
  ASSERT_GE(found.surfaces.size(), 3u);
  for (const FoundSurface& surface : found.surfaces) {
    const double steps = std::round(surface.height / 0.12);
    EXPECT_NEAR(surface.height, 0.12 * steps, 0.02) << surface.body;
    EXPECT_GE(steps, 1.0);
    EXPECT_LE(steps, on.terrain.count);
  }
}

TEST(TerrainMoves, SceneFromMotionFindsNothingOnAFlatFloor) {
  for (const char* name : {"walk", "squat", "turn_in_place", "wave"}) {
    const Clip clip = recorded_clip(name);
    const auto found = value_of(scene_from_motion(clip, lafan1_calibration(clip.skeleton())));
    EXPECT_TRUE(found.scene.bodies.empty()) << name;
  }
}

}  // namespace
}  // namespace retarget
