#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "human/skeleton/posed_body.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"
#include "support/lafan1_map.h"

namespace retarget {

/// The posture of a body during a whole clip.
enum class Posture : unsigned char {
  kStanding,
  kWalking,
  kSupine,
  kProne,
  kOnSide,
  kReclined,  ///< A straight body, 60 degrees back from upright, as on a slide.
  kSitting,   ///< On the floor, the trunk 60 degrees back from upright, the legs along the floor.
  kCrawling,
  kSwimming,
  kHandstand,
};

inline constexpr std::array kPostures = {Posture::kStanding, Posture::kWalking,  Posture::kSupine,
                                         Posture::kProne,    Posture::kOnSide,   Posture::kReclined,
                                         Posture::kSitting,  Posture::kCrawling, Posture::kSwimming,
                                         Posture::kHandstand};

inline const char* posture_name(Posture posture) {
  constexpr std::array kNames = {"standing", "walking", "supine",   "prone",    "on side",
                                 "reclined", "sitting", "crawling", "swimming", "handstand"};
  return kNames[static_cast<std::size_t>(posture)];
}

/// Whether trunk and legs are upright, so that posture determines the up axis.
inline bool is_upright(Posture posture) {
  return posture == Posture::kStanding || posture == Posture::kWalking;
}

/// Clips of a canonical human in a posture, on a LAFAN1-shaped skeleton.
class PostureClips {
 public:
  /// @param standing  a clip of LAFAN1's joint names and axes; its skeleton is used.
  explicit PostureClips(const Clip& standing)
      : skeleton_(standing.shared_skeleton()),
        calibration_(lafan1_calibration(*skeleton_)),
        human_from_file_(calibration_.human_from_source) {}

  [[nodiscard]] const Calibration& calibration() const { return calibration_; }

  /// @param heading  degrees about the vertical
  [[nodiscard]] Clip make(Posture posture, double heading, int frames = 120) const {
    constexpr double kFps = 30.0, kRadius = 7.0;  // of a limb about its joints, cm
    Clip clip(skeleton_, FrameRate{30, 1}, frames);
    std::vector<Pose> world(static_cast<std::size_t>(skeleton_->joint_count()));
    for (int frame = 0; frame < frames; ++frame) {
      const double t = frame / kFps;
      const Stance body = body_at(posture, t);
      const Eigen::Quaterniond turn(Eigen::AngleAxisd(radians(heading), Eigen::Vector3d::UnitZ()));
      set_rotations(clip, frame, turn, body);
      Eigen::Vector3d& root = clip.translations(frame)[0];
      root = 100.0 * (human_from_file_.transpose() * (turn * body.path));
      forward_kinematics(clip, frame, world);
      double lowest = std::numeric_limits<double>::infinity();
      for (const Pose& joint : world) lowest = std::min(lowest, up().dot(joint.translation));
      if (body.on_floor) root += ((is_upright(posture) ? 2.0 : kRadius) - lowest) * up();
    }
    return clip;
  }

 private:
  using Rotation = Eigen::Quaterniond;

  // Bone rotations from the T-pose in the body's axes, x forward, y left, z up; rotation of the
  // body in the world, for a heading of 0.
  struct Stance {
    Rotation world_from_body = Rotation::Identity();
    Eigen::Vector3d path = Eigen::Vector3d::Zero();  // metres
    bool on_floor = true;
    std::array<double, 2> thigh{}, knee{}, spread{};  // degrees, by side
    std::array<Rotation, 2> arm{Rotation::Identity(), Rotation::Identity()};
    std::array<double, 2> elbow{};
    double ankle = 0.0;  // toes down
    double nod = 0.0, twist = 0.0;
  };

  static double radians(double degrees) { return degrees * M_PI / 180.0; }
  static Rotation about(const Eigen::Vector3d& axis, double degrees) {
    return Rotation(Eigen::AngleAxisd(radians(degrees), axis));
  }
  static Rotation about_x(double degrees) { return about(Eigen::Vector3d::UnitX(), degrees); }
  static Rotation about_y(double degrees) { return about(Eigen::Vector3d::UnitY(), degrees); }
  static Rotation about_z(double degrees) { return about(Eigen::Vector3d::UnitZ(), degrees); }
  [[nodiscard]] Eigen::Vector3d up() const {
    return human_from_file_.transpose() * Eigen::Vector3d::UnitZ();
  }

  // An arm from the T-pose: lowered to hang, then swung ahead.
  static Rotation arm_of(int side, double lowered, double ahead) {
    return about_y(-ahead) * about_x(side == 0 ? -lowered : lowered);
  }

  static Stance body_at(Posture posture, double t) {
    const double slow = std::sin(2.0 * M_PI * 0.3 * t), quick = std::sin(2.0 * M_PI * 0.9 * t);
    Stance body;
    body.nod = 6.0 * slow;
    body.twist = 3.0 * std::sin(2.0 * M_PI * 0.22 * t + 1.0);
    const std::array<double, 2> swing{quick, -quick};
    for (int side = 0; side < 2; ++side) {
      body.spread[side] = side == 0 ? 6.0 : -6.0;
      const double swung = swing[static_cast<std::size_t>(side)];
      auto& arm = body.arm[static_cast<std::size_t>(side)];
      double& thigh = body.thigh[static_cast<std::size_t>(side)];
      double& knee = body.knee[static_cast<std::size_t>(side)];
      double& elbow = body.elbow[static_cast<std::size_t>(side)];
      arm = arm_of(side, 75.0 + 5.0 * slow, 10.0 * swung);
      elbow = 12.0 + 8.0 * swung;
      switch (posture) {
        case Posture::kStanding:
          body.path = {0.01 * slow, 0.012 * quick, 0.9};
          body.world_from_body = about_y(1.0 * slow);
          thigh = 3.0 + 2.0 * slow;
          knee = 2.0 * thigh;
          break;
        case Posture::kWalking:
          body.path = {1.1 * t, 0.02 * quick, 0.9};
          thigh = 5.0 + 22.0 * swung;
          knee = 15.0 + 14.0 * std::cos(2.0 * M_PI * 0.9 * t + M_PI * side);
          arm = arm_of(side, 80.0, -18.0 * swung);
          break;
        case Posture::kSupine:
          body.world_from_body = about_y(-90.0);
          thigh = 6.0 + 4.0 * slow;
          knee = 10.0 + 6.0 * slow;
          body.ankle = 35.0;
          arm = arm_of(side, 65.0 + 10.0 * slow, 4.0);
          break;
        case Posture::kProne:
          body.world_from_body = about_y(90.0);
          thigh = -2.0 + 2.0 * slow;
          knee = 4.0 + 6.0 * (1.0 + swung);
          body.ankle = 55.0;
          arm = arm_of(side, -35.0 + 6.0 * slow, 0.0);
          elbow = 35.0;
          break;
        case Posture::kOnSide:
          body.world_from_body = about_y(-90.0) * about_z(90.0);
          thigh = 35.0 + 6.0 * slow;
          knee = 50.0 + 5.0 * slow;
          body.ankle = 25.0;
          arm = arm_of(side, 80.0, 45.0 + 8.0 * swung);
          elbow = 50.0;
          break;
        case Posture::kReclined:
          body.world_from_body = about_y(-60.0);
          thigh = 6.0 + 3.0 * slow;
          knee = 8.0 + 5.0 * slow;
          body.ankle = 30.0;
          arm = arm_of(side, 70.0 + 8.0 * slow, 10.0);
          break;
        case Posture::kSitting:
          body.world_from_body = about_y(-60.0);
          thigh = 32.0 + 4.0 * slow;
          knee = 6.0 + 4.0 * slow;
          body.ankle = 30.0;
          arm = arm_of(side, 60.0 + 6.0 * slow, -25.0);
          break;
        case Posture::kCrawling:
          body.path = {0.4 * t, 0.0, 0.5};
          body.world_from_body = about_y(82.0);
          thigh = 80.0 + 18.0 * swung;
          knee = 88.0 + 8.0 * swung;
          body.ankle = 50.0;
          arm = arm_of(side, 90.0, 82.0 - 18.0 * swung);
          elbow = 12.0;
          break;
        case Posture::kSwimming:
          body.path = {1.1 * t, 0.0, -0.25};
          body.on_floor = false;
          body.world_from_body = about_y(88.0) * about_z(20.0 * quick);
          thigh = 2.0 + 12.0 * std::sin(2.0 * M_PI * 2.0 * t + M_PI * side);
          knee = 14.0 + 10.0 * std::sin(2.0 * M_PI * 2.0 * t + M_PI * side - 1.0);
          body.ankle = 60.0;
          arm = about_y(-(360.0 * 0.9 * t + 180.0 * side)) * about_x(side == 0 ? -90.0 : 90.0);
          elbow = 15.0;
          break;
        case Posture::kHandstand:
          body.path = {0.02 * slow, 0.02 * quick, 1.0};
          body.world_from_body = about_y(180.0 + 3.0 * slow);
          thigh = 6.0 * swung;
          knee = 6.0 + 4.0 * slow;
          body.ankle = 60.0;
          arm = arm_of(side, -84.0, 3.0 * slow);
          elbow = 4.0;
          break;
      }
    }
    return body;
  }

  // Rotations of a bone from the T-pose, in the body's axes.
  static Rotation turned(const Stance& body, Bone bone) {
    const Rotation trunk = about_z(body.twist);
    const auto part = limb_bone(bone);
    if (!part) {
      if (bone == Bone::kHips) return Rotation::Identity();
      return bone == Bone::kHead ? trunk * about_y(body.nod) : trunk;
    }
    const std::size_t side = side_of(bone) == Side::kLeft ? 0 : 1;
    const Rotation thigh = about_x(body.spread[side]) * about_y(-body.thigh[side]);
    const Rotation shin = thigh * about_y(body.knee[side]);
    const double bend = side == 0 ? -body.elbow[side] : body.elbow[side];
    switch (*part) {
      case LimbBone::kUpLeg:
        return thigh;
      case LimbBone::kLeg:
        return shin;
      case LimbBone::kFoot:
      case LimbBone::kToe:
      case LimbBone::kFootMod:
        return shin * about_y(body.ankle);
      case LimbBone::kShoulder:
        return trunk;
      case LimbBone::kArm:
        return trunk * body.arm[side];
      default:
        // Elbows of arms stretched out sideways bend forward.
        return trunk * body.arm[side] * about_z(bend);
    }
  }

  void set_rotations(Clip& clip, int frame, const Rotation& turn, const Stance& body) const {
    const Rotation file_from_body =
        Rotation(Eigen::Matrix3d(human_from_file_.transpose())) * turn * body.world_from_body;
    std::vector<Rotation> world;
    for (int joint = 0; joint < skeleton_->joint_count(); ++joint) {
      const Bone bone = bone_from_name(skeleton_->joint(joint).name).value();
      world.push_back(file_from_body * turned(body, bone) * Rotation(canonical_t_pose(bone)));
      const int parent = skeleton_->joint(joint).parent;
      clip.rotations(frame)[joint] =
          parent < 0
              ? world.back()
              : (world[static_cast<std::size_t>(parent)].conjugate() * world.back()).normalized();
    }
  }

  std::shared_ptr<const Skeleton> skeleton_;
  Calibration calibration_;
  Eigen::Matrix3d human_from_file_;
};

}  // namespace retarget
