#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "retarget/motion.h"
#include "retarget/robot.h"
#include "retarget/root_pose.h"
#include "retarget/text.h"
#include "retarget/view.h"
#include "view/figure.h"
#include "view/image.h"
#include "view/page_data.h"
#include "view/render.h"

namespace retarget {
namespace {

// Returns the evenly spaced frames from the first to the last.
// @param poses  at least one; limited to the number of frames.
std::vector<int> spread_frames(int frame_count, int poses) {
  const int count = std::clamp(poses, 1, frame_count);
  std::vector<int> frames;
  for (int i = 0; i < count; ++i) {
    frames.push_back(count == 1 ? 0
                                : static_cast<int>(static_cast<std::int64_t>(frame_count - 1) * i /
                                                   (count - 1)));
  }
  return frames;
}

// Returns the mean facing direction in these frames, not normalised; x is forward in every robot's
// root.
Eigen::Vector3d facing(const RobotClip& motion, const std::vector<int>& frames) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int frame : frames) {
    sum += root_rotation(motion.qpos(frame)).normalized() * Eigen::Vector3d::UnitX();
  }
  return sum;
}

// Vertical extent of a strip row, metres above the floor.
struct RowHeights {
  double low = 0.0, high = 0.0;
  bool has_floor = true;  // True if 0 lies within the extent.
};

// Extends a row to the floor if the floor is no farther from the figures than `body`. Otherwise
// shows only the figures, so that the picture's height does not depend on the motion's position in
// the world.
// @param figures  bounding box of the row; not empty.
// @param body     height of the tallest row's figures, metres.
RowHeights row_heights(const Eigen::AlignedBox2d& figures, double body) {
  const double low = figures.min().y(), high = figures.max().y();
  if (low > body || high < -body) return {low, high, false};
  return {std::min(0.0, low), std::max(0.0, high), true};
}

constexpr int kPaper = 0xFFFFFF, kInk = 0x606060;
constexpr double kBetween = 0.12;  // Gap between figures, relative to the tallest one.
constexpr double kMargin = 0.05;   // Margin above and below them, likewise.
constexpr double kMinSize = 0.05;  // Metres; minimum size of figures without extent.

// Figures next to each other on one floor, each with its body's ground position at the origin.
struct SolidRow {
  std::vector<SolidFigure> figures;
  Eigen::AlignedBox2d box;

  void add(SolidFigure figure, const Eigen::Vector3d& body, const Camera& camera) {
    shift(figure, {-body.x(), -body.y(), 0.0});
    if (!figure.empty()) box.extend(extent(figure, camera));
    figures.push_back(std::move(figure));
  }
  [[nodiscard]] double width() const { return box.isEmpty() ? 0.0 : box.sizes().x(); }
  [[nodiscard]] double height() const { return box.isEmpty() ? 0.0 : box.sizes().y(); }
};

// Position of a row in the picture, pixels.
struct RowPlace {
  int top = 0, height = 0;
  double floor = 0.0;
};

// @param body  height of the tallest row's figures, metres.
RowPlace place_row(const SolidRow& row, int top, double scale, double margin, double body) {
  const RowHeights heights = row_heights(row.box, body);
  const double above = heights.high * scale + margin;
  const double below = -heights.low * scale + margin;
  // Bounds the height, also far from the origin, where numbers are coarse: the figures plus an
  // equal distance to the floor.
  const double most = 2.0 * (body * scale + margin);
  return {top, static_cast<int>(std::ceil(std::min(above + below, most))), top + above};
}

void draw_row(const SolidRow& row, const RowPlace& place, double cell, double scale,
              const Camera& camera, Image& image) {
  const double shift = row.box.center().x() * scale;
  for (std::size_t i = 0; i < row.figures.size(); ++i) {
    if (row.figures[i].empty()) continue;
    Frame frame;
    frame.left = static_cast<int>(std::floor(cell * static_cast<double>(i)));
    const int right =
        std::min(image.width(), static_cast<int>(std::floor(cell * static_cast<double>(i + 1))));
    frame.width = right - frame.left;
    frame.top = place.top;
    frame.height = std::min(place.height, image.height() - place.top);
    frame.origin = {cell * (static_cast<double>(i) + 0.5) - shift, place.floor};
    frame.scale = scale;
    render(row.figures[i], camera, frame, image);
  }
}

}  // namespace

std::string draw_strip_picture(const RobotClip& motion, const HumanClip* human,
                               const StripPictureOptions& options) {
  const std::vector<int> frames = spread_frames(motion.frame_count(), options.poses);
  const Camera camera = Camera::beside(facing(motion, frames));
  const std::vector<CollisionShape> shapes = visible_shapes(motion.robot());
  SolidRow robots, humans;
  for (const int frame : frames) {
    const auto q = motion.qpos(frame);
    robots.add(robot_solids(motion.robot(), shapes, q), {q[0], q[1], q[2]}, camera);
    if (human == nullptr) continue;
    const bool there = frame < human->frame_count;
    humans.add(there ? human_solids(*human, frame) : SolidFigure(),
               there ? human->frame(frame)[Bone::kHips].translation : Eigen::Vector3d::Zero(),
               camera);
  }

  const double highest = std::max({robots.height(), humans.height(), kMinSize});
  const double widest = std::max({robots.width(), humans.width(), kMinSize});
  const auto count = static_cast<double>(frames.size());
  const double scale = std::min(options.width / (count * (widest + kBetween * highest)),
                                options.max_row_height / highest);
  const double margin = kMargin * highest * scale;
  const double cell = (widest + kBetween * highest) * scale;
  const double letters = options.times ? std::clamp(0.055 * highest * scale, 6.0, 14.0) : 0.0;
  int bottom = 0;
  RowPlace of_humans, of_robots;
  if (!humans.box.isEmpty()) {
    of_humans = place_row(humans, bottom, scale, margin, highest);
    bottom += of_humans.height;
  }
  of_robots = place_row(robots, bottom, scale, margin, highest);
  bottom += of_robots.height;
  Image image(std::max(1, static_cast<int>(std::ceil(cell * count))),
              bottom + static_cast<int>(std::ceil(1.6 * letters)), kPaper);
  if (!humans.box.isEmpty()) draw_row(humans, of_humans, cell, scale, camera, image);
  draw_row(robots, of_robots, cell, scale, camera, image);
  for (std::size_t i = 0; options.times && i < frames.size(); ++i) {
    draw_time(image, number_text(motion.rate().time_of(frames[i]), 2) + " s",
              {cell * (static_cast<double>(i) + 0.5), bottom + letters}, letters, kInk);
  }
  return format_png(image);
}

std::string draw_strip_picture(const Motion& motion, const StripPictureOptions& options) {
  const WrittenMotion written(motion);
  return draw_strip_picture(written.clip, &written.human, options);
}

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
