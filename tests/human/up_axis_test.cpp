#include "human/skeleton/up_axis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/option_name.h"
#include "formats/bvh/read_bvh.h"
#include "human/hand_made_maps.h"
#include "human/postures.h"
#include "human/twins.h"
#include "retarget/clip.h"
#include "support/recorded_clip.h"

namespace retarget {
namespace {

double lowest_joint(const Clip& clip, int frame) {
  std::vector<Pose> poses(static_cast<std::size_t>(clip.skeleton().joint_count()));
  forward_kinematics(clip, frame, poses);
  double lowest = std::numeric_limits<double>::infinity();
  for (const Pose& pose : poses) lowest = std::min(lowest, pose.translation.y());
  return lowest;
}

// The body of a y-up clip in a T-pose zero, tumbling continuously: in the air about its hips, or on
// the floor.
Clip tumbling(const std::string& name, double turns, bool on_floor) {
  Clip clip = with_t_pose_as_zero(recorded_clip(name));
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const double floor = lowest_joint(clip, frame);
    const double angle = 2.0 * M_PI * turns * frame / clip.frame_count();
    clip.rotations(frame)[0] =
        Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())) *
        clip.rotations(frame)[0];
    if (on_floor) clip.translations(frame)[0].y() += floor - lowest_joint(clip, frame);
  }
  return clip;
}

Calibration default_calibration(const Clip& clip) {
  return calibrate(clip, lafan1_map(clip.skeleton(), "test"), {}).value();
}

TEST(UpAxis, UsesTheZeroPoseOfTumblingBodies) {
  for (const char* name : {"wave", "turn_in_place", "squat", "walk", "get_up"}) {
    for (const double turns : {1.0, 1.5, 3.0}) {
      for (const bool on_floor : {false, true}) {
        SCOPED_TRACE(std::string(name) + " " + std::to_string(turns) + (on_floor ? " floor" : ""));
        const Calibration found = default_calibration(tumbling(name, turns, on_floor));
        EXPECT_EQ(to_text(found.up), "+y");
      }
    }
  }
}

TEST(UpAxis, WarnsIfTheBodyHardlyStands) {
  const auto doubts = default_calibration(tumbling("turn_in_place", 3.0, true)).doubts;
  ASSERT_FALSE(doubts.empty());
  EXPECT_THAT(doubts[0].message, testing::HasSubstr("using +y as the up axis"));
}

TEST(UpAxis, DoubtsAStatedAxisThatTheMovementContradicts) {
  const auto doubts_of = [](const Clip& clip, const Eigen::Vector3d& up) {
    CalibrationOptions options;
    options.up = up.normalized();
    return calibrate(clip, lafan1_map(clip.skeleton(), "test"), options).value().doubts;
  };
  const Clip walk = recorded_clip("walk");
  const auto doubts = doubts_of(walk, Eigen::Vector3d::UnitZ());
  ASSERT_FALSE(doubts.empty());
  EXPECT_THAT(doubts[0].message, testing::HasSubstr("retarget finds +y as the up axis, not +z"));
  EXPECT_TRUE(doubts_of(walk, Eigen::Vector3d::UnitY()).empty());
  // A world that is not level.
  EXPECT_TRUE(doubts_of(walk, {0.0, 2.0, 1.0}).empty());
  // The axis of a body that hardly stands is uncertain without the statement.
  const Clip uncertain = tumbling("turn_in_place", 3.0, true);
  for (const Warning& doubt : doubts_of(uncertain, Eigen::Vector3d::UnitZ())) {
    EXPECT_THAT(doubt.message, testing::Not(testing::HasSubstr("as the up axis")));
  }
}

// A zero pose along y in a world with z up: the posture of a standing body decides.
TEST(UpAxis, UsesTheMovementOfStandingBodies) {
  const Eigen::Quaterniond z_up(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()));
  for (const char* name : {"wave", "turn_in_place", "squat", "walk"}) {
    const Clip clip = scaled_and_turned(with_t_pose_as_zero(recorded_clip(name)), 1.0, z_up);
    EXPECT_EQ(to_text(default_calibration(clip).up), "+z") << name;
  }
}

TEST(ChooseUp, WithoutPosesUsesSkeletonFactsOrZeroPose) {
  const Clip clip = recorded_clip("walk");
  const Body body(clip.skeleton(), lafan1_map(clip.skeleton(), "test"));
  EXPECT_EQ(choose_up(body, {}, {}).axis, SignedAxis{});
  EXPECT_EQ(choose_up(body, {}, {{}, SignedAxis{2, false}}).axis, (SignedAxis{2, false}));
  EXPECT_EQ(choose_up(body, {}, {SignedAxis{0, false}, SignedAxis{2, false}}).axis,
            (SignedAxis{0, false}));
}

std::vector<JointPoses> poses_of_frames(const Clip& clip) {
  std::vector<JointPoses> poses;
  for (const int frame : sampled_frames(clip)) poses.push_back(frame_pose(clip, frame));
  return poses;
}

// While the body lies along another axis, declarations count in the order of their evidence.
TEST(ChooseUp, PostureAloneOverridesNoKnownFact) {
  const Clip clip = PostureClips(recorded_clip("walk")).make(Posture::kSupine, 0.0);
  const Body body(clip.skeleton(), lafan1_map(clip.skeleton(), "test"));
  const auto poses = poses_of_frames(clip);
  const SignedAxis x{0, false}, y{1, false}, z{2, false};
  EXPECT_NE(choose_up(body, poses, {}).doubt, "");
  for (const KnownUp& known :
       {KnownUp{{}, {}, y}, KnownUp{y, {}}, KnownUp{{}, y}, KnownUp{z, x, y}, KnownUp{y, y, {}}}) {
    const UpChoice choice = choose_up(body, poses, known);
    EXPECT_EQ(choice.axis, y) << to_text(choice.axis);
    EXPECT_EQ(choice.doubt, "");
  }
}

// The floor contradicts the declared axis and the skeleton's: the choice has a warning.
TEST(ChooseUp, AStandingBodyOverridesAWrongAxisWithAWarning) {
  const Clip clip = recorded_clip("walk");
  const Body body(clip.skeleton(), lafan1_map(clip.skeleton(), "test"));
  const SignedAxis z{2, false}, x{0, false};
  for (const KnownUp& known : {KnownUp{{}, {}, z}, KnownUp{z, {}}, KnownUp{x, z}}) {
    const UpChoice choice = choose_up(body, poses_of_frames(clip), known);
    EXPECT_EQ(choice.axis, SignedAxis{});
    EXPECT_THAT(choice.doubt, testing::HasSubstr("the body stands on a floor perpendicular to +y"));
    EXPECT_THAT(choice.doubt, testing::HasSubstr(OPTION("up")));
  }
  EXPECT_EQ(choose_up(body, poses_of_frames(clip), {{}, z}).doubt, "");
}

// A file with a false axis that only posture contradicts.
TEST(ChooseUp, WarnsIfPostureContradictsTheFile) {
  Clip clip = recorded_clip("wave");
  // In the air, so that there is no floor evidence.
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    clip.translations(frame)[0] += Eigen::Vector3d(0.0, 200.0, 300.0);
  }
  const Body body(clip.skeleton(), lafan1_map(clip.skeleton(), "test"));
  const SignedAxis z{2, false};
  const UpChoice choice = choose_up(body, poses_of_frames(clip), {{}, {}, z});
  EXPECT_EQ(choice.axis, z);
  EXPECT_THAT(choice.doubt, testing::HasSubstr("trunk and legs point along +y"));
  // A fall is evidence for the axis.
  EXPECT_EQ(choose_up(body, poses_of_frames(clip), {z, {}, {}, SignedAxis{}}).axis, SignedAxis{});
}

// Files that were rotated away from the axis of their kind. On the floor of the true axis, the body
// seems to stand in the air; in water it seems to climb, or to float on its side.
TEST(ChooseUp, WarnsIfABodySeemsToStandInTheAirClimbOrFloat) {
  const PostureClips postures(recorded_clip("walk"));
  for (const Posture posture : {Posture::kSupine, Posture::kProne, Posture::kSwimming}) {
    for (const double heading : {0.0, 90.0, 180.0, 270.0}) {
      Clip clip = postures.make(posture, heading);
      for (int frame = 0; frame < clip.frame_count(); ++frame) {
        clip.translations(frame)[0] += Eigen::Vector3d(230.0, 0.0, 230.0);
      }
      const Body body(clip.skeleton(), lafan1_map(clip.skeleton(), "test"));
      for (const int axis : {0, 2}) {
        const UpChoice choice = choose_up(body, poses_of_frames(clip), {SignedAxis{axis, false}});
        SCOPED_TRACE(std::string(posture_name(posture)) + " " + std::to_string(heading) + " " +
                     std::to_string(axis));
        EXPECT_THAT(choice.doubt, testing::HasSubstr(OPTION("up")));
      }
      EXPECT_EQ(choose_up(body, poses_of_frames(clip), {SignedAxis{}}).axis, SignedAxis{});
    }
  }
}

// A standing body that jumps by half a metre again and again, and lands on the same floor.
TEST(ChooseUp, ABodyThatJumpsInPlaceDoesNotClimb) {
  Clip clip = PostureClips(recorded_clip("walk")).make(Posture::kStanding, 0.0, 300);
  constexpr double kRise = 0.32, kRest = 0.3, kHalfGravity = 490.5;  // s, s, cm/s^2
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const double time = std::fmod(frame / 30.0, 2.0 * kRise + kRest) - kRise;
    clip.translations(frame)[0].y() += std::max(0.0, kHalfGravity * (kRise * kRise - time * time));
  }
  const Body body(clip.skeleton(), lafan1_map(clip.skeleton(), "test"));
  const auto poses = poses_of_frames(clip);
  const SignedAxis y{1, false};
  EXPECT_THAT(choose_up(body, poses, {y}).doubt, testing::HasSubstr("the body climbs along +y"));
  const UpChoice choice = choose_up(body, poses, {y, {}, {}, y});
  EXPECT_EQ(choice.axis, y);
  EXPECT_EQ(choice.doubt, "");
  // Free fall in another direction is a reason for doubt.
  const UpChoice upside_down = choose_up(body, poses, {y, {}, {}, SignedAxis{1, true}});
  EXPECT_THAT(upside_down.doubt, testing::HasSubstr("has +y up, but the body falls along +y"));
}

// Moves a clip so that its lowest joint is at height 0 along an axis.
void rest_along(Clip& clip, int axis) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const JointPoses& pose : poses_of_frames(clip)) {
    for (const Pose& joint : pose) lowest = std::min(lowest, joint.translation[axis]);
  }
  for (int frame = 0; frame < clip.frame_count(); ++frame)
    clip.translations(frame)[0][axis] -= lowest;
}

// A body with flat soles at height 0 along z and its back at height 0 along y stands or lies. The
// kind of skeleton decides, and the choice has a warning.
TEST(ChooseUp, KeepsTheKindsAxisOfABodyWithFloorsAlongBothAxes) {
  const SignedAxis y{1, false}, z{2, false};
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()));
  Clip clip = scaled_and_turned(PostureClips(recorded_clip("walk")).make(Posture::kStanding, 0.0),
                                1.0, turn);
  rest_along(clip, 1);
  const Body body(clip.skeleton(), lafan1_map(clip.skeleton(), "test"));
  const auto poses = poses_of_frames(clip);
  ASSERT_EQ(choose_up(body, poses, {}).axis, z);
  const UpChoice choice = choose_up(body, poses, {y});
  EXPECT_EQ(choice.axis, y);
  EXPECT_THAT(choice.doubt, testing::HasSubstr(OPTION("up")));
  // A fall along z decides.
  EXPECT_EQ(choose_up(body, poses, {y, {}, {}, z}).axis, z);
}

void move_by(Clip& clip, const Eigen::Vector3d& by) {
  for (int frame = 0; frame < clip.frame_count(); ++frame) clip.translations(frame)[0] += by;
}

UpChoice chosen(const Clip& clip, const KnownUp& known) {
  const Body body(clip.skeleton(), lafan1_map(clip.skeleton(), "test"));
  return choose_up(body, poses_of_frames(clip), known);
}

// A body that neither stands nor has a floor along the kind's axis lies on the floor of another
// axis, even if joints sink into it.
TEST(ChooseUp, LeavesTheKindsAxisForTheFloorOfALyingBody) {
  Clip clip = PostureClips(recorded_clip("walk")).make(Posture::kSupine, 90.0);
  move_by(clip, {230.0, -9.0, 230.0});
  const UpChoice choice = chosen(clip, {SignedAxis{2, false}});
  EXPECT_EQ(choice.axis, SignedAxis{}) << to_text(choice.axis);
  EXPECT_THAT(choice.doubt, testing::HasSubstr("moves on a floor perpendicular to +y"));
}

// A body that seems to stand far from height 0 may lie with its back at height 0, or just below it.
TEST(ChooseUp, WarnsIfABodyThatStandsInTheAirMayLie) {
  Clip clip = PostureClips(recorded_clip("walk")).make(Posture::kStanding, 0.0);
  rest_along(clip, 2);
  for (const double sunk : {0.0, 2.0, 7.0}) {
    Clip lying = clip;
    move_by(lying, {0.0, 100.0, -sunk});
    const UpChoice choice = chosen(lying, {SignedAxis{}});
    EXPECT_EQ(choice.axis, SignedAxis{});
    EXPECT_THAT(choice.doubt, testing::HasSubstr("moves on a floor perpendicular to +z")) << sunk;
  }
  // Where the hips do not move along z, height 0 along z means nothing.
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    clip.translations(frame)[0] += Eigen::Vector3d(0.0, 100.0, 0.0);
    clip.translations(frame)[0].z() = clip.translations(0)[0].z();
  }
  EXPECT_EQ(chosen(clip, {SignedAxis{}}).doubt, "");
}

// A clip of a body that gets up keeps its axis if it is raised, as onto a bed.
TEST(ChooseUp, RaisedBodiesKeepTheirAxis) {
  const Clip clip = recorded_clip("get_up");
  for (const double height : {0.0, 30.0, 50.0, 100.0}) {
    Clip raised = clip;
    move_by(raised, {0.0, height, 0.0});
    const UpChoice choice = chosen(raised, {SignedAxis{}});
    EXPECT_EQ(choice.axis, SignedAxis{}) << height;
    EXPECT_EQ(choice.doubt, "") << height;
  }
}

// Files rarely have x up. A body that seems to stand along it, but not at height 0, rather lies on
// the floor of y.
TEST(ChooseUp, PrefersTheFloorOfACommonAxisToStandingAlongARareOne) {
  const auto turn =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX());
  Clip clip = scaled_and_turned(PostureClips(recorded_clip("walk")).make(Posture::kStanding, 0.0),
                                1.0, turn);
  rest_along(clip, 1);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    clip.translations(frame)[0] += Eigen::Vector3d(100.0, 0.0, 2.0 * frame);
  }
  const SignedAxis z{2, false};
  for (const KnownUp& known : {KnownUp{z, {}}, KnownUp{{}, z}}) {
    const UpChoice choice = chosen(clip, known);
    EXPECT_EQ(choice.axis, SignedAxis{}) << to_text(choice.axis);
    EXPECT_THAT(choice.doubt, testing::HasSubstr("or lies on a floor perpendicular to +y"));
  }
}

// Where a body that lies along the zero pose's axis is on the floor along both axes, none is certain.
TEST(ChooseUp, WarnsIfAZeroPoseHasAFloorToo) {
  Clip clip = recorded_clip("wave");
  const Body body(clip.skeleton(), lafan1_map(clip.skeleton(), "test"));
  const SignedAxis z{2, false};
  rest_along(clip, 2);
  const UpChoice choice = choose_up(body, poses_of_frames(clip), {{}, z});
  EXPECT_EQ(choice.axis, SignedAxis{});
  EXPECT_THAT(choice.doubt, testing::HasSubstr("or lies on a floor perpendicular to +z"));
}

// A body that stands is not turned over by a fall the other way round, and the warning names both.
TEST(ChooseUp, KeepsAStandingBodyUprightAgainstAFall) {
  const Clip clip = recorded_clip("walk");
  const UpChoice choice = chosen(clip, {{}, {}, {}, SignedAxis{1, true}});
  EXPECT_EQ(choice.axis, SignedAxis{}) << to_text(choice.axis);
  EXPECT_THAT(choice.doubt, testing::HasSubstr("point along +y, but the body falls along +y"));
  EXPECT_EQ(chosen(clip, {{}, {}, {}, SignedAxis{}}).doubt, "");
}

}  // namespace
}  // namespace retarget
