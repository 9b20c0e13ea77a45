#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/pose.h"

namespace RETARGET_API retarget {

/// A position on the ground and a heading, or equivalently the planar rigid motion p -> Rz(heading)
/// p + position. Coordinates refer to the canonical human's world: metres, x and y on the ground, z
/// up. For a y-up file, x is the file's x and y is its -z.
struct GroundPose {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double heading = 0.0;  ///< Radians from x towards y.

  [[nodiscard]] GroundPose inverse() const;
  /// The rigid motion in space, metres.
  [[nodiscard]] Pose in_space() const;
};

[[nodiscard]] GroundPose operator*(const GroundPose& a, const GroundPose& b);
[[nodiscard]] Eigen::Vector2d operator*(const GroundPose& pose, const Eigen::Vector2d& point);

/// The rotation about a point on the ground; the angle is in radians.
[[nodiscard]] GroundPose turn_about(const Eigen::Vector2d& point, double angle);

/// A curve on the ground: a chain of cubic Bezier segments, parametrised by arc length. Coordinates
/// are in metres in the canonical human's world.
class GroundPath {
 public:
  /// @pre 3n + 1 finite points, n >= 1; neighbouring segments share an end point.
  explicit GroundPath(std::vector<Eigen::Vector2d> control_points);

  [[nodiscard]] const std::vector<Eigen::Vector2d>& control_points() const { return points_; }
  [[nodiscard]] std::size_t segment_count() const { return (points_.size() - 1) / 3; }
  [[nodiscard]] double length() const { return lengths_.back(); }

  /// Position and heading of the tangent, in (-pi, pi], after `along` metres. The path continues
  /// straight before its beginning and after its end. If control points coincide, so that a
  /// derivative vanishes, the neighbouring points give the tangent; for a path of zero length the
  /// tangent is x.
  [[nodiscard]] GroundPose at(double along) const;

  /// Arc length, metres, from the beginning to parameter u of a segment, 0 <= u <= 1.
  [[nodiscard]] double length_to(std::size_t segment, double u) const;

  /// The path after a rigid motion on the ground.
  [[nodiscard]] GroundPath moved(const GroundPose& move) const;
  /// The path scaled about its beginning.
  [[nodiscard]] GroundPath scaled(double scale) const;

 private:
  [[nodiscard]] Eigen::Vector2d point(std::size_t segment, double u) const;
  [[nodiscard]] Eigen::Vector2d derivative(std::size_t segment, double u) const;
  [[nodiscard]] Eigen::Vector2d direction(std::size_t segment, double u) const;
  [[nodiscard]] double length_between(std::size_t segment, double from, double to) const;
  [[nodiscard]] GroundPose straight_on(std::size_t segment, double u, double beyond) const;

  std::vector<Eigen::Vector2d> points_;
  std::vector<double> lengths_;  // arc length at each subdivision of each segment
};

/// A straight line from a pose, along its heading.
[[nodiscard]] GroundPath line_path(const GroundPose& start, double length);
/// An arc of the given length on a circle to the left of the start, or to the right for a negative
/// radius.
/// @pre radius is not 0
[[nodiscard]] GroundPath circle_path(const GroundPose& start, double radius, double length);
/// A circle to the left and one to the right that touch at the start, each half the length.
[[nodiscard]] GroundPath figure8_path(const GroundPose& start, double length);
/// A smooth curve through points. Tangents are Catmull-Rom's, limited in length by the distance to
/// the nearer neighbour. Points that coincide with the previous one are skipped.
/// @pre at least one point
[[nodiscard]] GroundPath path_through(const std::vector<Eigen::Vector2d>& points);

/// Reads `{"control_points": [[x, y], ...]}` (3n + 1 points of n Bezier segments) or
/// `{"waypoints": [[x, y], ...]}` (path_through). Other members are ignored.
/// @return kConfig errors if the text is malformed.
[[nodiscard]] Result<GroundPath> parse_path(std::string_view text, const std::string& file);
[[nodiscard]] Result<GroundPath> load_path(const std::string& path);
/// The path as JSON; reading it gives exactly the same numbers.
[[nodiscard]] std::string format_path(const GroundPath& path);

}  // namespace retarget
