#include "view/render.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace retarget {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSamples = 3;      // Samples along each side of a pixel.
constexpr double kReach = 0.35;  // Metres: more distant shapes cast no shadow.
constexpr double kGroundReach = 1.2;
constexpr double kGroundStrength = 2.2;
constexpr double kFade = 0.16;  // Fraction of the frame's width.
constexpr double kNothing = -std::numeric_limits<double>::infinity();

// Intersection of a view ray with a shape.
struct Hit {
  double depth = kNothing;  // Towards the viewer, metres.
  Vector3d normal = Vector3d::Zero();
};

// A shape in camera axes: right, up, nearer.
struct CameraShape {
  RoundedShape shape;
  Vector3d colour;  // Linear, 0 to 1.
  Vector2d low, high;

  [[nodiscard]] Vector3d nearest_on_core(const Vector3d& point) const {
    if (shape.axis_count == 0) return shape.centre;
    if (shape.axis_count == 1) {
      const Vector3d& axis = shape.half_axes[0];
      const double along =
          std::clamp((point - shape.centre).dot(axis) / axis.squaredNorm(), -1.0, 1.0);
      return shape.centre + along * axis;
    }
    Vector3d nearest = shape.centre;
    for (const Vector3d& axis : shape.half_axes) {
      nearest +=
          std::clamp((point - shape.centre).dot(axis) / axis.squaredNorm(), -0.7, 0.7) * axis;
    }
    return nearest;
  }
  // Returns the radius of a sphere that occludes as much light as the shape.
  [[nodiscard]] double width() const {
    if (shape.axis_count < 3) return shape.radius;
    double least = std::numeric_limits<double>::max();
    for (const Vector3d& axis : shape.half_axes) least = std::min(least, axis.norm());
    return least;
  }
};

Hit hit_sphere(const Vector3d& centre, double radius, const Vector2d& at) {
  const double rest = radius * radius - (at - centre.head<2>()).squaredNorm();
  if (rest < 0.0) return {};
  const double depth = centre.z() + std::sqrt(rest);
  return {depth, (Vector3d(at.x(), at.y(), depth) - centre) / radius};
}

// Intersects the cylinder of a capsule, otherwise its nearer cap.
Hit hit_capsule(const RoundedShape& shape, const Vector2d& at) {
  const Vector3d a = shape.centre - shape.half_axes[0], axis = 2.0 * shape.half_axes[0];
  const Vector3d from(at.x() - a.x(), at.y() - a.y(), -a.z());
  const double square = axis.squaredNorm(), lean = axis.z();
  const double along = axis.dot(from);
  // |from + t z - share * axis|^2 = radius^2, where share is the nearest point on the axis.
  const double p = square - lean * lean, q = square * from.z() - along * lean;
  const double rest =
      square * from.squaredNorm() - along * along - shape.radius * shape.radius * square;
  const double root = q * q - p * rest;
  Hit hit;
  if (p > 1e-12 * square && root >= 0.0) {
    const double depth = (-q + std::sqrt(root)) / p;
    const double share = (along + depth * lean) / square;
    if (share >= 0.0 && share <= 1.0) {
      const Vector3d point(at.x(), at.y(), depth);
      hit = {depth, (point - a - share * axis) / shape.radius};
    }
  }
  for (const Vector3d& end : {a, Vector3d(a + axis)}) {
    const Hit of_end = hit_sphere(end, shape.radius, at);
    if (of_end.depth > hit.depth) hit = of_end;
  }
  return hit;
}

Hit hit_box(const RoundedShape& shape, const Vector2d& at) {
  double near = std::numeric_limits<double>::infinity(), far = kNothing;
  Vector3d normal = Vector3d::UnitZ();
  const Vector3d from(at.x() - shape.centre.x(), at.y() - shape.centre.y(), -shape.centre.z());
  for (const Vector3d& axis : shape.half_axes) {
    const double square = axis.squaredNorm(), place = axis.dot(from), lean = axis.z();
    if (std::abs(lean) < 1e-9 * std::sqrt(square)) {
      if (std::abs(place) > square) return {};
      continue;
    }
    const double one = (square - place) / lean, other = (-square - place) / lean;
    far = std::max(far, std::min(one, other));
    if (std::max(one, other) >= near) continue;
    near = std::max(one, other);
    normal = (lean > 0.0 ? 1.0 : -1.0) / std::sqrt(square) * axis;
  }
  if (near < far) return {};
  return {near, normal};
}

Hit hit_shape(const RoundedShape& shape, const Vector2d& at) {
  if (shape.axis_count == 0) return hit_sphere(shape.centre, shape.radius, at);
  return shape.axis_count == 1 ? hit_capsule(shape, at) : hit_box(shape, at);
}

// Approximates the sRGB transfer function by a square.
Vector3d linear(int colour) {
  const Vector3d value((colour >> 16) & 0xFF, (colour >> 8) & 0xFF, colour & 0xFF);
  return (value / 255.0).cwiseAbs2();
}

class FigureRenderer {
 public:
  FigureRenderer(const SolidFigure& figure, const Camera& camera, const Frame& frame)
      : frame_(frame) {
    turn_.row(0) = camera.right;
    turn_.row(1) = camera.up;
    turn_.row(2) = camera.nearer;
    up_ = turn_ * Vector3d::UnitZ();
    light_ = Vector3d(-0.45, 0.75, 0.5).normalized();
    for (const Solid& solid : figure) add(solid);
    const std::size_t samples = static_cast<std::size_t>(frame.width * kSamples) *
                                static_cast<std::size_t>(frame.height * kSamples);
    depths_.assign(samples, kNothing);
    nearest_.assign(samples, -1);
  }

  void draw(Image& image) {
    for (std::size_t i = 0; i < shapes_.size(); ++i) find_nearest(static_cast<int>(i));
    for (int y = 0; y < frame_.height; ++y) {
      for (int x = 0; x < frame_.width; ++x) draw_pixel(x, y, image);
    }
  }

 private:
  // Cached ambient light of the shape at the previous sample.
  struct SkyOfShape {
    int shape = -1;
    Vector3d normal = Vector3d::Zero();
    double open = 1.0;
  };

  void add(const Solid& solid) {
    CameraShape shape{solid.shape, linear(solid.colour), {}, {}};
    shape.shape.centre = turn_ * solid.shape.centre;
    Vector2d reach(solid.shape.radius, solid.shape.radius);
    for (int axis = 0; axis < solid.shape.axis_count; ++axis) {
      Vector3d& half = shape.shape.half_axes[static_cast<std::size_t>(axis)];
      half = turn_ * half;
      reach += half.head<2>().cwiseAbs();
    }
    shape.low = shape.shape.centre.head<2>() - reach;
    shape.high = shape.shape.centre.head<2>() + reach;
    shapes_.push_back(shape);
  }

  // Returns the page position of a sample, metres.
  [[nodiscard]] Vector2d place_of(int x, int y) const {
    return {(frame_.left + (x + 0.5) / kSamples - frame_.origin.x()) / frame_.scale,
            (frame_.origin.y() - frame_.top - (y + 0.5) / kSamples) / frame_.scale};
  }

  void find_nearest(int index) {
    const CameraShape& shape = shapes_[static_cast<std::size_t>(index)];
    const auto sample_x = [&](double x) {
      return (x * frame_.scale + frame_.origin.x() - frame_.left) * kSamples;
    };
    const auto sample_y = [&](double y) {
      return (frame_.origin.y() - y * frame_.scale - frame_.top) * kSamples;
    };
    const int columns = frame_.width * kSamples, rows = frame_.height * kSamples;
    const auto bound = [](double at, int count) {
      return static_cast<int>(std::clamp(at, -1.0, static_cast<double>(count)));
    };
    const int left = std::max(0, bound(sample_x(shape.low.x()), columns));
    const int right = std::min(columns - 1, bound(sample_x(shape.high.x()), columns));
    const int top = std::max(0, bound(sample_y(shape.high.y()), rows));
    const int bottom = std::min(rows - 1, bound(sample_y(shape.low.y()), rows));
    for (int y = top; y <= bottom; ++y) {
      for (int x = left; x <= right; ++x) {
        const double depth = hit_shape(shape.shape, place_of(x, y)).depth;
        const std::size_t sample = index_of(x, y);
        if (depth <= depths_[sample]) continue;
        depths_[sample] = depth;
        nearest_[sample] = index;
      }
    }
  }

  [[nodiscard]] std::size_t index_of(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(frame_.width * kSamples) +
           static_cast<std::size_t>(x);
  }

  // Returns the fraction of the ambient light that reaches a surface point with the given normal.
  [[nodiscard]] double open_sky(const Vector3d& point, const Vector3d& normal, int own,
                                double reach) const {
    double open = 1.0;
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
      if (static_cast<int>(i) == own) continue;
      const CameraShape& shape = shapes_[i];
      const double far = reach + shape.shape.bounding_radius;
      if ((shape.shape.centre - point).squaredNorm() > far * far) continue;
      const Vector3d way = shape.nearest_on_core(point) - point;
      const double distance = std::max(way.norm(), 1e-6);
      const double facing = normal.dot(way) / distance;
      if (facing <= 0.0) continue;
      const double size = std::min(1.0, shape.width() / distance);
      // Fades out towards the reach, which avoids visible edges.
      const double fade = std::max(0.0, 1.0 - distance / far);
      open *= 1.0 - facing * size * size * fade;
    }
    return open;
  }

  // @param sky_of  cache of this pixel: ambient light varies too slowly to compute it per sample.
  [[nodiscard]] Vector3d shade(const Vector2d& at, double depth, int index,
                               SkyOfShape& sky_of) const {
    const CameraShape& shape = shapes_[static_cast<std::size_t>(index)];
    const Vector3d normal = hit_shape(shape.shape, at).normal;
    if (sky_of.shape != index || sky_of.normal.dot(normal) < 0.9) {
      sky_of = {index, normal, open_sky({at.x(), at.y(), depth}, normal, index, kReach)};
    }
    const double open = 0.25 + 0.75 * sky_of.open;
    const double sky = 0.5 + 0.5 * normal.dot(up_);
    const double direct = std::max(0.0, normal.dot(light_));
    const Vector3d half = (light_ + Vector3d::UnitZ()).normalized();
    double gleam = std::max(0.0, normal.dot(half));
    for (int i = 0; i < 5; ++i) gleam *= gleam;
    const Vector3d lit =
        (open * (0.26 + 0.42 * sky) + 0.62 * direct * (0.35 + 0.65 * open)) * shape.colour;
    return lit.array() + 0.06 * gleam * open;
  }

  // Returns the fraction of light that the ground at a page position reflects; 1: no shadow.
  [[nodiscard]] double ground_light(const Vector2d& at) const {
    // Intersect the view ray with the plane of height 0.
    const Vector3d point(at.x(), at.y(), -at.y() * up_.y() / up_.z());
    const double shadow = 1.0 - open_sky(point, up_, -1, kGroundReach);
    return 1.0 - std::min(0.6, kGroundStrength * shadow);
  }
  // Fades shadows out towards the sides, because the next figure begins there.
  [[nodiscard]] double fade(int x) const {
    const double to_side = std::min(x + 0.5, frame_.width - x - 0.5);
    const double share = std::min(1.0, to_side / (kFade * frame_.width));
    return share * share * (3.0 - 2.0 * share);
  }

  void draw_pixel(int x, int y, Image& image) {
    Vector3d light = Vector3d::Zero();
    int covered = 0;
    SkyOfShape sky_of;
    for (int j = 0; j < kSamples; ++j) {
      for (int i = 0; i < kSamples; ++i) {
        const int sx = x * kSamples + i, sy = y * kSamples + j;
        const std::size_t sample = index_of(sx, sy);
        if (nearest_[sample] < 0) continue;
        ++covered;
        light += shade(place_of(sx, sy), depths_[sample], nearest_[sample], sky_of);
      }
    }
    constexpr int kAll = kSamples * kSamples;
    std::uint8_t* pixel = image.pixel(frame_.left + x, frame_.top + y);
    Vector3d ground = Vector3d::Zero();
    if (covered < kAll) {
      const Vector2d at = place_of(x * kSamples + kSamples / 2, y * kSamples + kSamples / 2);
      // Shadows have a limited reach in front of and behind the figure.
      const bool near = std::abs(at.y()) < kGroundReach * up_.z();
      const double open = near ? 1.0 - fade(x) * (1.0 - ground_light(at)) : 1.0;
      for (int i = 0; i < 3; ++i) {
        const double before = pixel[i] / 255.0;
        ground[i] = before * before * open;
      }
    }
    const Vector3d mixed = (light + (kAll - covered) * ground) / kAll;
    for (int i = 0; i < 3; ++i) {
      const double value = std::sqrt(std::clamp(mixed[i], 0.0, 1.0));
      pixel[i] = static_cast<std::uint8_t>(std::floor(255.0 * value + 0.5));
    }
  }

  const Frame frame_;
  Eigen::Matrix3d turn_;  // Rotation camera_from_world.
  Vector3d up_, light_;   // In camera axes.
  std::vector<CameraShape> shapes_;
  std::vector<double> depths_;  // Per sample.
  std::vector<int> nearest_;    // Shape per sample; -1: none.
};

}  // namespace

SolidFigure robot_solids(const Robot& robot, const std::vector<CollisionShape>& shapes,
                         std::span<const double> qpos) {
  std::vector<Pose> world_from_body(robot.bodies().size());
  forward_kinematics(robot, qpos, world_from_body);
  SolidFigure figure;
  for (const CollisionShape& shape : shapes) {
    figure.push_back(
        {place(shape, world_from_body[static_cast<std::size_t>(shape.body)]), kRobotColour});
  }
  return figure;
}

SolidFigure human_solids(const HumanClip& human, int frame) {
  SolidFigure figure;
  for (const HumanLine& line : human_lines(human, frame)) {
    Solid solid;
    solid.colour = line.colour;
    solid.shape.centre = 0.5 * (line.from + line.to);
    solid.shape.radius = line.radius;
    solid.shape.half_axes[0] = 0.5 * (line.to - line.from);
    const double half_length = solid.shape.half_axes[0].norm();
    solid.shape.axis_count = half_length > 1e-6 ? 1 : 0;
    solid.shape.bounding_radius = half_length + line.radius;
    figure.push_back(solid);
  }
  return figure;
}

void shift(SolidFigure& figure, const Eigen::Vector3d& by) {
  for (Solid& solid : figure) solid.shape.centre += by;
}

Eigen::AlignedBox2d extent(const SolidFigure& figure, const Camera& camera) {
  Eigen::AlignedBox2d box;
  for (const auto& [shape, colour] : figure) {
    Eigen::Vector2d reach(shape.radius, shape.radius);
    for (int axis = 0; axis < shape.axis_count; ++axis) {
      reach += camera.project(shape.half_axes[static_cast<std::size_t>(axis)]).cwiseAbs();
    }
    const Eigen::Vector2d middle = camera.project(shape.centre);
    box.extend(Eigen::Vector2d(middle - reach));
    box.extend(Eigen::Vector2d(middle + reach));
  }
  return box;
}

void render(const SolidFigure& figure, const Camera& camera, const Frame& frame, Image& image) {
  FigureRenderer(figure, camera, frame).draw(image);
}

}  // namespace retarget
