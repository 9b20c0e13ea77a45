#include "scene/terrain.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "retarget/so3.h"
#include "retarget/trigonometry.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

SceneShape box_between(const Vector3d& low, const Vector3d& high) {
  SceneShape box;
  box.type = SceneShape::Type::kBox;
  box.half_size = 0.5 * (high - low);
  box.body_from_shape.translation = 0.5 * (high + low);
  return box;
}

// A block whose top contains the edge.
SceneShape slope_block(double slope, double length, double width) {
  constexpr double kThick = 1.0;  // Metres.
  const auto [sine, cosine] = portable::sin_cos(slope);
  SceneShape block;
  block.type = SceneShape::Type::kBox;
  block.half_size = {0.5 * length / cosine, 0.5 * width, 0.5 * kThick};
  block.body_from_shape.rotation = exp_so3(Vector3d(0.0, -slope, 0.0));
  block.body_from_shape.translation = Vector3d(0.5 * length, 0.0, 0.5 * length * sine / cosine) -
                                      0.5 * kThick * Vector3d(-sine, 0.0, cosine);
  return block;
}

}  // namespace

int Terrain::step_at(double distance) const {
  const double step = std::floor(distance / tread) + 1.0;
  return static_cast<int>(std::clamp(step, 0.0, static_cast<double>(count)));
}

double Terrain::height_at(double distance) const {
  if (!is_slope()) return rise * step_at(distance);
  const auto [sine, cosine] = portable::sin_cos(slope);
  return std::max(0.0, distance) * sine / cosine;
}

Scene terrain_scene(const Terrain& terrain, double length, double width) {
  Scene scene;
  SceneBody& body = scene.bodies.emplace_back();
  body.name = scene.name = terrain.is_slope() ? "slope" : "stairs";
  body.world_from_body.translation = {terrain.edge.x(), terrain.edge.y(), 0.0};
  const double heading = portable::atan2(terrain.along.y(), terrain.along.x());
  body.world_from_body.rotation = exp_so3(Vector3d(0.0, 0.0, heading));
  if (terrain.is_slope()) {
    body.shapes.push_back(slope_block(terrain.slope, length, width));
    return scene;
  }
  // Each layer extends from its riser to the end, so that the nearest surface inside a step is its
  // top.
  for (int step = 0; step < terrain.count; ++step) {
    body.shapes.push_back(box_between({step * terrain.tread, -0.5 * width, step * terrain.rise},
                                      {length, 0.5 * width, (step + 1) * terrain.rise}));
  }
  return scene;
}

}  // namespace retarget
