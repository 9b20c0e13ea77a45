#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "edit/ground_pose.h"
#include "human/human_clip.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"

namespace retarget {

/// How two clouds of points lie best upon each other.
struct CloudAlignment {
  GroundPose a_from_b;    ///< The motion over the ground that brings b's points to a's.
  double distance = 0.0;  ///< Root mean square of what is left between the points.
};

/// The motion over the ground that minimises the sum of w |a - T b|^2 (Kovar, Gleicher, Pighin:
/// Motion Graphs, 2002), in closed form: about the weighted centres, the angle is atan2 of the
/// summed cross and dot products. Heights stay as they are.
/// @param weights  positive, one per point; they are scaled to the sum 1. As many points of each.
[[nodiscard]] CloudAlignment align_clouds(std::span<const Eigen::Vector3d> a,
                                          std::span<const Eigen::Vector3d> b,
                                          std::span<const double> weights);

/// Places of a human's bones, metres, frame by frame.
class PoseClouds {
 public:
  /// @param bones  which the human has.
  PoseClouds(const HumanClip& human, const std::vector<Bone>& bones);

  [[nodiscard]] int frame_count() const { return frame_count_; }
  [[nodiscard]] std::size_t point_count() const { return point_count_; }
  [[nodiscard]] std::span<const Eigen::Vector3d> frame(int index) const {
    return {points_.data() + static_cast<std::size_t>(index) * point_count_, point_count_};
  }
  /// Of frames [begin, end), one after the other.
  [[nodiscard]] std::span<const Eigen::Vector3d> frames(int begin, int end) const {
    return {points_.data() + static_cast<std::size_t>(begin) * point_count_,
            static_cast<std::size_t>(end - begin) * point_count_};
  }

 private:
  int frame_count_;
  std::size_t point_count_;
  std::vector<Eigen::Vector3d> points_;  // frame-major
};

/// Bones that both humans have, without the synthetic feet.
[[nodiscard]] std::vector<Bone> common_bones(const HumanClipInfo& a, const HumanClipInfo& b);

/// Distances between windows of frames: a[i], a[i + 1], ... against b[j], b[j + 1], ...
///
/// A window has `length` frames, or as many as both clips have left. A window that is cut short
/// says too little about velocities; one frame more is then foretold for the clip that ends (by the
/// parabola through its last three) and counts in the distance, not in the alignment.
class WindowDistance {
 public:
  WindowDistance(const PoseClouds& a, const PoseClouds& b, int length);

  [[nodiscard]] int frames_at(int i, int j) const;

  /// What a distance of (i, j) counts in a choice: more by half the share of the window that is
  /// missing there.
  [[nodiscard]] double counted(double distance, int i, int j) const {
    const double missing = 1.0 - frames_at(i, j) / static_cast<double>(length_);
    return distance * (1.0 + 0.5 * missing);
  }
  /// Best alignment of the windows at frame i of a and j of b.
  [[nodiscard]] CloudAlignment at(int i, int j) const;
  /// Distances only, for all of [i_begin, i_end) x [j_begin, j_end), i-major.
  [[nodiscard]] std::vector<float> map(int i_begin, int i_end, int j_begin, int j_end) const;

 private:
  // sums over the points of frames or windows, that the best alignment follows from
  struct CloudSums {
    double x = 0.0, y = 0.0, squares = 0.0;
  };
  struct PairSums {
    double dot = 0.0, cross = 0.0, rise = 0.0;
  };
  static std::vector<CloudSums> sums_of(const PoseClouds& clouds);
  [[nodiscard]] PairSums pair(int i, int j) const;
  [[nodiscard]] CloudAlignment from_sums(const PairSums& sums, int i, int j, int frames) const;
  [[nodiscard]] double with_foretold(int i, int j, const CloudAlignment& aligned) const;

  const PoseClouds& a_;
  const PoseClouds& b_;
  int length_;
  std::vector<CloudSums> sums_a_, sums_b_;  // per frame
};

}  // namespace retarget
