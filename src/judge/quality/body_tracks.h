#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "retarget/motion.h"
#include "retarget/pose.h"
#include "retarget/robot.h"
#include "robot/model/collision.h"

namespace retarget {

/// Height above the floor from which a sole point is not in contact, metres.
inline constexpr double kSoleHigh = 0.02;

/// Positions of a sole's points in all frames; world, metres.
struct SoleTrack {
  const Sole* sole = nullptr;
  std::vector<Eigen::Vector3d> points;  ///< Frame-major, in the order of Sole::points.

  [[nodiscard]] std::span<const Eigen::Vector3d> at(int frame) const {
    return std::span(points).subspan(frame * sole->points.size(), sole->points.size());
  }
  [[nodiscard]] Eigen::Vector3d middle(int frame) const;  ///< Mean of the points.
  [[nodiscard]] double lowest(int frame) const;           ///< Height of the lowest point.
  [[nodiscard]] double highest(int frame) const;          ///< Height of the highest point.
  /// Whether the foot stands: its lowest sole point is less than kSoleHigh above the floor, and its
  /// middle is slower than 0.25 m/s.
  [[nodiscard]] bool stands(int frame, double fps) const;
};

/// Tracks the soles of a robot's profile over a motion.
[[nodiscard]] std::vector<SoleTrack> track_soles(const RobotClip& clip);

/// The lowest point in a frame and its body.
struct Lowest {
  double height = 0.0;  ///< World z, metres; infinity without points.
  int body = 0;         ///< Index into Robot::bodies().
};

/// The deepest self-collision in a frame.
struct SelfContact {
  double depth = 0.0;          ///< Penetration depth, metres; 0 without a collision.
  int body_a = 0, body_b = 0;  ///< Indices into Robot::bodies().
};

/// Data of a robot's bodies for the metrics of a motion, collected in one pass over the frames.
struct BodyTracks {
  std::vector<SoleTrack> soles;
  std::vector<Lowest> lowest_sole;        ///< Lowest sole point of each frame.
  std::vector<Lowest> lowest;             ///< Lowest point of soles and primitives of each frame.
  std::vector<SelfContact> self_contact;  ///< Exact self-contact of each frame; empty without
                                          ///< primitives.
  /// One entry per step: the deepest penetration half-way between two frames, of two bodies that
  /// move by more than kPassing relative to each other; empty without primitives.
  std::vector<SelfContact> crossings;
  std::vector<double> sampled_depth;  ///< MuJoCo's contact depth in every stride-th frame.
  std::vector<int> kept_bodies;       ///< Bodies whose poses are stored.
  std::vector<Pose> world_from_kept;  ///< Frame-major, one pose per kept body.

  /// World pose of a kept body. @param index  into kept_bodies.
  [[nodiscard]] const Pose& kept(int frame, int index) const {
    return world_from_kept[static_cast<std::size_t>(frame) * kept_bodies.size() + index];
  }
};

/// Collects the body data of a motion.
/// @param kept_bodies  bodies whose poses to store.
/// @param stride       frame stride of sampled_depth; at least 1.
[[nodiscard]] BodyTracks track_bodies(const RobotClip& clip, std::vector<int> kept_bodies,
                                      int stride);

}  // namespace retarget
