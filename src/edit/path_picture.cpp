// Draws motions seen from above.

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "retarget/contact_plan.h"
#include "retarget/edit.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr double kMaxSide = 900.0;  // Picture size in pixels.
constexpr double kMaxPerMetre = 120.0;
constexpr double kMargin = 0.4;  // Metres.

struct Colours {
  const char* track;
  const char* path;
  const char* left;
  const char* right;
};
constexpr Colours kPale = {"#b8b8b8", "#8fb3d9", "#b7d3b0", "#e3b9b4"};
constexpr Colours kStrong = {"#444444", "#1f5fa8", "#2f8f2f", "#c23b2e"};

class Canvas {
 public:
  explicit Canvas(const Eigen::AlignedBox2d& box) : box_(box) {
    const Eigen::Vector2d size = box.sizes();
    scale_ = std::min(kMaxPerMetre, kMaxSide / std::max(size.x(), size.y()));
  }

  [[nodiscard]] std::string x(const Eigen::Vector2d& point) const {
    return number_text((point.x() - box_.min().x()) * scale_, 1);
  }
  [[nodiscard]] std::string y(const Eigen::Vector2d& point) const {
    return number_text((box_.max().y() - point.y()) * scale_, 1);
  }

  void line(const std::vector<Eigen::Vector2d>& points, const char* colour, const char* style) {
    if (points.size() < 2) return;
    text_ +=
        "<polyline fill=\"none\" stroke=\"" + std::string(colour) + "\" " + style + " points=\"";
    for (const Eigen::Vector2d& point : points) text_ += x(point) + "," + y(point) + " ";
    text_.back() = '"';
    text_ += "/>\n";
  }

  void dot(const Eigen::Vector2d& point, double radius, const char* colour) {
    text_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\"/>\n", x(point), y(point),
                         number_text(radius, 1), colour);
  }

  [[nodiscard]] std::string finish() {
    const Eigen::Vector2d corner = box_.min() + Eigen::Vector2d(0.1, 0.1);
    line({corner, corner + Eigen::Vector2d(1.0, 0.0)}, "#000000", "stroke-width=\"2\"");
    const Eigen::Vector2d label = corner + Eigen::Vector2d(0.0, 0.08);
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} "
        "{1}\">\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{2}"
        "<text x=\"{3}\" y=\"{4}\" font-family=\"sans-serif\" font-size=\"12\">1 "
        "m</text>\n</svg>\n",
        number_text(box_.sizes().x() * scale_, 0), number_text(box_.sizes().y() * scale_, 0), text_,
        x(label), y(label));
  }

 private:
  Eigen::AlignedBox2d box_;
  double scale_ = 1.0;
  std::string text_;
};

std::vector<Eigen::Vector2d> hips_track(const HumanClip& human) {
  std::vector<Eigen::Vector2d> track;
  // More than one point per centimetre would not be visible.
  constexpr double kStep = 0.01;
  for (int frame = 0; frame < human.frame_count; ++frame) {
    const Eigen::Vector2d place = human.frame(frame)[Bone::kHips].translation.head<2>();
    if (track.empty() || (place - track.back()).norm() > kStep) track.push_back(place);
  }
  return track;
}

std::vector<Eigen::Vector2d> path_points(const GroundPath& path) {
  std::vector<Eigen::Vector2d> points;
  const int steps = std::clamp(static_cast<int>(path.length() / 0.05), 1, 4000);
  for (int i = 0; i <= steps; ++i) points.push_back(path.at(path.length() * i / steps).position);
  return points;
}

// Draws the soles of planted feet, from ankle to toe.
void draw_feet(Canvas& canvas, const HumanClip& human, const Colours& colours) {
  const ContactPlan contacts = find_contacts(human);
  for (int foot = 0; foot < 2; ++foot) {
    const Side side = kSides[foot];
    const Bone ankle = side_bone(side, LimbBone::kFoot), toe = side_bone(side, LimbBone::kToe);
    for (const ContactPhase& phase : contacts.phases[foot]) {
      const HumanPose& pose = human.frame((phase.begin + phase.end) / 2);
      const Eigen::Vector2d heel = pose[ankle].translation.head<2>();
      const char* colour = foot == 0 ? colours.left : colours.right;
      canvas.dot(heel, 2.5, colour);
      if (human.has(toe)) {
        canvas.line({heel, pose[toe].translation.head<2>()}, colour, "stroke-width=\"4\"");
      }
    }
  }
}

struct PosedDrawing {
  std::optional<HumanClip> human;
  const GroundPath* path;
};

Eigen::AlignedBox2d box_of(const std::vector<PosedDrawing>& drawings) {
  Eigen::AlignedBox2d box;
  for (const auto& [human, path] : drawings) {
    if (human) {
      for (const Eigen::Vector2d& point : hips_track(*human)) box.extend(point);
    }
    if (path == nullptr) continue;
    for (const Eigen::Vector2d& point : path_points(*path)) box.extend(point);
    for (const Eigen::Vector2d& point : path->control_points()) box.extend(point);
  }
  if (box.isEmpty()) box.extend(Eigen::Vector2d(0.0, 0.0));
  const Eigen::Vector2d margin(kMargin, kMargin);
  return {box.min() - margin, box.max() + margin};
}

void draw_path(Canvas& canvas, const GroundPath& path, const Colours& colours) {
  canvas.line(path_points(path), colours.path, "stroke-width=\"3\"");
  const auto& points = path.control_points();
  for (std::size_t i = 0; i + 3 < points.size(); i += 3) {
    canvas.line({points[i], points[i + 1]}, colours.path, "stroke-width=\"1\"");
    canvas.line({points[i + 2], points[i + 3]}, colours.path, "stroke-width=\"1\"");
    canvas.dot(points[i + 1], 2.0, colours.path);
    canvas.dot(points[i + 2], 2.0, colours.path);
  }
  for (std::size_t i = 0; i < points.size(); i += 3) canvas.dot(points[i], 4.0, colours.path);
}

}  // namespace

std::string draw_paths(const Calibration& calibration, const std::vector<PathDrawing>& drawings) {
  std::vector<PosedDrawing> posed;
  for (const PathDrawing& drawing : drawings) {
    posed.push_back({std::nullopt, drawing.path});
    if (drawing.clip != nullptr) posed.back().human = to_human(*drawing.clip, calibration);
  }
  Canvas canvas(box_of(posed));
  for (std::size_t i = 0; i < posed.size(); ++i) {
    const Colours& colours = i == 0 && posed.size() > 1 ? kPale : kStrong;
    if (posed[i].path != nullptr) draw_path(canvas, *posed[i].path, colours);
    if (!posed[i].human) continue;
    canvas.line(hips_track(*posed[i].human), colours.track, "stroke-width=\"1.5\"");
    draw_feet(canvas, *posed[i].human, colours);
  }
  return canvas.finish();
}

}  // namespace retarget
