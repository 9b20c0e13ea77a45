// Robots with all common joint layouts of limbs, compared with the built positions of their
// shoulders, elbows and wrists, hips, knees and ankles.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "formats/bvh/read_bvh.h"
#include "human/skeleton/calibrate.h"
#include "human/skeleton/limb_segments.h"
#include "human/skeleton/recognise.h"
#include "retarget/kinematic_tree.h"
#include "retarget/resample.h"
#include "retarget/so3.h"
#include "robot/anatomy/limbs.h"
#include "robot/anatomy/shapes.h"
#include "solve/robot_setup/derive_config.h"
#include "solve/robot_setup/t_pose.h"
#include "solve/targets/limb_lengths.h"
#include "solve/targets/solve_frames.h"
#include "support/angles.h"
#include "support/built_humanoids.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
namespace fs = std::filesystem;

// A limb layout, with the joints that are acceptable as knee or elbow.
struct LimbSplit {
  std::string what;
  BuiltLimb limb;
  std::vector<std::string> middles;
  double shorter = 0.0;  // Underestimate of the forearm by a run, which ends at the last joint.
};

BuiltLimb arm_of(std::vector<BuiltJoint> joints, const Vector3d& end = {0, 0, -0.15}) {
  BuiltLimb arm;
  arm.joints = std::move(joints);
  arm.end = end;
  return arm;
}

std::vector<LimbSplit> arms() {
  const BuiltJoint pitch{"sp", kAxisY, {0, 0, 0}, -3, 3};
  const BuiltJoint roll{"sr", kAxisX, {0, 0, 0}, -0.3, 2.8};
  const BuiltJoint yaw{"sy", kAxisZ};
  const BuiltJoint elbow{"el", -kAxisY, {0, 0, -0.18}, 0, 2.2};
  const BuiltJoint twist{"tw", kAxisZ};
  const BuiltJoint side{"es", kAxisX, {0, 0, 0}, -0.5, 0.5};
  const auto moved = [](BuiltJoint joint, const Vector3d& at) {
    joint.at = at;
    return joint;
  };
  const Vector3d on_elbow(0, 0, 0);
  std::vector<LimbSplit> all = {
      {"three and one, fixed hand", arm_of({pitch, roll, yaw, elbow}), {"el"}},
      {"two and one", arm_of({pitch, roll, elbow}), {"el"}},
      {"roll, pitch, yaw", arm_of({roll, pitch, yaw, elbow}), {"el"}},
      {"yaw at the elbow",
       arm_of({pitch, roll, moved(yaw, {0, 0, -0.18}), moved(elbow, on_elbow)}),
       {"el"}},
      {"yaw in the upper arm",
       arm_of({pitch, roll, moved(yaw, {0, 0, -0.09}), moved(elbow, {0, 0, -0.09})}),
       {"el"}},
      {"elbow and twist, fixed hand", arm_of({pitch, roll, yaw, elbow, twist}), {"el"}},
      {"elbow of two hinges", arm_of({pitch, roll, elbow, side}), {"el"}},
      {"elbow of two hinges after a yaw", arm_of({pitch, roll, yaw, elbow, side}), {"el"}},
      {"elbow of two hinges, the lesser first",
       arm_of({pitch, roll, moved(side, {0, 0, -0.18}), moved(elbow, on_elbow)}),
       {"el"}},
      {"parallel hinges",
       arm_of({pitch, roll, yaw, elbow, {"e2", -kAxisY, {0, 0, -0.02}, 0, 2.2}}),
       {"el", "e2"}},
      {"twist halfway",
       arm_of({pitch, roll, yaw, elbow, moved(twist, {0, 0, -0.075})}, {0, 0, -0.075}),
       {"el"},
       0.075},
      {"twist halfway and a wrist",
       arm_of({pitch,
               roll,
               yaw,
               elbow,
               moved(twist, {0, 0, -0.075}),
               {"wp", kAxisY, {0, 0, -0.075}},
               {"wr", kAxisX}},
              {0, 0, 0}),
       {"el"}},
      {"elbow of two hinges and a wrist",
       arm_of({pitch, roll, elbow, side, {"wp", kAxisY, {0, 0, -0.15}}, {"wr", kAxisX}}, {0, 0, 0}),
       {"el"}},
      {"one wrist joint",
       arm_of({pitch, roll, yaw, elbow, {"wp", kAxisY, {0, 0, -0.15}}}, {0, 0, 0}),
       {"el"}},
      {"a collar bone",
       arm_of({{"cy", kAxisZ, {0, -0.06, 0}, -0.3, 0.3},
               moved(pitch, {0, 0.06, 0}),
               roll,
               yaw,
               elbow}),
       {"el"}},
  };
  LimbSplit light{"three and one, no hand", arm_of({pitch, roll, yaw, elbow}), {"el"}};
  light.limb.marked = false;
  all.push_back(light);
  LimbSplit turned{"elbow and twist, no hand", arm_of({pitch, roll, yaw, elbow, twist}), {"el"}};
  turned.limb.marked = false;
  all.push_back(turned);
  turned.what = "elbow and twist, neither hand nor mass";
  turned.limb.heavy = false;
  all.push_back(turned);
  // Zero configurations with bent elbows.
  BuiltJoint bent = elbow;
  bent.lower = -1.57;
  bent.upper = 0.8;
  BuiltJoint along = twist;
  along.axis = kAxisX;
  all.push_back({"bent, fixed hand", arm_of({pitch, roll, yaw, bent}, {0.15, 0, 0}), {"el"}});
  all.push_back(
      {"bent, elbow and twist", arm_of({pitch, roll, yaw, bent, along}, {0.15, 0, 0}), {"el"}});
  all.push_back(
      {"bent, yaw and elbow in one place",
       arm_of({pitch, roll, moved(yaw, {0, 0, -0.18}), moved(bent, on_elbow), along}, {0.15, 0, 0}),
       {"el"}});
  return all;
}

std::vector<LimbSplit> legs() {
  const BuiltJoint pitch{"hp", kAxisY}, roll{"hr", kAxisX, {0, 0, 0}, -0.6, 0.8},
      yaw{"hy", kAxisZ, {0, 0, 0}, -1, 1};
  const BuiltJoint knee{"kn", kAxisY, {0, 0, -0.2}, 0, 2.4};
  const BuiltJoint ankle{"ap", kAxisY, {0, 0, -0.25}, -1, 0.8};
  const BuiltJoint tilt{"ar", kAxisX, {0, 0, 0}, -0.4, 0.4};
  const BuiltJoint toe{"to", kAxisY, {0.09, 0, -0.04}, -0.3, 0.6};
  const auto leg = [](std::vector<BuiltJoint> joints, bool has_toe = false) {
    BuiltLimb limb;
    limb.joints = std::move(joints);
    limb.marked = false;
    limb.more = has_toe ? "<geom size=\"0.01\"/>" : plain_leg().more;
    return limb;
  };
  const BuiltJoint lower_knee{"k2", kAxisY, {0, 0, -0.03}, 0, 1.2};
  const BuiltJoint twist{"kt", kAxisZ, {0, 0, 0}, -0.3, 0.3};
  BuiltJoint side = tilt;
  side.at = {0, 0, -0.25};
  BuiltJoint after_side = ankle;
  after_side.at = {0, 0, 0};
  BuiltJoint apart = tilt;
  apart.at = {0, 0, -0.02};
  return {{"pitch, roll, yaw", leg({pitch, roll, yaw, knee, ankle, tilt}), {"kn"}},
          {"yaw, roll, pitch", leg({yaw, roll, pitch, knee, ankle, tilt}), {"kn"}},
          {"two hip joints", leg({roll, pitch, knee, ankle, tilt}), {"kn"}},
          {"parallel knees", leg({pitch, roll, yaw, knee, lower_knee, ankle, tilt}), {"kn", "k2"}},
          {"a knee that twists", leg({pitch, roll, yaw, knee, twist, ankle, tilt}), {"kn"}},
          {"one ankle joint", leg({pitch, roll, yaw, knee, ankle}), {"kn"}},
          {"ankle roll first", leg({pitch, roll, yaw, knee, side, after_side}), {"kn"}},
          {"ankle in two places", leg({pitch, roll, yaw, knee, ankle, apart}), {"kn"}},
          {"toes", leg({pitch, roll, yaw, knee, ankle, tilt, toe}, true), {"kn"}},
          {"toes on one ankle joint", leg({pitch, roll, yaw, knee, ankle, toe}, true), {"kn"}}};
}

// The body of a joint, and the position of a point in it.
struct Marker {
  int body = 0;
  Vector3d place;
};

struct TrueLimb {
  Marker root, middle, end;
};

// Points of a left limb at zero, in the frames of the bodies that carry them.
// @param last  the joint before the knee or elbow, whose body contains the middle
TrueLimb true_limb(const Robot& robot, const BuiltLimb& limb, const std::string& side,
                   const Vector3d& root, const Vector3d& middle, const Vector3d& end,
                   const std::string& last) {
  const double sign = side == "left" ? 1.0 : -1.0;
  const TreeState posed(robot.tree(), robot.zero_configuration());
  const auto marker = [&](const std::string& joint, const Vector3d& place) {
    const int body = robot.find_body(side + "_" + joint).value();
    const Vector3d world(place.x(), sign * place.y(), place.z());
    return Marker{body, posed.world_from_body(body).inverse() * world};
  };
  const std::string first = limb.joints.front().name == "cy" ? "sp" : limb.joints.front().name;
  return {marker(first, root), marker(last, middle), marker(limb.joints.back().name, end)};
}

HumanClip walk() {
  const fs::path source(RETARGET_SOURCE_DIR);
  const auto profiles = load_skeleton_profiles(source / "configs" / "skeletons").value();
  const auto bvh = load_bvh((source / "data" / "walk.bvh").string()).value();
  const auto map = recognise_skeleton(bvh.clip, profiles).value();
  return to_human(resample(cut(bvh.clip, 30, 120), FrameRate{10, 1}).value(),
                  calibrate(bvh.clip, map, {}).value());
}

class LimbSplits : public ::testing::Test {
 protected:
  void expect_found(const BuiltHumanoid& built, const LimbSplit& split, bool is_leg,
                    double lower_tolerance);

  const HumanClip human_ = walk();
};

void LimbSplits::expect_found(const BuiltHumanoid& built, const LimbSplit& split, bool is_leg,
                              double lower_tolerance) {
  const auto& middles = split.middles;
  SCOPED_TRACE((is_leg ? "leg: " : "arm: ") + split.what);
  const auto robot = robot_from_text(built.mjcf());
  const auto limbs = value_of(find_limbs(*robot, "robot.xml"));
  const auto& pair = is_leg ? limbs.legs : limbs.arms;
  const double upper = is_leg ? 0.2 : 0.18, lower = is_leg ? 0.25 : 0.15;
  for (std::size_t side = 0; side < 2; ++side) {
    const std::string name = robot->joints()[pair[side].joints[pair[side].middle]].name;
    EXPECT_NE(std::ranges::find(middles, name.substr(name.find('_') + 1)), middles.end()) << name;
    EXPECT_NEAR(pair[side].upper_length, upper, 0.035);
    EXPECT_NEAR(pair[side].lower_length, lower, lower_tolerance);
  }
  for (const TPoseResidual& residual : solve_t_pose(*robot, limbs).residuals) {
    EXPECT_LT(residual.direction * kDegrees, 12.0) << residual.bone;
  }
  DeriveOptions options;
  options.sole_height = find_shapes(*robot, limbs, {}).ankle_height;
  const auto config = value_of(resolve_config(derive_config(*robot, limbs, options), *robot));
  const auto measured = value_of(robot_limbs(*robot, config));
  if (measured.forearms) {
    EXPECT_NEAR(is_leg ? measured.lengths.leg : measured.lengths.arm, upper + lower - split.shorter,
                lower_tolerance);
  }
  const auto solved = value_of(solve_frames(human_, robot, config, robot->model_limits(), {}));
  // The built positions of the limbs, not the detected ones.
  const BuiltLimb& limb = is_leg ? built.leg : built.arm;
  const Vector3d root = is_leg ? Vector3d(0, 0.1, 0.95) : Vector3d(0, 0.15, 1.4);
  const Vector3d middle = root - upper * kAxisZ;
  const Vector3d end = is_leg               ? Vector3d(middle - lower * kAxisZ)
                       : limb.end.x() > 0.1 ? Vector3d(middle + lower * kAxisX)
                                            : Vector3d(middle - lower * kAxisZ);
  double mean = 0.0;
  for (const Side each : kSides) {
    const std::string side = each == Side::kLeft ? "left" : "right";
    const BuiltJoint* before = nullptr;
    const BuiltJoint* last = &limb.joints.back();
    for (const BuiltJoint& joint : limb.joints) {
      if (joint.name.starts_with("e") || joint.name.starts_with("k")) break;
      before = &joint;
    }
    for (const BuiltJoint& joint : limb.joints) {
      if (joint.name != "to") last = &joint;
    }
    BuiltLimb known = limb;
    known.joints.back() = *last;
    const TrueLimb points = true_limb(*robot, known, side, root, middle, end, before->name);
    std::vector<Pose> world_from_body(robot->bodies().size());
    for (int frame = 0; frame < solved.clip.frame_count(); ++frame) {
      forward_kinematics(*robot, solved.clip.qpos(frame), world_from_body);
      const auto at = [&](const Marker& marker) -> Vector3d {
        return world_from_body[static_cast<std::size_t>(marker.body)] * marker.place;
      };
      const HumanPose& bones = human_.frame(frame);
      const auto bone = [&](LimbBone part) -> Vector3d {
        return bones[side_bone(each, part)].translation;
      };
      const auto angle = [](const Vector3d& a, const Vector3d& b) {
        return kDegrees * angle_between(a, b);
      };
      using enum LimbBone;
      const double thigh = angle(
          at(points.middle) - at(points.root),
          is_leg ? Vector3d(bone(kLeg) - bone(kUpLeg)) : Vector3d(bone(kForeArm) - bone(kArm)));
      const double shin = angle(
          at(points.end) - at(points.middle),
          is_leg ? Vector3d(bone(kFoot) - bone(kLeg)) : Vector3d(bone(kHand) - bone(kForeArm)));
      mean += 0.25 * (thigh + shin) / solved.clip.frame_count();
    }
  }
  EXPECT_LT(mean, 3.0);
}

TEST_F(LimbSplits, MatchArmsOfAllKinds) {
  for (const LimbSplit& split : arms()) {
    BuiltHumanoid built = plain_humanoid();
    built.arm = split.limb;
    // Points without a mark in the model are estimated.
    expect_found(built, split, false, split.limb.marked ? 0.03 : 0.06);
  }
}

TEST_F(LimbSplits, MatchLegsOfAllKinds) {
  for (const LimbSplit& split : legs()) {
    BuiltHumanoid built = plain_humanoid();
    built.leg = split.limb;
    expect_found(built, split, true, 0.035);
  }
}

}  // namespace
}  // namespace retarget
