#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "retarget/motion.h"
#include "retarget/pose.h"
#include "robot/collision.h"

namespace retarget {

/// A sole point this far above the floor is off it, metres.
inline constexpr double kSoleHigh = 0.02;

/// Where the points of a sole are in every frame; world, metres.
struct SoleTrack {
  const Sole* sole = nullptr;
  std::vector<Eigen::Vector3d> points;  ///< Frame-major, as many a frame as the sole has.

  [[nodiscard]] std::span<const Eigen::Vector3d> at(int frame) const {
    return std::span(points).subspan(frame * sole->points.size(), sole->points.size());
  }
  [[nodiscard]] Eigen::Vector3d middle(int frame) const;
  [[nodiscard]] double lowest(int frame) const;
  [[nodiscard]] double highest(int frame) const;
  /// Whether the foot stands, by its sole alone: its lowest point is less than kSoleHigh above the
  /// floor, and its middle slower than 0.25 m/s.
  [[nodiscard]] bool stands(int frame, double fps) const;
};

/// The soles of a robot's profile over a motion.
[[nodiscard]] std::vector<SoleTrack> track_soles(const RobotClip& clip);

/// The lowest of something in a frame.
struct Lowest {
  double height = 0.0;  ///< World z, metres; infinity: there is none.
  int body = 0;
};

/// How deep the robot is in itself in a frame.
struct SelfContact {
  double depth = 0.0;  ///< Metres; 0: it is not.
  int body_a = 0, body_b = 0;
};

/// What a motion's metrics need of the bodies, gathered in one walk over the frames.
struct BodyTracks {
  std::vector<SoleTrack> soles;
  std::vector<Lowest> lowest_sole;        ///< Per frame.
  std::vector<Lowest> lowest;             ///< Of soles and primitives.
  std::vector<SelfContact> self_contact;  ///< Per frame, exact; empty: the robot has no primitives.
  std::vector<double> sampled_depth;      ///< Every so-manieth frame, MuJoCo's contact depth.
  std::vector<int> kept_bodies;
  std::vector<Pose> world_from_kept;  ///< Frame-major.

  [[nodiscard]] const Pose& kept(int frame, int index) const {
    return world_from_kept[static_cast<std::size_t>(frame) * kept_bodies.size() + index];
  }
};

/// @param kept_bodies  those whose poses are wanted.
/// @param stride       of sampled_depth.
[[nodiscard]] BodyTracks track_bodies(const RobotClip& clip, std::vector<int> kept_bodies,
                                      int stride);

}  // namespace retarget
