#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/human.h"
#include "retarget/robot.h"

namespace retarget {

/// Assembles an SVG drawing. Coordinates in pixels, x right, y down, rounded to a tenth of a pixel.
class SvgWriter {
 public:
  /// Draws a line with round ends; a line of zero length is a disc.
  void stroke(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double width,
              std::string_view colour);
  /// Fills a convex area.
  /// @param corners    corners in order, as columns.
  /// @param rim        width of an outline with round corners in the same colour; 0: none.
  void area(const Eigen::Matrix2Xd& corners, std::string_view colour, double rim);
  /// @param text  any text; it is escaped.
  void label(const Eigen::Vector2d& middle, std::string_view text);

  /// Returns the whole file; `title` may be empty.
  [[nodiscard]] std::string finish(const Eigen::Vector2d& size, std::string_view title) const;

 private:
  std::string text_;
};

/// Orthographic camera that looks at a body from its right side, slightly from the front and from
/// above.
struct Camera {
  Eigen::Vector3d right =
      Eigen::Vector3d::UnitX();                   ///< Unit vector in the world: right on the page.
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< Unit vector in the world: up on the page.
  Eigen::Vector3d nearer = -Eigen::Vector3d::UnitY();  ///< Unit vector in the world: towards the
                                                       ///< viewer.

  /// @param forward  the body's facing direction; +x if its horizontal part is zero.
  [[nodiscard]] static Camera beside(const Eigen::Vector3d& forward);
  /// Projects to the page, metres, y up.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    return {right.dot(point), up.dot(point)};
  }
};

/// A single-coloured part that is drawn as a whole, in depth order.
struct FigurePart {
  struct Piece {
    /// Points on the page, metres. One point: a disc; two: a line with round ends; more: the
    /// corners of a convex area in order.
    Eigen::Matrix2Xd points;
    double radius = 0.0;  ///< Radius of disc or line, metres.
    double light = 1.0;   ///< Brightness from 0 (shadow) to 1.
  };
  double nearness = 0.0;
  int colour = 0xFFFFFF;
  std::vector<Piece> pieces;
};

/// A body in one pose; parts are sorted from far to near.
using Figure = std::vector<FigurePart>;

/// @param qpos  a configuration of the robot.
[[nodiscard]] Figure robot_figure(const Robot& robot, const std::vector<CollisionShape>& shapes,
                                  std::span<const double> qpos, const Camera& camera);

/// A chain of human bones, by name; bones that a human lacks are skipped.
struct HumanChain {
  Side side = Side::kNone;
  std::vector<std::string> bones;
};

/// Returns the chains that represent humans in renderings and pages.
[[nodiscard]] const std::vector<HumanChain>& human_chains();

/// A bone of a human, or its head, which has zero length.
struct HumanLine {
  Eigen::Vector3d from, to;  ///< World frame, metres.
  double radius = 0.0;       ///< Metres.
  int colour = 0xFFFFFF;
};

/// Returns the lines that represent a human: from joint to joint, with separate colours for left
/// and right, and a head.
[[nodiscard]] std::vector<HumanLine> human_lines(const HumanClip& human, int frame);

/// Draws a human as bones with separate colours for left and right, and a head.
[[nodiscard]] Figure human_figure(const HumanClip& human, int frame, const Camera& camera);

/// Returns the bounding box of a figure on the page, metres.
[[nodiscard]] Eigen::AlignedBox2d extent(const Figure& figure);

/// Draws a figure.
/// @param origin  the pixel of the point (0, 0).
/// @param scale   pixels per metre.
void draw(const Figure& figure, const Eigen::Vector2d& origin, double scale, SvgWriter& svg);

}  // namespace retarget
