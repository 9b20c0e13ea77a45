#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "human/human_clip.h"
#include "retarget/human.h"
#include "retarget/robot.h"
#include "robot/visible_shapes.h"
#include "view/svg.h"

namespace retarget {

/// Looks at a body from its right side and a little from the front and from above, without
/// perspective.
struct Camera {
  Eigen::Vector3d right =
      Eigen::Vector3d::UnitX();                   ///< Unit, in the world: on the page to the right,
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< up,
  Eigen::Vector3d nearer = -Eigen::Vector3d::UnitY();  ///< and towards the reader.

  /// @param forward  where the body faces; of no length on the ground: +x.
  [[nodiscard]] static Camera beside(const Eigen::Vector3d& forward);
  /// On the page, metres, y up.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    return {right.dot(point), up.dot(point)};
  }
};

/// Something of one colour that is drawn whole, in front of or behind others.
struct FigurePart {
  struct Piece {
    /// One point: a disc; two: a line with round ends; more: the corners of a convex area in order.
    /// On the page, metres.
    Eigen::Matrix2Xd points;
    double radius = 0.0;  ///< Of disc and line, metres.
    double light = 1.0;   ///< From 0 in the shadow to 1.
  };
  double nearness = 0.0;
  int colour = 0xFFFFFF;
  std::vector<Piece> pieces;
};

/// A body in one pose, from the part farthest away to the nearest.
using Figure = std::vector<FigurePart>;

/// @param qpos  a configuration of the robot's.
[[nodiscard]] Figure robot_figure(const Robot& robot, const std::vector<CollisionShape>& shapes,
                                  std::span<const double> qpos, const Camera& camera);

/// Bones of a human from joint to joint by name; those that a body lacks are skipped.
struct HumanChain {
  Side side = Side::kNone;
  std::vector<std::string> bones;
};

/// What pictures and pages draw a human with.
[[nodiscard]] const std::vector<HumanChain>& human_chains();

/// A bone of a human, or its head, which has no length.
struct HumanLine {
  Eigen::Vector3d from, to;  ///< World, metres.
  double radius = 0.0;       ///< Metres.
  int colour = 0xFFFFFF;
};

/// What a human is drawn with: lines from joint to joint, left and right in colours of their own, and
/// a head.
[[nodiscard]] std::vector<HumanLine> human_lines(const HumanClip& human, int frame);

/// The bones as lines, left and right in colours of their own, and a head.
[[nodiscard]] Figure human_figure(const HumanClip& human, int frame, const Camera& camera);

/// The smallest rectangle that holds a figure; metres.
[[nodiscard]] Eigen::AlignedBox2d extent(const Figure& figure);

/// @param origin  the pixel of the point (0, 0).
/// @param scale   pixels a metre.
void draw(const Figure& figure, const Eigen::Vector2d& origin, double scale, SvgWriter& svg);

}  // namespace retarget
