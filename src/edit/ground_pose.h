#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"
#include "retarget/pose.h"

namespace retarget {

/// Returns true if a joint has three position and three rotation channels.
[[nodiscard]] bool moves_freely(const Joint& joint);

/// Returns the pose of a joint in a frame, in the file's world; joint -1 is the world itself.
[[nodiscard]] Pose world_from_joint(const Clip& clip, int frame, int joint);

/// Moves the whole body in single frames, in the canonical human's world. Changes only the channels
/// of one joint: the first one between root and hips with free translation and rotation that moves
/// in this clip. (A root that stays fixed above moving hips is only a reference frame.)
class BodyMover {
 public:
  /// @param with  another clip of the same skeleton that will be moved by the same joint.
  /// @return a kInput error if no joint moves the body as a whole.
  [[nodiscard]] static Result<BodyMover> of(const Clip& clip, const Calibration& calibration,
                                            const Clip* with = nullptr);

  /// @param move  motion in the world, metres, z up.
  void move(Clip& clip, int frame, const Pose& move) const;
  void move(Clip& clip, int frame, const GroundPose& over_ground) const {
    move(clip, frame, over_ground.in_space());
  }
  void move_all(Clip& clip, const Pose& over_all) const;

 private:
  BodyMover(int joint, const Calibration& calibration);

  int joint_;
  double metres_per_unit_;
  Eigen::Quaterniond human_from_source_;
};

/// Returns the rotation about the vertical (twist), radians; nothing if close to upside down.
[[nodiscard]] std::optional<double> heading_of(const Eigen::Quaterniond& turn);

/// Returns the ground position of the hips in every frame. The heading is the hips' rotation about
/// the vertical (twist) relative to the canonical T-pose facing x; it is continuous from frame to
/// frame, also across full turns.
[[nodiscard]] std::vector<GroundPose> hips_over_ground(const HumanClip& human);

/// Best alignment of two point clouds.
struct CloudAlignment {
  GroundPose a_from_b;    ///< Motion over the ground that maps b's points to a's.
  double distance = 0.0;  ///< Root mean square distance between the aligned points.
};

/// Computes the motion over the ground that minimises the sum of w |a - T b|^2 (Kovar, Gleicher,
/// Pighin: Motion Graphs, 2002), in closed form: about the weighted centres, the angle is atan2 of
/// the summed cross and dot products. Heights do not change.
/// @param a, b     clouds with equal numbers of points.
/// @param weights  positive, one per point; normalised to the sum 1.
[[nodiscard]] CloudAlignment align_clouds(std::span<const Eigen::Vector3d> a,
                                          std::span<const Eigen::Vector3d> b,
                                          std::span<const double> weights);

/// Bone positions of a human per frame, metres.
class PoseClouds {
 public:
  /// @param bones  all must exist in the human.
  PoseClouds(const HumanClip& human, const std::vector<Bone>& bones);

  [[nodiscard]] int frame_count() const { return frame_count_; }
  [[nodiscard]] std::size_t point_count() const { return point_count_; }
  [[nodiscard]] std::span<const Eigen::Vector3d> frame(int index) const {
    return {points_.data() + static_cast<std::size_t>(index) * point_count_, point_count_};
  }
  /// Returns the points of frames [begin, end), consecutively.
  [[nodiscard]] std::span<const Eigen::Vector3d> frames(int begin, int end) const {
    return {points_.data() + static_cast<std::size_t>(begin) * point_count_,
            static_cast<std::size_t>(end - begin) * point_count_};
  }

 private:
  int frame_count_;
  std::size_t point_count_;
  std::vector<Eigen::Vector3d> points_;  // Frame-major.
};

/// Returns the bones that both humans have, except the synthetic feet.
[[nodiscard]] std::vector<Bone> common_bones(const HumanClipInfo& a, const HumanClipInfo& b);

/// Distances between windows of frames: a[i], a[i + 1], ... against b[j], b[j + 1], ...
///
/// A window has `length` frames, or as many as both clips have left. A truncated window contains
/// too little information on velocities. Therefore one more frame is predicted for the clip that
/// ends (by the parabola through its last three frames); it affects the distance but not the
/// alignment.
class WindowDistance {
 public:
  WindowDistance(const PoseClouds& a, const PoseClouds& b, int length);

  [[nodiscard]] int frames_at(int i, int j) const;

  /// Returns the distance of (i, j) with a penalty for truncated windows: half the missing fraction
  /// of the window is added.
  [[nodiscard]] double counted(double distance, int i, int j) const {
    const double missing = 1.0 - frames_at(i, j) / static_cast<double>(length_);
    return distance * (1.0 + 0.5 * missing);
  }
  /// Returns the best alignment of the windows at frame i of a and j of b.
  [[nodiscard]] CloudAlignment at(int i, int j) const;
  /// Computes only the distances, for all of [i_begin, i_end) x [j_begin, j_end), i-major.
  [[nodiscard]] std::vector<float> map(int i_begin, int i_end, int j_begin, int j_end) const;

 private:
  // Sums over the points of frames or windows that determine the best alignment.
  struct CloudSums {
    double x = 0.0, y = 0.0, squares = 0.0;
  };
  struct PairSums {
    double dot = 0.0, cross = 0.0, rise = 0.0;
  };
  static std::vector<CloudSums> sums_of(const PoseClouds& clouds);
  [[nodiscard]] PairSums pair(int i, int j) const;
  [[nodiscard]] CloudAlignment from_sums(const PairSums& sums, int i, int j, int frames) const;
  [[nodiscard]] double with_predicted_frame(int i, int j, const CloudAlignment& aligned) const;

  const PoseClouds& a_;
  const PoseClouds& b_;
  int length_;
  std::vector<CloudSums> sums_a_, sums_b_;  // Per frame.
};

}  // namespace retarget
