#include "view/figure.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>

#include "retarget/appearance.h"
#include "retarget/pose.h"
#include "retarget/shape_distance.h"
#include "retarget/text.h"

namespace retarget {
namespace {

std::string place(const Eigen::Vector2d& point) {
  return number_text(point.x(), 1) + ' ' + number_text(point.y(), 1);
}

constexpr double kBoneRadius = 0.035;  // Metres.
constexpr double kHeadRadius = 0.1;
constexpr double kRim = 1.6;  // Pixels, both sides together.

// Returns the unit vector towards the light: above and to the left, in front of the page.
Eigen::Vector3d light_from(const Camera& camera) {
  return (-0.4 * camera.right + 0.7 * camera.up + 0.6 * camera.nearer).normalized();
}

double light_on(const Eigen::Vector3d& normal, const Eigen::Vector3d& light) {
  return std::max(0.0, normal.dot(light));
}

Eigen::Matrix2Xd columns(std::initializer_list<Eigen::Vector2d> points) {
  Eigen::Matrix2Xd result(2, static_cast<Eigen::Index>(points.size()));
  Eigen::Index column = 0;
  for (const Eigen::Vector2d& point : points) result.col(column++) = point;
  return result;
}

void add_box(const RoundedShape& box, const Camera& camera,
             std::vector<FigurePart::Piece>& pieces) {
  const Eigen::Vector3d light = light_from(camera);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d out = box.half_axes[axis];
    if (out.dot(camera.nearer) < 0.0) out = -out;
    const Eigen::Vector3d middle = box.centre + out, normal = out.normalized();
    const Eigen::Vector3d &a = box.half_axes[(axis + 1) % 3], &b = box.half_axes[(axis + 2) % 3];
    pieces.push_back({columns({camera.project(middle + a + b), camera.project(middle - a + b),
                               camera.project(middle - a - b), camera.project(middle + a - b)}),
                      0.0, light_on(normal, light)});
  }
}

void add_round(const RoundedShape& shape, const Camera& camera,
               std::vector<FigurePart::Piece>& pieces) {
  const Eigen::Vector3d light = light_from(camera);
  if (shape.axis_count == 0) {
    pieces.push_back({columns({camera.project(shape.centre)}), shape.radius, 1.0});
    return;
  }
  // Uses the light on the brightest line along the capsule.
  const Eigen::Vector3d& axis = shape.half_axes[0];
  const double along = axis.normalized().dot(light);
  pieces.push_back(
      {columns({camera.project(shape.centre - axis), camera.project(shape.centre + axis)}),
       shape.radius, std::sqrt(std::max(0.0, 1.0 - along * along))});
}

void sort_by_nearness(Figure& figure) {
  std::ranges::stable_sort(figure, {}, &FigurePart::nearness);
}

std::optional<Eigen::Vector3d> bone_place(const HumanClip& human, int frame,
                                          const std::string& name) {
  const auto bone = bone_from_name(name);
  if (!bone || !human.has(*bone)) return std::nullopt;
  return human.frame(frame)[*bone].translation;
}

// Scales the colour between half and full brightness.
std::string shaded(int colour, double light) {
  const double share = 0.55 + 0.45 * std::clamp(light, 0.0, 1.0);
  int result = 0;
  for (int shift = 16; shift >= 0; shift -= 8) {
    result = result * 256 + static_cast<int>(std::lround(((colour >> shift) & 0xFF) * share));
  }
  return fmt::format("#{:06x}", result);
}

}  // namespace

void SvgWriter::stroke(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double width,
                       std::string_view colour) {
  text_ += fmt::format("<path d=\"M{}L{}\" stroke=\"{}\" stroke-width=\"{}\"/>\n", place(from),
                       place(to), colour, number_text(width, 1));
}

void SvgWriter::area(const Eigen::Matrix2Xd& corners, std::string_view colour, double rim) {
  std::string outline;
  for (const auto& corner : corners.colwise()) {
    outline += outline.empty() ? 'M' : 'L';
    outline += place(corner);
  }
  text_ += fmt::format("<path d=\"{}Z\" fill=\"{}\"", outline, colour);
  if (rim > 0.0) {
    text_ += fmt::format(" stroke=\"{}\" stroke-width=\"{}\"", colour, number_text(rim, 1));
  }
  text_ += "/>\n";
}

void SvgWriter::label(const Eigen::Vector2d& middle, std::string_view text) {
  text_ += fmt::format("<text x=\"{}\" y=\"{}\">{}</text>\n", number_text(middle.x(), 1),
                       number_text(middle.y(), 1), xml_text(text));
}

std::string SvgWriter::finish(const Eigen::Vector2d& size, std::string_view title) const {
  const std::string width = number_text(size.x(), 0), height = number_text(size.y(), 0);
  std::string result = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\">\n",
      width, height);
  if (!title.empty()) result += "<title>" + xml_text(title) + "</title>\n";
  return result +
         "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
         "<g fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\" "
         "font-family=\"sans-serif\" font-size=\"12\" text-anchor=\"middle\">\n" +
         text_ + "</g>\n</svg>\n";
}

Camera Camera::beside(const Eigen::Vector3d& forward) {
  Eigen::Vector3d ahead(forward.x(), forward.y(), 0.0);
  if (ahead.norm() < 1e-9) ahead = Eigen::Vector3d::UnitX();
  ahead.normalize();
  // Look from 35 degrees towards the front of the side view, 8 degrees downwards.
  const Eigen::Vector3d to_the_right(ahead.y(), -ahead.x(), 0.0);
  const Eigen::Vector3d level = 0.81915 * to_the_right + 0.57358 * ahead;
  Camera camera;
  camera.nearer = (0.99027 * level + 0.13917 * Eigen::Vector3d::UnitZ()).normalized();
  camera.right = Eigen::Vector3d::UnitZ().cross(camera.nearer).normalized();
  camera.up = camera.nearer.cross(camera.right);
  return camera;
}

Figure robot_figure(const Robot& robot, const std::vector<CollisionShape>& shapes,
                    std::span<const double> qpos, const Camera& camera) {
  std::vector<Pose> world_from_body(robot.bodies().size());
  forward_kinematics(robot, qpos, world_from_body);
  // One part per body, so that its pieces are drawn together.
  Figure figure(robot.bodies().size());
  std::vector<int> counts(figure.size());
  for (const CollisionShape& shape : shapes) {
    const RoundedShape placed = place(shape, world_from_body[shape.body]);
    FigurePart& part = figure[shape.body];
    // Depth is the mean over the body's shapes.
    const double share = 1.0 / ++counts[shape.body];
    part.nearness += share * (camera.nearer.dot(placed.centre) - part.nearness);
    part.colour = kRobotColour;
    if (shape.type == CollisionShape::Type::kBox) {
      add_box(placed, camera, part.pieces);
    } else {
      add_round(placed, camera, part.pieces);
    }
  }
  std::erase_if(figure, [](const FigurePart& part) { return part.pieces.empty(); });
  sort_by_nearness(figure);
  return figure;
}

const std::vector<HumanChain>& human_chains() {
  static const std::vector<HumanChain> kChains = {
      {Side::kNone, {"Hips", "Spine", "Spine1", "Spine2", "Neck", "Head"}},
      {Side::kLeft, {"Hips", "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToe"}},
      {Side::kRight, {"Hips", "RightUpLeg", "RightLeg", "RightFoot", "RightToe"}},
      {Side::kLeft, {"Spine2", "LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand"}},
      {Side::kRight, {"Spine2", "RightShoulder", "RightArm", "RightForeArm", "RightHand"}}};
  return kChains;
}

std::vector<HumanLine> human_lines(const HumanClip& human, int frame) {
  std::vector<HumanLine> lines;
  for (const HumanChain& chain : human_chains()) {
    const int colour = side_colour(chain.side);
    std::optional<Eigen::Vector3d> before;
    for (const std::string& bone : chain.bones) {
      const auto place = bone_place(human, frame, bone);
      if (!place) continue;
      if (before) lines.push_back({*before, *place, kBoneRadius, colour});
      if (before && bone == "Head") {
        const Eigen::Vector3d middle = *place + 0.8 * kHeadRadius * (*place - *before).normalized();
        lines.push_back({middle, middle, kHeadRadius, colour});
      }
      before = place;
    }
  }
  return lines;
}

Figure human_figure(const HumanClip& human, int frame, const Camera& camera) {
  Figure figure;
  for (const HumanLine& line : human_lines(human, frame)) {
    figure.push_back(
        {camera.nearer.dot(line.from + line.to) / 2.0,
         line.colour,
         {{columns({camera.project(line.from), camera.project(line.to)}), line.radius, 1.0}}});
  }
  sort_by_nearness(figure);
  return figure;
}

Eigen::AlignedBox2d extent(const Figure& figure) {
  Eigen::AlignedBox2d box;
  for (const FigurePart& part : figure) {
    for (const FigurePart::Piece& piece : part.pieces) {
      const Eigen::Vector2d around(piece.radius, piece.radius);
      for (const auto& point : piece.points.colwise()) {
        box.extend(Eigen::Vector2d(point - around));
        box.extend(Eigen::Vector2d(point + around));
      }
    }
  }
  return box;
}

void draw(const Figure& figure, const Eigen::Vector2d& origin, double scale, SvgWriter& svg) {
  const auto pixels = [&](const Eigen::Matrix2Xd& points) -> Eigen::Matrix2Xd {
    return (Eigen::Vector2d(scale, -scale).asDiagonal() * points).colwise() + origin;
  };
  const auto draw_piece = [&](const FigurePart::Piece& piece, const std::string& colour,
                              double rim) {
    const Eigen::Matrix2Xd points = pixels(piece.points);
    if (points.cols() > 2) {
      svg.area(points, colour, rim);
    } else {
      const Eigen::Index last = points.cols() - 1;
      svg.stroke(points.col(0), points.col(last), 2.0 * piece.radius * scale + rim, colour);
    }
  };
  for (const FigurePart& part : figure) {
    // An outline around the whole part separates it from the parts behind it.
    for (const FigurePart::Piece& piece : part.pieces) draw_piece(piece, "#2b2b2b", kRim);
    for (const FigurePart::Piece& piece : part.pieces) {
      draw_piece(piece, shaded(part.colour, piece.light), 0.0);
    }
  }
}

}  // namespace retarget
