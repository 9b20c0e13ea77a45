// Contacts of a human's parts with the surfaces of a scene.

#include "human/gait/surface_contacts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "human/gait/move_contacts.h"
#include "retarget/human.h"
#include "retarget/scene.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"
#include "support/still_human.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kBedHeight = 0.5;

Clip clip_raised_by(const std::string& name, double height) {
  Clip clip = recorded_clip(name);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    clip.translations(frame)[0].y() += 100.0 * height;  // Centimetres, Y up.
  }
  return clip;
}

// A box on the floor, with its top in the bed's height.
std::shared_ptr<Scene> bed_scene(bool moves) {
  SceneShape box;
  box.type = SceneShape::Type::kBox;
  box.half_size = {4.0, 4.0, 0.5 * kBedHeight};
  SceneBody bed;
  bed.name = "bed";
  bed.moves = moves;
  bed.world_from_body.translation = {0.0, 0.0, 0.5 * kBedHeight};
  bed.shapes = {box};
  auto scene = std::make_shared<Scene>();
  scene->bodies = {bed};
  return scene;
}

struct HumanInScene {
  HumanInScene(const std::string& name, const std::shared_ptr<Scene>& scene,
               const std::vector<ObjectTrack>& tracks = {})
      : clip(clip_raised_by(name, kBedHeight)), human(lafan1_human(clip)) {
    auto placed = place_scene(scene, tracks,
                              {human.rate, human.frame_count, 0, human.rate, human.frame_count});
    world.emplace(make_scene_world(std::move(placed).value()).value());
    feet = SourceFeet(human, human.frame_count);
    contacts = find_contacts_on_ground(*world, feet);
    parts = SurfaceParts(human, contacts.scale);
    for (int frame = 0; frame < human.frame_count; ++frame) parts.add(human.frame(frame));
    phases = find_surface_contacts(*world, parts, contacts, {}, feet.frame_time);
  }

  Clip clip;
  HumanClip human;
  std::optional<SceneWorld> world;
  SourceFeet feet;
  ContactPlan contacts;
  SurfaceParts parts;
  std::vector<SurfacePhase> phases;
};

// Heights of a bed's top differ by the tolerance of the search for the ground, and contacts at
// their thresholds by a frame.
void expect_same_frames(const std::vector<ContactPhase>& found,
                        const std::vector<ContactPhase>& expected, double height) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_LE(std::abs(found[i].begin - expected[i].begin), 1);
    EXPECT_LE(std::abs(found[i].end - expected[i].end), 1);
    EXPECT_NEAR(found[i].support, expected[i].support + height, 2e-3);
  }
}

TEST(SurfaceContacts, ABodyRestsOnABedAsOnTheFloor) {
  const HumanClip low = lafan1_human(recorded_clip("get_up"));
  const ContactPlan on_floor = find_contacts(SourceFeet(low, low.frame_count));
  const HumanInScene on_bed("get_up", bed_scene(false));
  for (std::size_t foot = 0; foot < 2; ++foot) {
    for (const std::size_t end : {kHeelEnd, kToeEnd}) {
      SCOPED_TRACE(2 * foot + end);
      expect_same_frames(on_bed.contacts.ends[foot][end].phases, on_floor.ends[foot][end].phases,
                         kBedHeight);
    }
  }
  for (std::size_t part = 0; part < kSupportBones.size(); ++part) {
    SCOPED_TRACE(part);
    EXPECT_TRUE(on_bed.contacts.bodies[part].empty());
    expect_same_frames(on_bed.contacts.bodies_above_floor[part], on_floor.bodies[part], kBedHeight);
  }
}

// Whether a part touches the first body of the scene throughout [begin, end).
bool touches(const HumanInScene& scene, std::size_t part, int begin, int end) {
  return std::ranges::any_of(scene.phases, [&](const SurfacePhase& phase) {
    return phase.part == part && phase.body == 0 && phase.begin <= begin && phase.end >= end;
  });
}

TEST(SurfaceContacts, PartsThatRestOnABodyTouchIt) {
  const HumanInScene on_bed("get_up", bed_scene(false));
  for (std::size_t part = 0; part < kSupportBones.size(); ++part) {
    // The left knee does not reach the bed.
    const auto& rests = on_bed.contacts.bodies_above_floor[part];
    EXPECT_EQ(rests.empty(), kSupportBones[part] == Bone::kLeftLeg) << part;
    for (const ContactPhase& rest : rests) {
      int begin = rest.begin, end = rest.end;
      const auto is_far = [&](int frame) {
        return on_bed.parts.nearest(*on_bed.world, frame, part, 0).distance >
               0.05 * on_bed.contacts.scale;
      };
      // Slow hands rest from a height in which they do not touch.
      while (begin < end && is_far(begin)) ++begin;
      while (begin < end && is_far(end - 1)) --end;
      EXPECT_GT(end - begin, (rest.end - rest.begin) / 2) << part;
      EXPECT_TRUE(touches(on_bed, part, begin, end)) << part << " from frame " << rest.begin;
    }
  }
}

// A still hand, at different heights of the wrist above a bed. On the floor it would rest at each.
TEST(SurfaceContacts, HandsRestOnABodyOnlyIfTheyAreNearIt) {
  constexpr int kFrames = 30;
  constexpr std::size_t kLeftHandPart = 4;
  static_assert(kSupportBones[kLeftHandPart] == Bone::kLeftHand);
  for (const auto& [height, rests] : {std::pair(0.065, true), std::pair(0.085, false)}) {
    SCOPED_TRACE(height);
    const HumanClip human =
        still_human({{"LeftHand", Vector3d(0.0, 0.0, kBedHeight + height)}}, kFrames);
    auto placed = place_scene(bed_scene(false), {}, {human.rate, kFrames, 0, human.rate, kFrames});
    const SceneWorld world = make_scene_world(std::move(placed).value()).value();
    SurfaceParts parts(human, 1.0);
    for (int frame = 0; frame < kFrames; ++frame) parts.add(human.frame(frame));
    ContactPlan contacts;
    contacts.bodies_above_floor[kLeftHandPart] = {{0, kFrames, kBedHeight}};
    const auto phases = find_surface_contacts(world, parts, contacts, {}, 1.0 / 30.0);
    EXPECT_EQ(phases.size(), rests ? 1U : 0U);
  }
}

TEST(SurfaceContacts, BodiesThatTracksMoveCarryNothing) {
  ObjectTrack track;
  for (int frame = 0; frame < 286; ++frame) {
    Pose pose;
    pose.translation = {0.01 * frame, 0.0, 0.5 * kBedHeight};
    track.world_from_body.push_back(pose);
  }
  const HumanInScene on_belt("get_up", bed_scene(true), {track});
  for (const auto& phases : on_belt.contacts.bodies_above_floor) EXPECT_TRUE(phases.empty());
  const HumanInScene at_rest("get_up", bed_scene(true));
  EXPECT_FALSE(at_rest.contacts.bodies_above_floor[6].empty());
}

// A body without a track carries feet, but --object-shift moves it.
TEST(SurfaceContacts, FeetMoveWithABodyAtRestThatMayMove) {
  const HumanInScene before("squat", bed_scene(true));
  const Vector3d shift(0.2, 0.0, 0.1);
  SceneClip after = before.world->clip;
  for (Pose& pose : after.world_from_body) pose.translation += shift;
  const ContactMoves moves = moves_with_scene(*before.world, after, Vector3d::Ones(), 1.0,
                                              before.feet, before.contacts, before.phases);
  for (const std::vector<ContactMove>& of_foot : moves.feet) {
    ASSERT_FALSE(of_foot.empty());
    for (const ContactMove& move : of_foot) {
      for (const Vector3d& offset : move.offsets) EXPECT_LT((offset - shift).norm(), 1e-6);
    }
  }
}

}  // namespace
}  // namespace retarget
