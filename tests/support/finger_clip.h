#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "human/skeleton/source_hands.h"
#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// Returns the name of a finger joint from side (0: left), finger and bone (from 1).
using FingerNaming = std::function<std::string(int side, Finger finger, int bone)>;

/// `LeftHandIndex1`, as in Mixamo and similar skeletons.
inline std::string mixamo_name(int side, Finger finger, int bone) {
  constexpr std::array kNames = {"Thumb", "Index", "Middle", "Ring", "Pinky"};
  return std::string(side == 0 ? "Left" : "Right") + "Hand" +
         kNames[static_cast<std::size_t>(finger)] + std::to_string(bone);
}

/// Hands on a body that only has hips and wrists: y up, palms down, thumbs forwards (z), left hand
/// at +x. Centimetres. A finger has three bones; the last one has an end site on request.
class FingerClip {
 public:
  explicit FingerClip(int frames, const FingerNaming& name = mixamo_name, bool ends = true)
      : clip_(make_skeleton(name, ends), FrameRate{30, 1}, frames) {
    for (std::size_t side = 0; side < 2; ++side) {
      map_.joint_of_bone[side_bone(kSides[side], LimbBone::kHand)] = wrist(side);
    }
  }

  [[nodiscard]] const Clip& clip() const { return clip_; }
  [[nodiscard]] const BoneMap& map() const { return map_; }
  [[nodiscard]] SourceHands hands() const { return find_source_hands(clip_.skeleton(), map_); }

  /// Bends a finger's joints towards the palm, radians.
  void bend(int frame, std::size_t side, Finger finger, const std::array<double, 3>& by) {
    const double sign = side == 0 ? -1.0 : 1.0;
    for (int bone = 0; bone < 3; ++bone) {
      turn(frame, side, finger, bone,
           sign * by[static_cast<std::size_t>(bone)] * Eigen::Vector3d::UnitZ());
    }
  }
  /// Sets the rotation vector of a joint, bones from 0; mirrored for the right hand.
  void turn(int frame, std::size_t side, Finger finger, int bone, const Eigen::Vector3d& by) {
    const auto joint =
        static_cast<std::size_t>(wrist(side) + 1 + 3 * static_cast<int>(finger) + bone);
    const double angle = by.norm();
    clip_.rotations(frame)[joint] = angle == 0.0
                                        ? Eigen::Quaterniond::Identity()
                                        : Eigen::Quaterniond(Eigen::AngleAxisd(angle, by / angle));
  }
  /// Makes a fist: 80, 95 and 50 degrees, with the thumb across.
  void make_fist(int frame, std::size_t side) {
    for (const Finger finger : kFingers) {
      if (finger != Finger::kThumb) bend(frame, side, finger, {1.40, 1.66, 0.87});
    }
    const double mirror = side == 0 ? 1.0 : -1.0;
    for (int bone = 0; bone < 3; ++bone) {
      turn(frame, side, Finger::kThumb, bone,
           mirror * Eigen::Vector3d(0.0, bone == 0 ? 0.3 : 0.6, -0.3));
    }
  }
  /// Pinches thumb and finger; the tips are `apart` finger lengths from each other.
  void pinch(int frame, std::size_t side, Finger finger, double apart = 0.17) {
    bend(frame, side, finger, {0.75, 0.75, 0.35});
    const SourceHands found = hands();
    HandPoser poser(clip_, *found[side]);
    HandShape shape;
    // Angles about y and z: two for each of the first two joints, one for the last.
    std::array<double, 5> x{};
    const auto put = [&] {
      const double mirror = side == 0 ? 1.0 : -1.0;
      turn(frame, side, Finger::kThumb, 0, mirror * Eigen::Vector3d(0.0, x[0], x[1]));
      turn(frame, side, Finger::kThumb, 1, mirror * Eigen::Vector3d(0.0, x[2], x[3]));
      turn(frame, side, Finger::kThumb, 2, mirror * Eigen::Vector3d(0.0, x[4], 0.0));
      poser.shape(frame, shape);
      const FingerLine& line = shape.line(finger);
      const double off =
          (line.tip() - shape.line(Finger::kThumb).tip()).norm() / line.length - apart;
      double sum = off * off;
      for (const double angle : x) sum += 1e-6 * angle * angle;
      return sum;
    };
    double best = put();
    for (double step = 0.2; step > 1e-5; step *= 0.7) {
      for (double& angle : x) {
        for (const double sign : {1.0, -1.0}) {
          const double before = std::exchange(angle, angle + sign * step);
          const double now = put();
          now < best ? best = now : angle = before;
        }
      }
    }
    put();
  }

 private:
  static int wrist(std::size_t side) { return side == 0 ? 1 : 17; }

  static std::shared_ptr<const Skeleton> make_skeleton(const FingerNaming& name, bool ends) {
    // By Finger: knuckle position (forwards, to the thumb's side, out of the palm), then bone
    // lengths; centimetres.
    constexpr std::array<std::array<double, 6>, 5> kSizes = {{{2.5, 2.2, 1.2, 4.6, 3.2, 2.6},
                                                              {9.0, 2.5, 0.0, 4.0, 2.3, 2.0},
                                                              {9.2, 0.5, 0.0, 4.5, 2.7, 2.1},
                                                              {8.5, -1.4, 0.0, 4.1, 2.6, 2.1},
                                                              {7.8, -3.2, 0.0, 3.3, 1.8, 2.0}}};
    std::vector<Joint> joints;
    const auto add = [&](const std::string& joint, int parent, const Eigen::Vector3d& offset) {
      joints.push_back({joint, parent, offset, {}, {}});
      return static_cast<int>(joints.size()) - 1;
    };
    add("Hips", -1, Eigen::Vector3d::Zero());
    for (int side = 0; side < 2; ++side) {
      const double x = side == 0 ? 1.0 : -1.0;
      const int hand = add(side == 0 ? "LeftHand" : "RightHand", 0, {60.0 * x, 40.0, 0.0});
      for (const Finger finger : kFingers) {
        const auto& size = kSizes[static_cast<std::size_t>(finger)];
        const Eigen::Vector3d way = finger == Finger::kThumb
                                        ? Eigen::Vector3d(0.75 * x, -0.35, 0.55).normalized()
                                        : Eigen::Vector3d(x, 0.0, 0.0);
        int parent = add(name(side, finger, 1), hand, {size[0] * x, -size[2], size[1]});
        parent = add(name(side, finger, 2), parent, size[3] * way);
        parent = add(name(side, finger, 3), parent, size[4] * way);
        if (ends) joints.back().end_sites = {size[5] * way};
      }
    }
    return std::make_shared<const Skeleton>(std::move(joints));
  }

  Clip clip_;
  BoneMap map_;
};

}  // namespace retarget
