// Flights of a human on the path of a thrown stone, and a robot's soles during them.

#include "judge/quality/flight_metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <tuple>

#include "human/gait/contact_plan.h"
#include "human/gait/seats.h"
#include "human/gait/source_feet.h"
#include "retarget/human_skeleton.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

constexpr double kFps = 30.0, kGravity = 9.81;

// A standing human whose hips and feet are raised by these heights.
HumanClip raised_human(int frames, const std::function<double(int)>& hips,
                       const std::function<double(int)>& feet) {
  HumanClip human;
  human.rate = {30, 1};
  human.frame_count = frames;
  human.sources = BoneArray<std::string>("");
  human.world_from_bone.resize(static_cast<std::size_t>(frames));
  for (const auto& [name, side, height, is_foot] : {std::tuple{"Hips", 0.0, 0.95, false},
                                                    {"LeftUpLeg", 0.1, 0.93, false},
                                                    {"LeftLeg", 0.1, 0.5, false},
                                                    {"LeftFoot", 0.1, 0.08, true},
                                                    {"LeftToe", 0.1, 0.02, true},
                                                    {"RightUpLeg", -0.1, 0.93, false},
                                                    {"RightLeg", -0.1, 0.5, false},
                                                    {"RightFoot", -0.1, 0.08, true},
                                                    {"RightToe", -0.1, 0.02, true}}) {
    const Bone bone = bone_from_name(name).value();
    human.sources[bone] = name;
    for (int i = 0; i < frames; ++i) {
      human.world_from_bone[static_cast<std::size_t>(i)][bone].translation =
          Eigen::Vector3d(0.0, side, height + (is_foot ? feet(i) : hips(i)));
    }
  }
  return human;
}

// Take-off in frame 30, landing 12 frames later.
double thrown(int frame) {
  const double t = (frame - 30) / kFps, flight = 12 / kFps;
  return frame < 30 || frame > 42 ? 0.0 : 0.5 * kGravity * t * (flight - t);
}

TEST(Flights, FindsFlightsAndPeaks) {
  const HumanClip human = raised_human(90, thrown, thrown);
  const auto flights = find_flights(human, find_contacts(human), 90);
  ASSERT_EQ(flights.size(), 1U);
  EXPECT_GE(flights[0].begin, 31);
  EXPECT_LE(flights[0].end, 42);
  EXPECT_NEAR(flights[0].peak, thrown(36), 1e-12);
}

TEST(Flights, FeetLiftedWhileSeatedAreNotFlights) {
  const HumanClip human = raised_human(
      90, [](int) { return -0.3; }, thrown);
  EXPECT_TRUE(find_flights(human, find_contacts(human), 90).empty());
}

TEST(Flights, ComparesSolePeaksWithScaledPeaks) {
  const auto robot = load_g1();
  const auto& sole = robot->profile().soles.front();
  RobotClip clip(robot, {30, 1}, 90);
  BodyTracks tracks;
  tracks.soles.push_back({&sole, {}});
  for (int frame = 0; frame < 90; ++frame) {
    tracks.lowest_sole.push_back({0.8 * thrown(frame) - (frame == 36 ? 0.0 : 0.01), sole.body});
  }
  const HumanClip human = raised_human(90, thrown, thrown);
  const auto flights = find_flights(human, find_contacts(human), 90);
  for (const auto& [scale, wanted] :
       {std::pair{0.8, 0.0}, {0.9, 10.0 * thrown(36)}, {0.75, 5.0 * thrown(36)}}) {
    QualityReport report;
    const QualityOptions options;
    measure_flights({clip, options, report}, tracks, flights, scale);
    ASSERT_NE(report.find("flight_peak_max_cm"), nullptr);
    EXPECT_EQ(report.find("flights")->value, 1.0);
    EXPECT_NEAR(report.find("flight_peak_max_cm")->value, wanted, 1e-9) << scale;
    EXPECT_EQ(report.faults.size(), wanted > 2.0 ? 1U : 0U) << scale;
  }
}

TEST(Flights, DoNotCountAsHovering) {
  const auto robot = load_g1();
  RobotClip clip(robot, {30, 1}, 90);
  BodyTracks tracks;
  tracks.lowest.assign(90, {1.0, 0});
  const HumanClip human = raised_human(90, thrown, thrown);
  const SourceFeet feet(human, 90);
  const ContactPlan contacts = find_contacts(feet);
  const auto flights = find_flights(human, contacts, 90);
  ASSERT_EQ(flights.size(), 1U);
  QualityReport report;
  const QualityOptions options;
  measure_hovering({clip, options, report}, tracks, feet, contacts, flights, {}, 0.8);
  ASSERT_NE(report.find("hover_pct"), nullptr);
  const int aloft = flights[0].end - flights[0].begin;
  EXPECT_NEAR(report.find("hover_pct")->value, 100.0 * (90 - aloft) / 90.0, 1e-9);
  // As high as the source, scaled.
  EXPECT_NEAR(source_clearance(feet, contacts, 36), thrown(36), 1e-9);
  EXPECT_EQ(source_clearance(feet, contacts, 0), 0.0);
}

// A person who climbs a step of 25 cm in frame 60.
TEST(MissingSurfaces, AreThoseThatOnlyTheSourceStandsOn) {
  const auto step = [](int frame) { return frame < 60 ? 0.0 : 0.25; };
  HumanClip human = raised_human(150, step, step);
  for (HumanPose& pose : human.world_from_bone) {
    for (const Bone bone : kAllBones) pose[bone].rotation = canonical_t_pose(bone);
  }
  const ContactPlan contacts = find_contacts(human);
  const auto robot = load_g1();
  const RobotClip clip(robot, {30, 1}, 150);
  const QualityOptions options;
  const auto missing = [&](const std::vector<char>& touches_scene) {
    QualityReport report;
    measure_missing_surfaces({clip, options, report}, {}, contacts, 150, {}, touches_scene);
    return report.find("missing_surface_pct")->value;
  };
  EXPECT_NEAR(missing({}), 60.0, 3.0);
  std::vector<char> touches(150, 0);
  std::fill(touches.begin() + 100, touches.end(), char{1});
  EXPECT_NEAR(missing(touches), 60.0 - 100.0 / 3.0, 3.0);
}

// Share of missing surfaces of 100 frames at 30 Hz with these contacts of the left toe.
double missing_under_toe(const std::vector<ContactPhase>& phases,
                         const std::vector<ContactPhase>& seat = {}) {
  ContactPlan contacts;
  contacts.ends[0][kToeEnd].phases = phases;
  contacts.bodies[6] = seat;
  const RobotClip clip(load_g1(), {30, 1}, 100);
  QualityReport report;
  const QualityOptions options;
  measure_missing_surfaces({clip, options, report}, {}, contacts, 100, {}, {});
  return report.find("missing_surface_pct")->value;
}

// Only the toes of runners touch the surface.
TEST(MissingSurfaces, MayCarryToesAlone) {
  EXPECT_NEAR(missing_under_toe({{0, 60, 0.0}, {60, 100, 0.3}}), 40.0, 1e-9);
  EXPECT_EQ(missing_under_toe({{0, 100, 0.0}}), 0.0);
  // The seat carries the body as well.
  EXPECT_NEAR(missing_under_toe({{0, 60, 0.0}, {60, 100, 0.3}}, {{60, 80, 0.0}}), 20.0, 1e-9);
}

TEST(MissingSurfaces, IncludeFlightsBetweenThem) {
  EXPECT_NEAR(missing_under_toe({{0, 50, 0.0}, {50, 60, 0.3}, {75, 100, 0.4}}), 50.0, 1e-9);
  // A flight between contacts with the floor is not on a missing surface.
  EXPECT_NEAR(missing_under_toe({{0, 20, 0.0}, {40, 60, 0.0}, {60, 100, 0.3}}), 40.0, 1e-9);
  // The support is unknown before, after and between different contacts, and in long flights.
  EXPECT_NEAR(missing_under_toe({{10, 40, 0.0}, {60, 90, 0.3}}), 50.0, 1e-9);
  EXPECT_NEAR(missing_under_toe({{0, 30, 0.3}, {65, 95, 0.3}}), 100.0, 1e-9);
  EXPECT_NEAR(missing_under_toe({{0, 10, 0.0}, {10, 20, 0.3}, {60, 70, 0.3}}), 200.0 / 3.0, 1e-9);
  EXPECT_EQ(missing_under_toe({}), 0.0);
}

// No stance is known, but no robot flies for longer than a second.
TEST(MissingSurfaces, CarryRobotsThatStayInTheAir) {
  const RobotClip clip(load_g1(), {30, 1}, 100);
  const QualityOptions options;
  const auto missing = [&](int aloft, const std::vector<char>& touches_scene) {
    BodyTracks tracks;
    tracks.lowest.assign(100, {0.0, 0});
    std::fill_n(tracks.lowest.begin() + 20, aloft, Lowest{0.3, 0});
    QualityReport report;
    measure_missing_surfaces({clip, options, report}, tracks, {}, 100, {}, touches_scene);
    return report.find("missing_surface_pct")->value;
  };
  EXPECT_EQ(missing(30, {}), 0.0);
  EXPECT_NEAR(missing(60, {}), 100.0, 1e-9);
  EXPECT_EQ(missing(60, std::vector<char>(100, 1)), 0.0);
}

// A toe that moves slowly in a jump looks like a contact.
TEST(MissingSurfaces, OfFewKnownFramesCountLittle) {
  EXPECT_NEAR(missing_under_toe({{40, 42, 0.3}, {80, 82, 0.0}}), 8.0, 1e-9);
  EXPECT_NEAR(missing_under_toe({{40, 41, 0.3}}), 4.0, 1e-9);
  EXPECT_NEAR(missing_under_toe({{40, 65, 0.3}}), 100.0, 1e-9);
}

// Stands for 60 frames, then sits on a chair: the thighs are level, and the feet are ahead.
HumanClip sitting_down(int frames) {
  HumanClip human = raised_human(
      frames, [](int) { return 0.0; }, [](int) { return 0.0; });
  for (int frame = 60; frame < frames; ++frame) {
    HumanPose& pose = human.world_from_bone[static_cast<std::size_t>(frame)];
    for (const Bone bone : {Bone::kHips, Bone::kLeftUpLeg, Bone::kRightUpLeg}) {
      pose[bone].translation += Eigen::Vector3d(-0.43, 0.0, -0.43);
    }
  }
  for (HumanPose& pose : human.world_from_bone) {
    for (const Bone bone : kAllBones) pose[bone].rotation = canonical_t_pose(bone);
  }
  return human;
}

// Stands for 60 frames, then holds a pose. Arguments: positions of the trunk and the left leg.
HumanClip holding(const Eigen::Vector3d& hips, const Eigen::Vector3d& neck,
                  const Eigen::Vector3d& knee, const Eigen::Vector3d& ankle) {
  constexpr int kFrames = 150;
  HumanClip human = sitting_down(kFrames);
  human.sources[Bone::kNeck] = "Neck";
  for (int frame = 0; frame < kFrames; ++frame) {
    HumanPose& pose = human.world_from_bone[static_cast<std::size_t>(frame)];
    pose[Bone::kNeck].translation = {0.0, 0.0, 1.45};
    if (frame < 60) continue;
    pose[Bone::kHips].translation = hips;
    pose[Bone::kNeck].translation = neck;
    for (const Side side : kSides) {
      const Eigen::Vector3d mirror(1.0, side == Side::kLeft ? 1.0 : -1.0, 1.0);
      const auto put = [&](LimbBone bone, const Eigen::Vector3d& place) {
        pose[side_bone(side, bone)].translation = mirror.cwiseProduct(place);
      };
      put(LimbBone::kUpLeg, hips + Eigen::Vector3d(0.0, 0.1, -0.02));
      put(LimbBone::kLeg, knee);
      put(LimbBone::kFoot, ankle);
      put(LimbBone::kToe, ankle + Eigen::Vector3d(0.1, 0.0, -0.06));
    }
  }
  return human;
}

std::size_t seat_count(const HumanClip& human) {
  return find_seats(human, poses_of(human), find_contacts(human)).size();
}

TEST(Seats, AreBehindTheFeet) {
  const Eigen::Vector3d hips(-0.4, 0.0, 0.5), knee(0.0, 0.1, 0.5), ankle(0.0, 0.1, 0.08);
  EXPECT_EQ(seat_count(holding(hips, {-0.4, 0.0, 1.0}, knee, ankle)), 1U);
  // The trunk leans on a backrest, or over a table.
  EXPECT_EQ(seat_count(holding(hips, {-0.6, 0.0, 0.95}, knee, ankle)), 1U);
  EXPECT_EQ(seat_count(holding(hips, {-0.1, 0.0, 0.9}, knee, ankle)), 1U);
}

TEST(Seats, AreNotSquatsAndWideStances) {
  // A parallel squat with the trunk leaning forward.
  EXPECT_EQ(seat_count(holding({-0.25, 0.0, 0.47}, {0.25, 0.0, 0.85}, {0.15, 0.1, 0.45},
                               {0.0, 0.1, 0.08})),
            0U);
  // A horse stance.
  EXPECT_EQ(
      seat_count(holding({-0.05, 0.0, 0.5}, {0.0, 0.0, 1.0}, {0.1, 0.45, 0.5}, {0.0, 0.45, 0.08})),
      0U);
  // The hips rest on the heels, with the trunk along the floor.
  EXPECT_EQ(
      seat_count(holding({0.0, 0.0, 0.3}, {0.5, 0.0, 0.2}, {0.4, 0.1, 0.05}, {0.0, 0.1, 0.08})),
      0U);
}

TEST(MissingSurfaces, MayBeSeats) {
  const HumanClip human = sitting_down(120);
  ContactPlan contacts = find_contacts(human);
  const auto seats = find_seats(human, poses_of(human), contacts);
  ASSERT_EQ(seats.size(), 1U);
  EXPECT_NEAR(seats[0].frames.begin, 61, 2);
  EXPECT_EQ(seats[0].frames.end, 120);
  EXPECT_NEAR(seats[0].height, 0.39, 0.03);
  const RobotClip clip(load_g1(), {30, 1}, 120);
  const QualityOptions options;
  const auto missing = [&](const std::vector<SeatRest>& found, const std::vector<char>& touches) {
    QualityReport report;
    measure_missing_surfaces({clip, options, report}, {}, contacts, 120, found, touches);
    return report.find("missing_surface_pct")->value;
  };
  EXPECT_EQ(missing({}, {}), 0.0);
  EXPECT_NEAR(missing(seats, {}), 49.0, 2.0);
  // The robot touches a chair of the scene.
  EXPECT_EQ(missing(seats, std::vector<char>(120, 1)), 0.0);
  // A hand on the floor carries the body as well.
  contacts.bodies[4] = {{0, 120, 0.0}};
  EXPECT_EQ(missing(seats, {}), 0.0);
}

// The faster the root rises, the fewer contacts of a runner's feet are found.
TEST(MissingSurfaces, GrowWithTheHeightOfARun) {
  double before = 0.0;
  for (const int contact : {12, 8, 4, 2}) {
    std::vector<ContactPhase> phases = {{0, 2 * contact, 0.0}};
    for (int begin = 24; begin < 100; begin += 15) {
      phases.push_back({begin, begin + contact, 0.01 * begin});
    }
    const double missing = missing_under_toe(phases);
    EXPECT_GT(missing, before) << contact;
    before = missing;
  }
  EXPECT_GT(before, 90.0);
}

TEST(Flights, IgnoresBodiesThatLieOnTheFloor) {
  // Legs in the air, with hips at the height of sitting or lying bodies.
  HumanClip human = raised_human(
      90, [](int frame) { return frame < 45 ? 0.0 : -0.8; },
      [](int frame) { return frame < 45 ? 0.0 : 0.5; });
  const SourceFeet feet(human, 90);
  const ContactPlan contacts = find_contacts(feet);
  EXPECT_EQ(source_clearance(feet, contacts, 80), 0.0);
  // Half a metre higher nothing rests: the knees, 20 cm above the floor, are nearest to it.
  for (int frame = 45; frame < 90; ++frame) {
    for (const Bone bone : kAllBones) {
      human.world_from_bone[static_cast<std::size_t>(frame)][bone].translation.z() += 0.5;
    }
  }
  const double clearance = source_clearance(SourceFeet(human, 90), contacts, 80);
  EXPECT_GT(clearance, 0.05);
  EXPECT_LT(clearance, 0.2);
}

}  // namespace
}  // namespace retarget
