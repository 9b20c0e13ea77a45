#include "human/gait/root_drift.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "base/math/gravity.h"
#include "support/angles.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kDriftFrameTime = 1.0 / 30.0;

// Feet and hips of a body by frame.
struct DriftingBody {
  SourceFeet feet;
  std::vector<Vector3d> hips;
};

using Path = std::function<Vector3d(double seconds)>;
using FootPath = std::function<Vector3d(int foot, double seconds)>;

Vector3d nowhere(double) {
  return Vector3d::Zero();
}

// The hips and a foot of a person who walks along x, in steps of 0.6 m that take 0.4 s.
Vector3d foot_of_walker(int foot, double seconds) {
  constexpr double kStep = 0.4, kStride = 1.2;
  const double phase = seconds / (2.0 * kStep) + 0.5 * foot;
  const double whole = std::floor(phase), part = phase - whole;
  // Each foot stands for slightly more than half of the time.
  constexpr double kStands = 0.55;
  const double swing = std::max(0.0, (part - kStands) / (1.0 - kStands));
  const double along = kStride * (whole + swing - std::sin(2.0 * kPi * swing) / (2.0 * kPi));
  const double up = 0.1 * std::pow(std::sin(kPi * swing), 2.0);
  return {along - 0.5 * foot * kStride, foot == 0 ? 0.1 : -0.1, up};
}

DriftingBody body_of(int frames, const Path& off, const FootPath& foot_at) {
  DriftingBody body;
  body.feet.frame_time = kDriftFrameTime;
  body.feet.foot_count = 2;
  body.feet.legs = {kUsualSourceLeg};
  for (int frame = 0; frame < frames; ++frame) {
    const double seconds = frame * kDriftFrameTime;
    Vector3d middle = Vector3d::Zero();
    for (const int foot : {0, 1}) {
      const Vector3d place = foot_at(foot, seconds);
      middle += 0.5 * place;
      SourceFoot& made = body.feet.feet.emplace_back();
      made.ankle = place + off(seconds) + Vector3d(0.0, 0.0, 0.08);
      made.toe = place + off(seconds) + Vector3d(0.14, 0.0, 0.02);
    }
    body.hips.push_back(Vector3d(middle.x(), 0.0, 0.9) + off(seconds));
  }
  return body;
}

Vector3d resting_foot(int foot, double) {
  return {0.0, foot == 0 ? 0.1 : -0.1, 0.0};
}

// Stairs: every step is 0.15 m higher than the previous one.
Vector3d foot_on_stairs(int foot, double seconds) {
  Vector3d place = foot_of_walker(foot, seconds);
  place.z() += 0.15 * place.x() / 0.6;
  return place;
}

Vector3d sway(double seconds) {
  return {0.0, 0.2 * std::sin(2.0 * kPi * seconds / 4.0), 0.0};
}

RootEvidence evidence_of(const DriftingBody& body) {
  return measure_root(body.feet, body.hips);
}

double farthest_left(const DriftingBody& body, const Path& off, const RootDrift& found) {
  // The position of the body as a whole is unknown.
  const Vector3d first = found.drift.front() - off(0.0);
  double far = 0.0;
  for (std::size_t i = 0; i < body.hips.size(); ++i) {
    const Vector3d left = found.drift[i] - off(static_cast<double>(i) * kDriftFrameTime) - first;
    far = std::max(far, left.norm());
  }
  return far;
}

TEST(RootDrift, StandingFeetConfirmTheRoot) {
  const RootEvidence standing = evidence_of(body_of(90, nowhere, resting_foot));
  EXPECT_NEAR(standing.seconds, 3.0, 1e-9);
  EXPECT_EQ(standing.speed, 0.0);
  EXPECT_FALSE(standing.moves());
  const RootEvidence walking = evidence_of(body_of(150, nowhere, foot_of_walker));
  EXPECT_GT(walking.single_seconds, 1.0);
  EXPECT_LT(walking.single_speed, 0.05);
  EXPECT_FALSE(walking.moves());
}

TEST(RootDrift, IgnoresStairs) {
  const RootEvidence stairs = evidence_of(body_of(300, nowhere, foot_on_stairs));
  EXPECT_FALSE(stairs.climbs_steadily);
  EXPECT_FALSE(stairs.moves());
}

TEST(RootDrift, IgnoresJumps) {
  const auto jumping = [](double seconds) {
    const double part = seconds - std::floor(seconds);
    return Vector3d(0.0, 0.0, std::max(0.0, 4.905 * part * (0.5 - part)));
  };
  EXPECT_FALSE(evidence_of(body_of(300, jumping, resting_foot)).moves());
}

// A person who jumps with straight legs and stands on the floor for 0.3 s between the jumps.
double height_of_jumper(double jump, double seconds) {
  const double rise_time = std::sqrt(2.0 * jump / kGravity);
  const double time = std::fmod(seconds, 2.0 * rise_time + 0.3) - rise_time;
  return std::max(0.0, jump - 0.5 * kGravity * time * time);
}

DriftingBody jumper(double jump, const Path& off) {
  const auto jumping = [=](double seconds) {
    return Vector3d(off(seconds) + Vector3d(0.0, 0.0, height_of_jumper(jump, seconds)));
  };
  DriftingBody body = body_of(300, jumping, resting_foot);
  for (const Vector3d& hips : body.hips) body.feet.hips.push_back(hips.z());
  return body;
}

TEST(RootDrift, IgnoresJumpsWithStraightLegs) {
  for (const double jump : {0.1, 0.2, 0.3, 0.5, 0.8}) {
    const RootEvidence evidence = evidence_of(jumper(jump, nowhere));
    EXPECT_FALSE(evidence.moves()) << jump;
    // The time on the floor remains evidence.
    EXPECT_GT(evidence.seconds, 1.0) << jump;
    EXPECT_LT(evidence.speed, 0.01) << jump;
  }
}

TEST(RootDrift, KeepsJumpsWhileItRemovesSway) {
  for (const double jump : {0.1, 0.2, 0.3}) {
    const DriftingBody body = jumper(jump, sway);
    const RootEvidence evidence = evidence_of(body);
    EXPECT_TRUE(evidence.moves()) << jump;
    EXPECT_FALSE(evidence.climbs()) << jump;
    const RootDrift found = find_root_drift(body.feet, body.hips, {false, evidence.climbs()});
    EXPECT_TRUE(found.helps()) << jump;
    EXPECT_LT(farthest_left(body, sway, found), 0.08) << jump;
  }
}

TEST(RootDrift, MeasuresSway) {
  const RootEvidence evidence = evidence_of(body_of(240, sway, resting_foot));
  // The speed of a sine exceeds this value during 65 % of the time.
  EXPECT_NEAR(evidence.speed, 0.2 * 2.0 * kPi / 4.0 * std::sin(0.35 * kPi / 2.0), 0.02);
  EXPECT_TRUE(evidence.moves());
}

TEST(RootDrift, MeasuresASlowRiseOfTheFloor) {
  const auto climb = [](double seconds) { return Vector3d(0.0, 0.0, 0.03 * seconds); };
  const RootEvidence evidence = evidence_of(body_of(300, climb, resting_foot));
  EXPECT_NEAR(evidence.climb, 0.3, 0.01);
  EXPECT_TRUE(evidence.moves());
  EXPECT_TRUE(evidence.climbs());
}

Path shaking(double height) {
  return [height](double seconds) {
    return Vector3d(0.0, 0.0, height * std::sin(2.0 * kPi * 0.6 * seconds));
  };
}

TEST(RootDrift, MeasuresShakingOfTheHeight) {
  // A horizontal oscillation of 2 cm would be too slow to count.
  const Path shake = shaking(0.02);
  const RootEvidence evidence = evidence_of(body_of(300, shake, foot_of_walker));
  EXPECT_LT(evidence.single_speed, 0.1);
  EXPECT_TRUE(evidence.moves());
  EXPECT_TRUE(evidence.climbs());
}

// The foot sinks at 0.07 m/s while it stands.
Vector3d foot_that_rolls(int foot, double seconds) {
  constexpr double kStep = 0.4;
  const double part = std::fmod(seconds / (2.0 * kStep) + 0.5 * foot, 1.0);
  Vector3d place = foot_of_walker(foot, seconds);
  if (part < 0.5) place.z() += 0.07 * 2.0 * kStep * (0.5 - part);
  return place;
}

TEST(RootDrift, IgnoresFeetThatSinkWhileTheyRoll) {
  const RootEvidence evidence = evidence_of(body_of(300, nowhere, foot_that_rolls));
  EXPECT_GT(evidence.climb_speed, 0.03);
  EXPECT_FALSE(evidence.moves());
}

TEST(RootDrift, FeetThatRollDoNotClimbDuringSway) {
  const auto far = [](double seconds) { return Vector3d(2.0 * sway(seconds)); };
  const RootEvidence evidence = evidence_of(body_of(300, far, foot_that_rolls));
  EXPECT_TRUE(evidence.moves());
  EXPECT_FALSE(evidence.climbs());
}

TEST(RootDrift, DoesNotAddUpTheStepsOfFeetThatRoll) {
  const Path shake = shaking(0.02);
  const DriftingBody body = body_of(300, shake, foot_that_rolls);
  const RootEvidence evidence = evidence_of(body);
  EXPECT_TRUE(evidence.climbs());
  EXPECT_FALSE(evidence.climbs_steadily);
  const RootDrift found =
      find_root_drift(body.feet, body.hips, {false, true, evidence.climbs_steadily});
  // Added up, they are 0.3 m.
  EXPECT_LT(farthest_left(body, shake, found), 0.1);
}

TEST(RootDrift, DiscardsAVerticalDriftThatTiltsTheFloor) {
  // With the steps of rolling feet added up, the floor climbs by 0.3 m.
  const DriftingBody body = body_of(300, sway, foot_that_rolls);
  const RootDrift found = find_root_drift(body.feet, body.hips, {false, true, true});
  double high = 0.0;
  for (const Vector3d& drift : found.drift) high = std::max(high, std::abs(drift.z()));
  EXPECT_LT(high, 0.05);
}

// The noise of the legs explains the slow part of this drift, which therefore remains.
TEST(RootDrift, StatesTheSpeedThatIsLeft) {
  DriftingBody body = body_of(240, sway, resting_foot);
  const DriftRule rule{.jittery = true, .wander = 1.0};
  const RootDrift found = find_root_drift(body.feet, body.hips, rule);
  EXPECT_LT(found.speed_after, 0.02);
  EXPECT_GT(found.speed_left, 0.05);
  for (std::size_t i = 0; i < body.hips.size(); ++i) {
    body.hips[i] -= found.drift[i];
    for (const std::size_t foot : {2 * i, 2 * i + 1}) {
      body.feet.feet[foot].ankle -= found.drift[i];
      body.feet.feet[foot].toe -= found.drift[i];
    }
  }
  EXPECT_NEAR(find_root_drift(body.feet, body.hips, rule).speed_before, found.speed_left, 1e-6);
}

TEST(RootDrift, FindsAVerySlowClimb) {
  const auto climb = [](double seconds) { return Vector3d(0.0, 0.0, 0.005 * seconds); };
  const DriftingBody body = body_of(600, climb, resting_foot);
  EXPECT_TRUE(evidence_of(body).moves());
  const RootDrift found = find_root_drift(body.feet, body.hips);
  EXPECT_NEAR(found.climb_before, 0.1, 0.01);
  EXPECT_NEAR(found.climb_after, 0.0, 0.01);
  EXPECT_TRUE(found.helps());
}

TEST(RootDrift, DoesNotTakeAMissingRootForDrift) {
  // A person walks in place. The height remains, and may bounce.
  const Path bounce = [](double seconds) {
    return Vector3d(0.0, 0.0, 0.08 * std::sin(6.0 * kPi * seconds));
  };
  for (const Path& off : {Path(nowhere), bounce}) {
    DriftingBody missing = body_of(300, off, foot_of_walker);
    for (std::size_t i = 0; i < missing.hips.size(); ++i) {
      const double along = missing.hips[i].x();
      missing.hips[i].x() = 0.0;
      for (std::size_t foot = 0; foot < 2; ++foot) {
        missing.feet.feet[2 * i + foot].ankle.x() -= along;
        missing.feet.feet[2 * i + foot].toe.x() -= along;
      }
    }
    EXPECT_TRUE(root_is_missing(missing.feet, missing.hips));
  }
  for (const Path& off : {Path(nowhere), Path(sway)}) {
    const DriftingBody walking = body_of(300, off, foot_of_walker);
    EXPECT_FALSE(root_is_missing(walking.feet, walking.hips));
    const DriftingBody standing = body_of(300, off, resting_foot);
    EXPECT_FALSE(root_is_missing(standing.feet, standing.hips));
  }
}

TEST(RootDrift, IgnoresBodiesWithoutToes) {
  DriftingBody body = body_of(90, sway, resting_foot);
  body.feet.has_toe = {false, false};
  EXPECT_FALSE(evidence_of(body).moves());
  EXPECT_TRUE(find_root_drift(body.feet, body.hips).drift.empty());
}

TEST(RootDrift, IgnoresFeetOfALyingBody) {
  DriftingBody body = body_of(240, sway, resting_foot);
  body.feet.hips.assign(240, 0.15);
  EXPECT_EQ(evidence_of(body).seconds, 0.0);
  EXPECT_FALSE(evidence_of(body).moves());
}

TEST(RootDrift, FindsSway) {
  const DriftingBody body = body_of(240, sway, foot_of_walker);
  const RootDrift found = find_root_drift(body.feet, body.hips);
  EXPECT_TRUE(found.helps());
  EXPECT_GT(found.speed_before, 0.1);
  EXPECT_LT(found.speed_after, 0.02);
  EXPECT_GT(found.farthest, 0.15);
  EXPECT_LT(farthest_left(body, sway, found), 0.06);
}

TEST(RootDrift, DoesNotChangeACorrectRoot) {
  const DriftingBody body = body_of(240, nowhere, foot_of_walker);
  const RootDrift found = find_root_drift(body.feet, body.hips);
  EXPECT_LT(farthest_left(body, nowhere, found), 0.05);
}

// A step onto a box after half of the clip.
FootPath onto_box(double height) {
  return [height](int foot, double seconds) {
    Vector3d place = resting_foot(foot, seconds);
    const double rise = std::clamp((seconds - 4.0 - 0.5 * foot) / 0.5, 0.0, 1.0);
    place.x() = 0.3 * rise;
    place.z() = height * rise * rise * (3.0 - 2.0 * rise);
    return place;
  };
}

TEST(RootDrift, KeepsAStepAboveTheFloor) {
  const DriftingBody body = body_of(270, sway, onto_box(0.3));
  const RootEvidence evidence = evidence_of(body);
  EXPECT_TRUE(evidence.moves());
  EXPECT_FALSE(evidence.climbs());
  const RootDrift found = find_root_drift(body.feet, body.hips, {false, evidence.climbs()});
  const double rise = body.feet.at(269, 0).toe.z() - found.drift[269].z() -
                      (body.feet.at(0, 0).toe.z() - found.drift[0].z());
  EXPECT_NEAR(rise, 0.3, 1e-9);
  EXPECT_LT(found.speed_after, 0.02);
}

TEST(RootDrift, DoesNotTakeABoxForTheClimbOfFeetThatRoll) {
  const Path shake = shaking(0.03);
  const DriftingBody body = body_of(270, shake, onto_box(0.6));
  const RootDrift found = find_root_drift(body.feet, body.hips, {false, true, false});
  // The box may end up on the floor, but the floor before it does not climb.
  for (const int frame : {30, 60, 90, 110}) {
    const double off = found.drift[static_cast<std::size_t>(frame)].z() - found.drift[0].z() -
                       shake(frame * kDriftFrameTime).z();
    EXPECT_LT(std::abs(off), 0.1) << frame;
  }
}

// Noise of 1.5 cm.
Vector3d root_noise(double seconds) {
  const auto wave = [&](double frequency) { return std::sin(2.0 * kPi * frequency * seconds); };
  return {0.01 * (wave(1.7) + wave(2.9)), 0.01 * (wave(2.3) + wave(3.7)),
          0.01 * (wave(1.3) + wave(3.1))};
}

// Both feet stand for half a second while the hips pass over them, and swing with the hips for
// another half.
DriftingBody body_on_crutches(const Path& off) {
  constexpr double kStride = 0.8;
  const auto foot_at = [](int foot, double seconds) {
    const double whole = std::floor(seconds), swing = std::max(0.0, seconds - whole - 0.5) / 0.5;
    return Vector3d(kStride * (whole + swing), foot == 0 ? 0.1 : -0.1,
                    0.05 * std::sin(kPi * swing));
  };
  DriftingBody body = body_of(300, off, foot_at);
  for (std::size_t i = 0; i < body.hips.size(); ++i) {
    const double seconds = static_cast<double>(i) * kDriftFrameTime;
    body.hips[i].x() = off(seconds).x() + kStride * (seconds - 0.5);
  }
  return body;
}

TEST(RootDrift, KeepsTheWayOfABodyThatCarriesItsFeet) {
  const DriftingBody body = body_on_crutches(root_noise);
  const RootDrift found = find_root_drift(body.feet, body.hips, {true});
  EXPECT_LT(farthest_left(body, root_noise, found), 0.2);
}

TEST(RootDrift, KeepsAClimbWithNoise) {
  // Steps of 0.3 m: the lower foot leaves its step while the upper one stands.
  const auto foot_at = [](int foot, double seconds) {
    Vector3d place = foot_of_walker(foot, 0.5 * seconds);
    place.z() += 0.5 * place.x();
    return place;
  };
  DriftingBody body = body_of(300, root_noise, foot_at);
  for (Vector3d& place : body.hips) place.z() += 0.5 * place.x();
  const RootDrift found = find_root_drift(body.feet, body.hips, {true});
  EXPECT_LT(farthest_left(body, root_noise, found), 0.15);
}

TEST(RootDrift, TurnsWithTheWorld) {
  const auto off = [](double seconds) { return Vector3d(root_noise(seconds) + sway(seconds)); };
  DriftingBody body = body_of(240, off, foot_of_walker);
  const RootDrift found = find_root_drift(body.feet, body.hips);
  const Eigen::AngleAxisd turn(0.2, Vector3d::UnitZ());
  for (SourceFoot& foot : body.feet.feet) {
    foot.ankle = turn * foot.ankle;
    foot.toe = turn * foot.toe;
  }
  for (Vector3d& hips : body.hips) hips = turn * hips;
  const RootDrift turned = find_root_drift(body.feet, body.hips);
  for (std::size_t i = 0; i < found.drift.size(); ++i) {
    EXPECT_LT((turned.drift[i] - turn * found.drift[i]).norm(), 1e-6) << i;
  }
  EXPECT_NEAR(turned.farthest, found.farthest, 1e-6);
}

TEST(RootDrift, ScalesLengthsWithTheBody) {
  DriftingBody body = body_of(240, sway, foot_of_walker);
  const RootDrift usual = find_root_drift(body.feet, body.hips);
  for (SourceFoot& foot : body.feet.feet) {
    foot.ankle *= 0.5;
    foot.toe *= 0.5;
  }
  for (Vector3d& hips : body.hips) hips *= 0.5;
  body.feet.legs = {0.5 * kUsualSourceLeg};
  const RootDrift small = find_root_drift(body.feet, body.hips);
  EXPECT_NEAR(small.farthest, 0.5 * usual.farthest, 1e-9);
}

}  // namespace
}  // namespace retarget
