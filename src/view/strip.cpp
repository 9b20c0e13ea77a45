#include "retarget/view.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "retarget/robot.h"
#include "retarget/text.h"
#include "view/figure.h"
#include "view/strip_frames.h"
#include "view/svg.h"

namespace retarget {
namespace {

constexpr double kRowHeight = 220.0;  // Height of the tallest figure, pixels.
constexpr double kGap = 12.0;
constexpr double kLabelHeight = 20.0;
constexpr const char* kFloorColour = "#b0b0b0";

// Figures next to each other on one floor.
struct Row {
  std::vector<Figure> figures;  // Each with its body's ground position at the origin.
  Eigen::AlignedBox2d box;

  void add(Figure figure) {
    if (!figure.empty()) box.extend(extent(figure));
    figures.push_back(std::move(figure));
  }
  [[nodiscard]] double height() const { return box.isEmpty() ? 0.0 : box.sizes().y(); }
};

// Moves a figure so that a ground point is at the origin.
Figure placed(Figure figure, const Camera& camera, const Eigen::Vector3d& body) {
  const Eigen::Vector2d ground = camera.project({body.x(), body.y(), 0.0});
  for (FigurePart& part : figure) {
    for (FigurePart::Piece& piece : part.pieces) piece.points.colwise() -= ground;
  }
  return figure;
}

// Draws a row below `top` and returns its bottom.
// @param body  height of the tallest figures, metres.
double draw_row(const Row& row, double top, double cell, double scale, double body,
                SvgWriter& svg) {
  const RowHeights heights = row_heights(row.box, body);
  const double floor = top + heights.high * scale;
  const double width = cell * static_cast<double>(row.figures.size());
  if (heights.has_floor) svg.stroke({kGap, floor}, {width - kGap, floor}, 1.5, kFloorColour);
  const double shift = row.box.center().x() * scale;
  for (std::size_t i = 0; i < row.figures.size(); ++i) {
    draw(row.figures[i], {cell * (static_cast<double>(i) + 0.5) - shift, floor}, scale, svg);
  }
  return floor + -heights.low * scale;
}

}  // namespace

std::string draw_strip(const RobotClip& motion, const HumanClip* human,
                       const StripOptions& options) {
  const std::vector<int> frames = spread_frames(motion.frame_count(), options.poses);
  const Camera camera = Camera::beside(facing(motion, frames));
  const std::vector<CollisionShape> shapes = visible_shapes(motion.robot());
  Row robots, humans;
  for (const int frame : frames) {
    const auto q = motion.qpos(frame);
    robots.add(placed(robot_figure(motion.robot(), shapes, q, camera), camera, {q[0], q[1], q[2]}));
    if (human == nullptr) continue;
    if (frame >= human->frame_count) {
      humans.add({});
      continue;
    }
    humans.add(placed(human_figure(*human, frame, camera), camera,
                      human->frame(frame)[Bone::kHips].translation));
  }

  const double body = std::max({robots.height(), humans.height(), 1e-3});
  const double scale = kRowHeight / body;
  double widest = robots.box.sizes().x();
  if (!humans.box.isEmpty()) widest = std::max(widest, humans.box.sizes().x());
  const double cell = widest * scale + kGap;
  SvgWriter svg;
  double bottom = kGap;
  if (!humans.box.isEmpty()) bottom = draw_row(humans, bottom, cell, scale, body, svg) + kGap;
  bottom = draw_row(robots, bottom, cell, scale, body, svg);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    svg.label({cell * (static_cast<double>(i) + 0.5), bottom + kLabelHeight - 4.0},
              number_text(motion.rate().time_of(frames[i]), 2) + " s");
  }
  const double width = cell * static_cast<double>(frames.size());
  return svg.finish({width, bottom + kLabelHeight + kGap}, options.title);
}

}  // namespace retarget
