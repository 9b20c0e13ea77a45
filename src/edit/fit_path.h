#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/error.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"

namespace retarget {

/// A chain of cubics over intervals of a parameter, with continuous first derivatives.
struct CubicChain {
  std::vector<double> knots;  ///< Increasing.
  /// One per knot: position in the first row, derivative in the second.
  std::vector<Eigen::Matrix2d> nodes;

  [[nodiscard]] std::size_t piece_of(double parameter) const;
  [[nodiscard]] Eigen::Vector2d at(double parameter) const;
  /// Bezier control points, 3 * segments + 1.
  [[nodiscard]] std::vector<Eigen::Vector2d> control_points() const;
};

/// Fits a path to a human that is already posed.
[[nodiscard]] Result<PathMotion> fit_path(const HumanClip& human, const PathFitOptions& options);

/// Returns the moving frame of a path, per frame of a motion: position, and heading of the tangent,
/// which is continuous. While the body is still, the heading changes smoothly from its value before
/// to its value after, independent of the path there; of the rotations that differ by full turns it
/// uses the one closest to `turns` (one per still phase).
/// @param along  distance along the path, metres, one per frame.
[[nodiscard]] std::vector<GroundPose> path_frames(const GroundPath& path,
                                                  const std::vector<double>& along,
                                                  const std::vector<StillPhase>& still,
                                                  const std::vector<double>& turns);

/// Spreads turns at corners and cusps that are faster than a body can turn (4 rad/s) over the
/// frames before and after, up to a second. All other frames keep their headings.
void spread_turns(std::vector<GroundPose>& frames, const FrameRate& rate);

/// Returns a summary such as `3.2 m in 4 segments`.
[[nodiscard]] std::string path_text(const GroundPath& path);

}  // namespace retarget
