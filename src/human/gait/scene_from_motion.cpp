#include "retarget/scene_from_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/math/convex_hull.h"
#include "human/gait/rests.h"
#include "human/skeleton/human_clip.h"
#include "retarget/so3.h"
#include "retarget/trigonometry.h"

namespace retarget {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Points = std::vector<Vector2d>;

// Metres.
constexpr double kSameHeight = 0.04, kNearRests = 0.6, kMargin = 0.06, kLower = 0.05, kBoard = 0.05;

// A rectangle on the ground.
struct Rectangle {
  Vector2d along = Vector2d::UnitX();                        // Unit vector of its first side.
  Vector2d low = Vector2d::Zero(), high = Vector2d::Zero();  // In the axes of the sides.

  [[nodiscard]] Vector2d in_axes(const Vector2d& point) const {
    return {along.dot(point), along.x() * point.y() - along.y() * point.x()};
  }
  [[nodiscard]] double area() const { return (high - low).prod(); }
  [[nodiscard]] Vector2d middle() const {
    const Vector2d in_axes = 0.5 * (low + high);
    return in_axes.x() * along + in_axes.y() * Vector2d(-along.y(), along.x());
  }
};

// The smallest rectangle; one of its sides contains a side of the hull.
Rectangle smallest_rectangle(Points points) {
  reduce_to_hull(points);
  std::optional<Rectangle> best;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector2d side = points[(i + 1) % points.size()] - points[i];
    if (!(side.norm() > 0.0)) continue;
    Rectangle rectangle{side.normalized(), Vector2d::Constant(std::numeric_limits<double>::max()),
                        Vector2d::Constant(std::numeric_limits<double>::lowest())};
    for (const Vector2d& point : points) {
      rectangle.low = rectangle.low.cwiseMin(rectangle.in_axes(point));
      rectangle.high = rectangle.high.cwiseMax(rectangle.in_axes(point));
    }
    if (!best || rectangle.area() < best->area()) best = rectangle;
  }
  return best.value_or(Rectangle());
}

// Rests on one surface.
struct Plateau {
  std::vector<const RaisedRest*> rests;
  Points points;
  double height = 0.0;  // Mean over the frames of the rests.

  void add(const RaisedRest& rest) {
    rests.push_back(&rest);
    points.insert(points.end(), rest.outline.begin(), rest.outline.end());
    double sum = 0.0, frames = 0.0;
    for (const RaisedRest* each : rests) {
      const double count = each->frames.end - each->frames.begin;
      sum += count * each->height;
      frames += count;
    }
    height = sum / frames;
  }
};

double distance_between(const Points& a, const Points& b) {
  double nearest = std::numeric_limits<double>::max();
  for (const Vector2d& p : a) {
    for (const Vector2d& q : b) nearest = std::min(nearest, (p - q).norm());
  }
  return nearest;
}

// Whether the human stands inside a rectangle, lower than its height.
bool covers_lower_ground(const Rectangle& rectangle, double height,
                         const std::vector<Footing>& footings) {
  return std::ranges::any_of(footings, [&](const Footing& footing) {
    const Vector2d at = rectangle.in_axes(footing.point);
    return footing.height < height - kLower && (at.array() > rectangle.low.array()).all() &&
           (at.array() < rectangle.high.array()).all();
  });
}

// Adds a margin to each side, less where the human stands lower beside it.
void add_margins(double height, const std::vector<Footing>& footings, Rectangle& rectangle) {
  Vector2d below = Vector2d::Constant(kMargin), above = below;
  for (const Footing& footing : footings) {
    if (footing.height >= height - kLower) continue;
    const Vector2d at = rectangle.in_axes(footing.point);
    const Vector2d under = rectangle.low - at, over = at - rectangle.high;
    const Vector2d outside = under.cwiseMax(over);
    if (outside.maxCoeff() >= kMargin) continue;
    const int axis = outside.x() > outside.y() ? 0 : 1;
    if (outside[axis] <= 0.0) continue;
    double& margin = under[axis] > over[axis] ? below[axis] : above[axis];
    margin = std::min(margin, outside[axis]);
  }
  rectangle.low -= below;
  rectangle.high += above;
}

std::vector<Plateau> find_plateaus(const std::vector<RaisedRest>& rests,
                                   const std::vector<Footing>& footings) {
  std::vector<Plateau> plateaus;
  for (const RaisedRest& rest : rests) {
    const auto takes = [&](const Plateau& plateau) {
      if (std::abs(plateau.height - rest.height) > kSameHeight ||
          plateau.rests.front()->kind != rest.kind ||
          distance_between(plateau.points, rest.outline) > kNearRests) {
        return false;
      }
      Points together = plateau.points;
      together.insert(together.end(), rest.outline.begin(), rest.outline.end());
      return !covers_lower_ground(smallest_rectangle(together), rest.height, footings);
    };
    const auto found = std::ranges::find_if(plateaus, takes);
    (found == plateaus.end() ? plateaus.emplace_back() : *found).add(rest);
  }
  return plateaus;
}

std::string name_of(RestKind kind, int number) {
  constexpr std::array kNames = {"step", "seat", "rest"};
  return fmt::format("{}_{}", kNames[static_cast<std::size_t>(kind)], number);
}

// A box from the floor up; under a hand a board, because the body may be under a rail.
SceneBody box_of(const Rectangle& rectangle, RestKind kind, double height, std::string name) {
  const double thickness = kind == RestKind::kHand ? std::min(kBoard, height) : height;
  SceneBody body;
  body.name = std::move(name);
  const Vector2d middle = rectangle.middle();
  body.world_from_body.translation = {middle.x(), middle.y(), height - 0.5 * thickness};
  const double heading = portable::atan2(rectangle.along.y(), rectangle.along.x());
  body.world_from_body.rotation = exp_so3(Vector3d(0.0, 0.0, heading));
  SceneShape& box = body.shapes.emplace_back();
  box.type = SceneShape::Type::kBox;
  const Vector2d half = 0.5 * (rectangle.high - rectangle.low);
  box.half_size = {half.x(), half.y(), 0.5 * thickness};
  return body;
}

}  // namespace

Result<SceneFromMotion> scene_from_motion(const Clip& clip, const Calibration& calibration,
                                          const ContactOptions& options) {
  const HumanClip human = to_human(clip, calibration);
  RestingHuman of{&human, SourceFeet(human, human.frame_count), {}};
  if (of.feet.foot_count == 0) return input_failure(clip.name(), "the human has no feet");
  of.contacts = find_contacts(of.feet, options);
  const std::vector<RaisedRest> rests = find_raised_rests(of);
  const std::vector<Footing> footings = find_footings(of);
  SceneFromMotion found;
  found.scene.name = clip.name();
  std::array<int, 3> counts{};
  for (const Plateau& plateau : find_plateaus(rests, footings)) {
    Rectangle rectangle = smallest_rectangle(plateau.points);
    add_margins(plateau.height, footings, rectangle);
    const RestKind kind = plateau.rests.front()->kind;
    const std::string name = name_of(kind, ++counts[static_cast<std::size_t>(kind)]);
    found.scene.bodies.push_back(box_of(rectangle, kind, plateau.height, name));
    FoundSurface surface{name, plateau.height, rectangle.high - rectangle.low,
                         static_cast<int>(plateau.rests.size())};
    int begin = clip.frame_count(), end = 0;
    for (const RaisedRest* rest : plateau.rests) {
      begin = std::min(begin, rest->frames.begin);
      end = std::max(end, rest->frames.end);
    }
    surface.first = begin * clip.rate().frame_time();
    surface.last = end * clip.rate().frame_time();
    found.surfaces.push_back(std::move(surface));
  }
  return found;
}

std::string surfaces_text(const SceneFromMotion& found) {
  std::string text = fmt::format("{:<10}{:>10}{:>16}{:>8}{:>12}{:>12}\n", "surface", "height m",
                                 "size m", "rests", "from s", "to s");
  for (const FoundSurface& surface : found.surfaces) {
    const std::string size = fmt::format("{:.2f} x {:.2f}", surface.size.x(), surface.size.y());
    text += fmt::format("{:<10}{:>10.3f}{:>16}{:>8}{:>12.2f}{:>12.2f}\n", surface.body,
                        surface.height, size, surface.rests, surface.first, surface.last);
  }
  return text;
}

}  // namespace retarget
