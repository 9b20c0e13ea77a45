#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "retarget/motion.h"
#include "retarget/pose.h"
#include "retarget/robot.h"
#include "robot/model/collision.h"

namespace retarget {

/// A sole point higher than this above the floor is not in contact, metres.
inline constexpr double kSoleHigh = 0.02;

/// World positions of a sole's points in all frames, metres.
struct SoleTrack {
  const Sole* sole = nullptr;
  std::vector<Eigen::Vector3d> points;  ///< Frame-major; the sole's points in each frame.

  [[nodiscard]] std::span<const Eigen::Vector3d> at(int frame) const {
    return std::span(points).subspan(frame * sole->points.size(), sole->points.size());
  }
  [[nodiscard]] Eigen::Vector3d middle(int frame) const;
  [[nodiscard]] double lowest(int frame) const;
  [[nodiscard]] double highest(int frame) const;
  /// Whether the foot stands, judged by its sole only: its lowest point is less than kSoleHigh
  /// above the floor, and its middle is slower than 0.25 m/s.
  [[nodiscard]] bool stands(int frame, double fps) const;
};

/// Tracks the soles of a robot's profile over a motion.
[[nodiscard]] std::vector<SoleTrack> track_soles(const RobotClip& clip);

/// The lowest point in a frame and its body.
struct Lowest {
  double height = 0.0;  ///< World z, metres; infinity if there is none.
  int body = 0;
};

/// The deepest self-collision in a frame.
struct SelfContact {
  double depth = 0.0;  ///< Metres; 0: no collision.
  int body_a = 0, body_b = 0;
};

/// Body data for the metrics of a motion, collected in one pass over the frames.
struct BodyTracks {
  std::vector<SoleTrack> soles;
  std::vector<Lowest> lowest_sole;        ///< By frame.
  std::vector<Lowest> lowest;             ///< By frame, of soles and collision primitives.
  std::vector<SelfContact> self_contact;  ///< By frame, exact; empty without primitives.
  std::vector<double> sampled_depth;      ///< MuJoCo's contact depth, every stride-th frame.
  std::vector<int> kept_bodies;
  std::vector<Pose> world_from_kept;  ///< Frame-major.

  [[nodiscard]] const Pose& kept(int frame, int index) const {
    return world_from_kept[static_cast<std::size_t>(frame) * kept_bodies.size() + index];
  }
};

/// @param kept_bodies  bodies whose poses are needed.
/// @param stride       frame stride of sampled_depth.
[[nodiscard]] BodyTracks track_bodies(const RobotClip& clip, std::vector<int> kept_bodies,
                                      int stride);

}  // namespace retarget
