#include "scene/scene_world.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "base/try.h"
#include "scene/body_mass.h"

namespace retarget {

int Scene::find(const std::string& body) const {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].name == body) return static_cast<int>(i);
  }
  return -1;
}

namespace {

using Eigen::Vector3d;

constexpr double kNear = 5e-4;  // Distance at which a search has reached a surface, metres.

SurfaceDistance nearest_surface(const SceneWorld& world, int frame, std::size_t body,
                                const Vector3d& point) {
  const Pose& pose = world.clip.pose(frame, body);
  const double scale = world.scales[body];
  const Vector3d in_body = pose.rotation.conjugate() * (point - pose.translation);
  SurfaceDistance found = world.fields[body].at(in_body / scale);
  found.distance *= scale;
  found.normal = pose.rotation * found.normal;
  return found;
}

// Whether the nearest surface around a point inside a body is an underside.
bool is_above_underside(const SurfaceDistance& found) {
  constexpr double kDown = -0.7;  // z of the normal.
  return found.distance < 0.0 && found.normal.z() < kDown;
}

// The way out of a body that lies on the floor, from a point whose nearest surface is the underside:
// through a side or the top, whichever becomes the nearest surface on the way up.
SurfaceDistance way_out(const SceneWorld& world, int frame, std::size_t body,
                        const Vector3d& point) {
  constexpr int kMaxSteps = 200;
  constexpr double kLevel = 0.7;  // z of the normal of a top.
  Vector3d at = point;
  SurfaceDistance found;
  for (int step = 0; step < kMaxSteps; ++step) {
    at.z() += std::max(2.0 * kNear, -found.distance);
    found = nearest_surface(world, frame, body, at);
    if (!is_above_underside(found)) break;
  }
  if (found.distance < 0.0 && found.normal.z() < kLevel) return found;
  return {found.distance - (at.z() - point.z()), Vector3d::UnitZ()};
}

// Height of the surface of a body below a point, metres; 0: none, or the body contains the point.
double surface_below(const SceneWorld& world, int frame, std::size_t body, const Vector3d& point) {
  constexpr int kMaxSteps = 200;
  const double reach = world.scales[body] * world.fields[body].reach();
  const Vector3d aside = point - world.clip.pose(frame, body).translation;
  if (aside.head<2>().squaredNorm() > reach * reach) return 0.0;
  Vector3d at = point;
  for (int step = 0; step < kMaxSteps && at.z() > 0.0; ++step) {
    const double away = world.distance(frame, body, at).distance;
    if (step == 0 && away < -kNear) return 0.0;
    if (away < kNear) return at.z();
    at.z() -= away;
  }
  return 0.0;
}

// Whether a body always has the pose of the scene's file, up to rounding.
bool keeps_pose(const SceneClip& clip, std::size_t body) {
  constexpr double kRounding = 1e-9;
  const Pose file_from_world = clip.scene->bodies[body].world_from_body.inverse();
  for (int frame = 0; frame < clip.frame_count; ++frame) {
    const Pose moved = file_from_world * clip.pose(frame, body);
    if (moved.translation.norm() > kRounding || moved.rotation.vec().norm() > kRounding) {
      return false;
    }
  }
  return true;
}

}  // namespace

SurfaceDistance SceneWorld::distance(int frame, std::size_t body, const Vector3d& point) const {
  constexpr double kOnFloor = 0.01;  // Metres.
  const SurfaceDistance found = nearest_surface(*this, frame, body, point);
  const double exit = point.z() - found.distance * found.normal.z();
  if (!is_fixed(body) || !is_above_underside(found) || exit > kOnFloor) return found;
  return way_out(*this, frame, body, point);
}

double SceneWorld::ground_below(int frame, const Vector3d& point) const {
  double highest = 0.0;
  for (std::size_t body = 0; body < fields.size(); ++body) {
    if (is_fixed(body)) highest = std::max(highest, surface_below(*this, frame, body, point));
  }
  return highest;
}

Result<SceneWorld> make_scene_world(SceneClip clip) {
  SceneWorld world;
  const std::string cache = distance_cache_folder();
  for (const SceneBody& body : clip.scene->bodies) {
    TRY_ASSIGN(DistanceField field, make_distance_field(body, cache));
    world.fields.push_back(std::move(field));
  }
  world.scales.assign(world.fields.size(), 1.0);
  for (std::size_t body = 0; body < world.fields.size(); ++body) {
    world.fixed.push_back(!clip.scene->bodies[body].moves || keeps_pose(clip, body) ? 1 : 0);
  }
  world.clip = std::move(clip);
  return world;
}

SceneShape scaled_shape(SceneShape shape, double scale) {
  shape.body_from_shape.translation *= scale;
  shape.half_size *= scale;
  shape.radius *= scale;
  shape.half_length *= scale;
  if (shape.mesh) {
    auto mesh = std::make_shared<TriangleMesh>(*shape.mesh);
    for (Vector3d& vertex : mesh->vertices) vertex *= scale;
    shape.mesh = std::move(mesh);
  }
  return shape;
}

Vector3d BodyAnchor::at(const Eigen::Quaterniond& world_from_body) const {
  const Vector3d centre = world_from_body * centre_;
  return {centre.x(), centre.y(), field_->lowest(world_from_body)};
}

BodyAnchor::BodyAnchor(const SceneBody& body, const DistanceField& field)
    : centre_(body_mass(body).com), field_(&field) {}

SceneWorld scaled_world(const SceneWorld& world, double scale) {
  SceneWorld result = world;
  Scene scene = *world.clip.scene;
  for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
    SceneBody& of_scene = scene.bodies[body];
    std::optional<BodyAnchor> anchor;
    if (!world.is_fixed(body)) anchor.emplace(of_scene, world.fields[body]);
    const auto place = [&](Pose& pose) {
      // Every point of a fixed body scales, and of another body only the anchor.
      const Vector3d kept = anchor ? anchor->at(pose.rotation) : Vector3d(Vector3d::Zero());
      pose.translation = scale * pose.translation + (scale - 1.0) * kept;
    };
    place(of_scene.world_from_body);
    for (int frame = 0; frame < world.clip.frame_count; ++frame) {
      place(result.clip
                .world_from_body[static_cast<std::size_t>(frame) * scene.bodies.size() + body]);
    }
    if (!world.is_fixed(body)) continue;
    result.scales[body] = scale * world.scales[body];
    for (SceneShape& shape : of_scene.shapes) shape = scaled_shape(std::move(shape), scale);
  }
  result.clip.scene = std::make_shared<const Scene>(std::move(scene));
  return result;
}

}  // namespace retarget
