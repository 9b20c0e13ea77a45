#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "retarget/scene.h"
#include "retarget/so3.h"
#include "scene/scene_world.h"
#include "scene_world/mesh_bodies.h"
#include "support/npz_builder.h"
#include "support/shared_data.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

std::shared_ptr<Scene> two_bodies() {
  auto scene = std::make_shared<Scene>();
  scene->name = "s.json";
  scene->bodies = {body_of(SceneShape{}), body_of(SceneShape{})};
  scene->bodies[0].name = "table";
  scene->bodies[0].world_from_body.translation = {5, 0, 0};
  scene->bodies[1].name = "box";
  scene->bodies[1].moves = true;
  return scene;
}

// Moves along x by frame^2 / 100 m and turns about z by 0.1 rad a frame.
ObjectTrack track_of(int frames, std::optional<FrameRate> rate = {}) {
  ObjectTrack track;
  track.rate = rate;
  for (int i = 0; i < frames; ++i) {
    track.world_from_body.push_back({exp_so3({0, 0, 0.1 * i}), {0.01 * i * i, 0, 0}});
  }
  return track;
}

void expect_frame(const Pose& pose, double frame) {
  EXPECT_LT((pose.translation - Vector3d(0.01 * frame * frame, 0, 0)).norm(), 1e-9);
  EXPECT_LT(log_so3(pose.rotation * exp_so3({0, 0, -0.1 * frame})).norm(), 1e-9);
}

TEST(PlaceScene, FollowsTheFramesOfACutAndResampledClip) {
  const ClipTimes times{{30, 1}, 20, 4, {50, 1}, 26};
  const auto clip = value_of(place_scene(two_bodies(), std::vector{track_of(20)}, times));
  EXPECT_EQ(clip.frame_count, 26);
  for (int i = 0; i < 26; ++i) {
    expect_frame(clip.pose(i, 1), 4.0 + 0.6 * i);
    EXPECT_EQ(clip.pose(i, 0).translation, Vector3d(5, 0, 0));
  }
}

TEST(PlaceScene, PlacesTheContactsThatATrackStates) {
  ObjectTrack track = track_of(20);
  track.contacts = {{"left_hand", 0, std::vector<char>(20, 0)}};
  track.contacts[0].touches[6] = track.contacts[0].touches[7] = 1;
  const auto clip =
      value_of(place_scene(two_bodies(), std::vector{track}, {{30, 1}, 20, 4, {60, 1}, 12}));
  ASSERT_EQ(clip.contacts.size(), 1U);
  EXPECT_EQ(clip.contacts[0].part, "left_hand");
  EXPECT_EQ(clip.contacts[0].body, 1U);
  // Frames 4, 4.5, 5, ... of the track; halves count up.
  EXPECT_EQ(clip.contacts[0].touches, (std::vector<char>{0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 0}));
}

TEST(PlaceScene, FollowsTheTimesOfATrackWithItsOwnRate) {
  const ClipTimes times{{30, 1}, 20, 4, {30, 1}, 5};
  const auto clip =
      value_of(place_scene(two_bodies(), std::vector{track_of(40, FrameRate{60, 1})}, times));
  for (int i = 0; i < 5; ++i) expect_frame(clip.pose(i, 1), 2.0 * (4 + i));
}

TEST(PlaceScene, MovesTheOnlyBody) {
  auto scene = two_bodies();
  scene->bodies.resize(1);
  const auto clip =
      value_of(place_scene(scene, std::vector{track_of(5)}, {{30, 1}, 5, 0, {30, 1}, 5}));
  EXPECT_TRUE(clip.scene->bodies[0].moves);
  expect_frame(clip.pose(4, 0), 4.0);
}

SceneWorld world_with_box(const std::vector<ObjectTrack>& tracks) {
  SceneShape box;
  box.type = SceneShape::Type::kBox;
  box.half_size = {1.0, 1.0, 0.15};
  auto scene = std::make_shared<Scene>();
  scene->bodies = {body_of(box)};
  scene->bodies[0].moves = true;
  scene->bodies[0].world_from_body.translation = {0.0, 0.0, 0.15};
  auto clip = place_scene(scene, tracks, {{30, 1}, 20, 0, {30, 1}, 20});
  return make_scene_world(std::move(clip).value()).value();
}

// A body without a track is at rest, even if it could move.
TEST(PlaceScene, BodiesAtRestCarryFeetAndScale) {
  const SceneWorld rests = world_with_box({}), moves = world_with_box({track_of(20)});
  EXPECT_TRUE(rests.is_fixed(0));
  EXPECT_FALSE(moves.is_fixed(0));
  EXPECT_NEAR(rests.ground_below(5, {0.2, 0.0, 0.5}), 0.3, 1e-3);
  EXPECT_EQ(moves.ground_below(5, {0.2, 0.0, 0.5}), 0.0);
  EXPECT_NEAR(scaled_world(rests, 0.5).ground_below(5, {0.2, 0.0, 0.5}), 0.15, 1e-3);
}

// A point below the middle of a box on the floor leaves it through the top.
TEST(PlaceScene, NoWayLeadsOutThroughAnUndersideOnTheFloor) {
  const SceneWorld world = world_with_box({});
  for (const double z : {0.0004, 0.05, 0.14}) {
    const SurfaceDistance found = world.distance(0, 0, {0.2, 0.0, z});
    EXPECT_NEAR(found.distance, z - 0.3, 1e-3) << z;
    EXPECT_NEAR(found.normal.z(), 1.0, 1e-9) << z;
  }
  // Sides and the top remain ways out, and so does the underside of a body in the air.
  for (const double z : {0.005, 0.05}) {
    EXPECT_NEAR(world.distance(0, 0, {0.99, 0.0, z}).distance, -0.01, 1e-6) << z;
  }
  EXPECT_NEAR(world.distance(0, 0, {0.0, 0.0, 0.29}).distance, -0.01, 1e-6);
  EXPECT_LT(world_with_box({track_of(20)}).distance(0, 0, {0.0, 0.0, -0.14}).normal.z(), -0.9);
}

TEST(PlaceScene, RejectsTracksThatDoNotMatch) {
  const ClipTimes times{{30, 1}, 20, 4, {30, 1}, 16};
  const auto error_of = [&](std::vector<ObjectTrack> tracks, std::shared_ptr<Scene> scene) {
    const auto clip = place_scene(std::move(scene), tracks, times);
    return clip ? std::string("no error") : describe(clip.error());
  };
  EXPECT_THAT(error_of({track_of(19)}, two_bodies()),
              HasSubstr("has 19 frames, but the clip needs 20"));
  EXPECT_THAT(error_of({{}}, two_bodies()), HasSubstr("has 0 frames"));
  EXPECT_THAT(error_of({track_of(20), track_of(20)}, two_bodies()), HasSubstr("two tracks"));
  ObjectTrack named = track_of(20);
  named.body = "bocks";
  EXPECT_THAT(error_of({named}, two_bodies()), HasSubstr("no body \"bocks\""));
  auto scene = two_bodies();
  scene->bodies[0].moves = true;
  EXPECT_THAT(error_of({track_of(20)}, scene), HasSubstr("BODY=FILE"));
  scene = two_bodies();
  scene->bodies[1].shapes[0].type = SceneShape::Type::kPlane;
  EXPECT_THAT(error_of({track_of(20)}, scene), HasSubstr("infinite plane"));
}

class LoadObjectTrack : public ::testing::Test {
 protected:
  std::string error_of(const std::string& name, const std::string& bytes) {
    const auto track = load_object_track(folder_.write(name, bytes));
    if (track) return "no error";
    EXPECT_THAT(track.error().location.file, HasSubstr(name));
    return describe(track.error());
  }
  TemporaryFolder folder_;
};

const std::vector<double> kTwoPoses = {1, 2, 3, 2, 0, 0, 0, 4, 5, 6, 0, 0, 3, 0};

void expect_two_poses(const Result<ObjectTrack>& track) {
  ASSERT_TRUE(track) << describe(track.error());
  ASSERT_EQ(track->world_from_body.size(), 2U);
  EXPECT_EQ(track->world_from_body[0].translation, Vector3d(1, 2, 3));
  EXPECT_EQ(track->world_from_body[0].rotation.w(), 1.0);
  EXPECT_EQ(track->world_from_body[1].translation, Vector3d(4, 5, 6));
  EXPECT_EQ(track->world_from_body[1].rotation.y(), 1.0);
}

TEST_F(LoadObjectTrack, ReadsNpy) {
  const auto track =
      load_object_track("big box=" + folder_.write("t.npy", npy_doubles({2, 7}, kTwoPoses)));
  expect_two_poses(track);
  EXPECT_EQ(track->body, "big box");
  EXPECT_FALSE(track->rate);
  EXPECT_THAT(error_of("a.npy", npy_doubles({7, 2}, kTwoPoses)), HasSubstr("found (7, 2)"));
  EXPECT_THAT(error_of("b.npy", npy_doubles({2, 7}, kTwoPoses).substr(0, 150)),
              HasSubstr("cut off"));
}

TEST_F(LoadObjectTrack, ReadsNpz) {
  const std::string places = npy_doubles({2, 3}, {1, 2, 3, 4, 5, 6});
  const std::string turns = npy_doubles({2, 4}, {2, 0, 0, 0, 0, 0, 3, 0});
  const auto track = load_object_track(folder_.write("t.npz", NpzBuilder()
                                                                  .add("obj_pos", places)
                                                                  .add("obj_quat", turns)
                                                                  .add("fps", npy_doubles({}, {50}))
                                                                  .build()));
  expect_two_poses(track);
  EXPECT_EQ(track->rate, (FrameRate{50, 1}));
  expect_two_poses(load_object_track(
      folder_.write("p.npz", NpzBuilder().add("pose", npy_doubles({2, 7}, kTwoPoses)).build())));
  EXPECT_THAT(error_of("a.npz", NpzBuilder().add("pos", places).build()),
              HasSubstr("its arrays are pos"));
  EXPECT_THAT(
      error_of(
          "b.npz",
          NpzBuilder().add("pos", places).add("quat", npy_doubles({1, 4}, {1, 0, 0, 0})).build()),
      HasSubstr("2 positions but 1 quaternion"));
  EXPECT_THAT(error_of("c.npz", NpzBuilder().add("pose", turns).build()), HasSubstr("(frames, 7)"));
  EXPECT_THAT(error_of("d.npz", NpzBuilder()
                                    .add("pose", npy_doubles({2, 7}, kTwoPoses))
                                    .add("fps", npy_doubles({}, {-1}))
                                    .build()),
              HasSubstr("positive number of frames"));
}

TEST_F(LoadObjectTrack, ReadsTheContactsOfAnNpz) {
  // One name of nine characters, which NumPy stores as UTF-32.
  const auto named = [](std::string name) {
    std::string data;
    name.resize(9, '\0');
    for (const char letter : name) data += std::string{letter, '\0', '\0', '\0'};
    return npy("<U9", "(1,)", data);
  };
  const auto file = [&](const std::string& part, const std::string& contacts) {
    return NpzBuilder()
        .add("pose", npy_doubles({2, 7}, kTwoPoses))
        .add("contact_parts", named(part))
        .add("contacts", contacts)
        .build();
  };
  const auto track =
      load_object_track(folder_.write("t.npz", file("left_hand", npy_doubles({2, 1}, {0.2, 0.7}))));
  expect_two_poses(track);
  ASSERT_EQ(track->contacts.size(), kSupportNames.size());
  for (const StatedContact& stated : track->contacts) {
    const bool left_hand = stated.part == "left_hand";
    EXPECT_EQ(stated.touches, (std::vector<char>{0, static_cast<char>(left_hand ? 1 : 0)}));
  }
  EXPECT_THAT(error_of("a.npz", file("left_toe", npy_doubles({2, 1}, {0, 1}))),
              HasSubstr("unknown part \"left_toe\""));
  EXPECT_THAT(error_of("b.npz", file("left_hand", npy_doubles({1, 2}, {0, 1}))),
              HasSubstr("expected the shape (2, 1)"));
}

TEST_F(LoadObjectTrack, ReadsCsv) {
  expect_two_poses(load_object_track(folder_.write("t.csv", "1,2,3,2,0,0,0\n4,5,6,0,0,3,0\n")));
  expect_two_poses(load_object_track(
      folder_.write("n.csv", "time,qx,qy,qz,qw,z,y,x\n0,0,0,0,2,3,2,1\n1,0,3,0,0,6,5,4\n")));
  EXPECT_THAT(error_of("a.csv", "1,2,3\n"), HasSubstr("expected 7 columns"));
  EXPECT_THAT(error_of("b.csv", "x,y,z,a,b,c,d\n1,2,3,4,5,6,7\n"), HasSubstr("\"qw\""));
  EXPECT_THAT(error_of("c.csv", "1,2,3,1,0,0,0\n1,2,3,0,0,0,0\n"),
              HasSubstr("frame 1: the quaternion is zero"));
  EXPECT_THAT(error_of("d.csv", "1,2,nan,1,0,0,0\n"), HasSubstr("error"));
  EXPECT_THAT(error_of("e.csv", ""), HasSubstr("error"));
}

TEST_F(LoadObjectTrack, ErrorsDescribeTracks) {
  const auto missing = load_object_track("=");
  ASSERT_FALSE(missing);
  EXPECT_THAT(describe(missing.error()), HasSubstr("BODY=FILE"));
  EXPECT_THAT(error_of("a.bvh", "HIERARCHY\nROOT a\n"), HasSubstr("tracks are NPZ, NPY, CSV"));
}

TEST(LoadSharedTrack, StatesContactsOfHands) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  const auto track =
      value_of(load_object_track((*shared / "data/formats/omomo_sub3_largebox_003.pt").string()));
  ASSERT_EQ(track.contacts.size(), kSupportNames.size());
  for (const StatedContact& stated : track.contacts) {
    EXPECT_EQ(stated.touches.size(), track.world_from_body.size());
    const auto count = std::ranges::count(stated.touches, 1);
    if (stated.part.ends_with("hand")) EXPECT_GT(count, 100) << stated.part;
    if (stated.part.ends_with("knee")) EXPECT_EQ(count, 0) << stated.part;
  }
}

TEST(LoadSharedTrack, RestsOnTheFloorAtFirst) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  const auto track =
      load_object_track((*shared / "data/formats/omomo_sub3_largebox_003.pt").string());
  const auto scene = load_scene((*shared / "data/scenes/largebox__largebox.obj").string());
  if (!track || !scene) GTEST_SKIP() << "the shared data have no object track";
  EXPECT_EQ(track->rate, (FrameRate{30, 1}));
  EXPECT_EQ(track->world_from_body.size(), 196U);
  const auto field = value_of(make_distance_field(scene->bodies[0]));
  const auto bottom = [&](std::size_t frame) {
    const Pose& pose = track->world_from_body[frame];
    return pose.translation.z() + field.lowest(pose.rotation);
  };
  EXPECT_NEAR(bottom(0), 0.0, 0.02);
  EXPECT_NEAR(bottom(195), 0.0, 0.02);
  EXPECT_GT(bottom(98), 0.5);
}

}  // namespace
}  // namespace retarget
