// The up axis of people who lie down, sit up and get up, from joint positions and rotations.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "formats/smpl/joint_motion.h"
#include "human/doubts.h"
#include "human/skeleton/calibrate.h"
#include "human/skeleton/joint_clip.h"
#include "human/skeleton/recognise.h"
#include "support/normal_numbers.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// Angles in the body's plane, degrees. The trunk leans forward from upright; thighs and arms swing
// forward from hanging; knees and ankles bend.
struct Angles {
  double trunk = 0.0, thigh = 0.0, knee = 3.0, ankle = 0.0, arm = 5.0;

  [[nodiscard]] Angles mixed_with(const Angles& other, double share) const {
    const auto mixed = [share](double a, double b) { return a + share * (b - a); };
    return {mixed(trunk, other.trunk), mixed(thigh, other.thigh), mixed(knee, other.knee),
            mixed(ankle, other.ankle), mixed(arm, other.arm)};
  }
};

constexpr Angles kStand, kCrouch{45.0, 80.0, 110.0, -30.0, 30.0}, kSit{-15.0, 88.0, 10.0, 0.0, 0.0},
    kBack{-90.0, 90.0, 3.0, 20.0, 85.0}, kKneel{0.0, 0.0, 90.0, 45.0, 5.0},
    kFours{80.0, 0.0, 90.0, 45.0, 5.0}, kFront{90.0, -90.0, 3.0, 45.0, 60.0};

struct Script {
  const char* name;
  std::vector<std::pair<double, Angles>> keys;  // Seconds and posture.
};

const std::array kScripts = {
    Script{"stand, sit, lie",
           {{1, kStand}, {2.2, kCrouch}, {3.2, kSit}, {4.5, kBack}, {12, kBack}}},
    Script{"stand, kneel, prone",
           {{1, kStand}, {2.2, kKneel}, {3.4, kFours}, {4.6, kFront}, {12, kFront}}},
    Script{"lie, sit up, lie", {{2, kBack}, {3.5, kSit}, {5, kBack}, {8, kBack}}},
    Script{"lie, get up", {{6, kBack}, {7.2, kSit}, {8.2, kCrouch}, {9.5, kStand}, {10.5, kStand}}},
    Script{"lie on the back", {{6, kBack}}},
    Script{"lie prone", {{6, kFront}}},
};

Angles angles_at(const Script& script, double time) {
  const auto& keys = script.keys;
  Angles now = keys.back().second;
  if (time <= keys.front().first) now = keys.front().second;
  for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
    const auto& [start, from] = keys[i];
    const auto& [end, to] = keys[i + 1];
    if (time < start || time >= end) continue;
    now = from.mixed_with(to, 0.5 - 0.5 * std::cos(M_PI * (time - start) / (end - start)));
  }
  now.trunk += std::sin(1.5 * time);  // Breathing.
  now.arm += 3.0 * std::sin(time);
  return now;
}

// Towards the front from straight down, y up and z ahead.
Vector3d down(double degrees) {
  const double angle = degrees * M_PI / 180.0;
  return {0.0, -std::cos(angle), std::sin(angle)};
}

struct Layout {
  const char* name;
  bool is_smpl;
  bool has_rotations;
};
constexpr std::array kLayouts = {Layout{"positions of SMPL", true, false},
                                 Layout{"positions of Human3.6M", false, false},
                                 Layout{"rotations from a T-pose", true, true}};

// Joints of a body with its ankles above the origin, on a floor at height 0.
std::vector<Vector3d> joints_of(const Angles& angles, bool is_smpl) {
  const Vector3d up = -down(-angles.trunk), left = Vector3d::UnitX();
  const auto trunk = [&](double height, double aside) -> Vector3d {
    return height * up + aside * left;
  };
  const auto leg = [&](double side, int part) -> Vector3d {
    const double shin = angles.thigh - angles.knee;
    Vector3d place = trunk(-0.05, side * 0.09);
    if (part > 0) place += 0.42 * down(angles.thigh);
    if (part > 1) place += 0.41 * down(shin);
    if (part > 2) place += 0.15 * down(shin + 65.0 - angles.ankle);
    return place;
  };
  const auto arm = [&](double side, int part) -> Vector3d {
    Vector3d place = trunk(0.45, side * 0.17);
    if (part > 0) place += 0.28 * (down(angles.arm) + 0.2 * side * left).normalized();
    if (part > 1) place += 0.26 * (down(angles.arm + 12.0) + 0.1 * side * left).normalized();
    return place;
  };
  std::vector<Vector3d> joints;
  if (is_smpl) {
    joints = {trunk(0, 0),    leg(1, 0),      leg(-1, 0),    trunk(0.1, 0),     leg(1, 1),
              leg(-1, 1),     trunk(0.22, 0), leg(1, 2),     leg(-1, 2),        trunk(0.3, 0),
              leg(1, 3),      leg(-1, 3),     trunk(0.5, 0), trunk(0.42, 0.07), trunk(0.42, -0.07),
              trunk(0.62, 0), arm(1, 0),      arm(-1, 0),    arm(1, 1),         arm(-1, 1),
              arm(1, 2),      arm(-1, 2)};
  } else {
    joints = {trunk(0, 0),    leg(-1, 0), leg(-1, 1),     leg(-1, 2),     leg(1, 0),
              leg(1, 1),      leg(1, 2),  trunk(0.22, 0), trunk(0.48, 0), trunk(0.54, 0),
              trunk(0.66, 0), arm(1, 0),  arm(1, 1),      arm(1, 2),      arm(-1, 0),
              arm(-1, 1),     arm(-1, 2)};
  }
  double lowest = 0.0;
  for (const Vector3d& joint : joints) lowest = std::min(lowest, joint.y());
  const Vector3d ankle = leg(1, 2);
  for (Vector3d& joint : joints) joint += Vector3d(0.0, 0.04 - lowest, -ankle.z());
  return joints;
}

Calibration calibrated(const Clip& clip) {
  static const auto profiles =
      load_skeleton_profiles(RETARGET_SOURCE_DIR "/configs/skeletons").value();
  return calibrate(clip, recognise_skeleton(clip, profiles).value(), {}).value();
}

struct Variant {
  double noise;  // Metres.
  double shift;  // Metres, ahead.
  bool z_up;
  std::optional<Vector3d> up = {};  // As the format defines it.
};

Clip lying_clip(const Script& script, const Layout& layout, const Variant& variant) {
  constexpr double kFps = 30.0;
  NormalNumbers normal(7);
  JointMotion motion;
  motion.rate = FrameRate{30, 1};
  motion.up = variant.up;
  motion.frame_count = static_cast<int>(kFps * script.keys.back().first);
  for (int frame = 0; frame < motion.frame_count; ++frame) {
    for (Vector3d place : joints_of(angles_at(script, frame / kFps), layout.is_smpl)) {
      place.z() += variant.shift;
      for (int axis = 0; axis < 3; ++axis) place[axis] += variant.noise * normal.next();
      if (variant.z_up) place = Vector3d(place.x(), -place.z(), place.y());
      motion.positions.push_back(place);
    }
  }
  motion.joint_count = static_cast<int>(motion.positions.size()) / motion.frame_count;
  Clip clip = clip_of_joints(motion, "test").value();
  if (layout.has_rotations) clip.set_origin({});
  return clip;
}

// The axis is correct, or there is a warning; it is correct in most cases.
TEST(LyingDown, IsCorrectOrWarnedAbout) {
  int right = 0, count = 0;
  for (const Script& script : kScripts) {
    for (const Layout& layout : kLayouts) {
      for (const double noise : {0.0, 0.01}) {
        for (const double shift : {-0.6, 0.0, 0.6}) {
          for (const bool z_up : {false, true}) {
            // With Z up, the zero pose along y also states that the body stands.
            if (z_up && layout.has_rotations) continue;
            const Clip clip = lying_clip(script, layout, {noise, shift, z_up});
            const Calibration found = calibrated(clip);
            ++count;
            const bool is_right = found.up == SignedAxis{z_up ? 2 : 1, false};
            right += is_right ? 1 : 0;
            EXPECT_TRUE(is_right || has_doubt(found, OPTION("up")))
                << script.name << ", " << layout.name << ", noise " << noise << ", shift " << shift
                << ": " << to_text(found.up) << " instead of " << (z_up ? "z" : "y");
          }
        }
      }
    }
  }
  EXPECT_GE(10 * right, 8 * count);
}

// A file in HumanML3D's format has y up by definition.
TEST(LyingDown, UsesTheAxisThatTheFormatDefines) {
  for (const Script& script : kScripts) {
    const Clip clip = lying_clip(script, kLayouts[0], {0.0, 0.0, false, Vector3d::UnitY()});
    EXPECT_EQ(to_text(calibrated(clip).up), "+y") << script.name;
  }
}

}  // namespace
}  // namespace retarget
