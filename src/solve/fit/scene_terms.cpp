#include "solve/fit/scene_terms.h"

#include "retarget/pose.h"
#include "solve/fit/one_sided.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// Half-width of the band over which the penetration term's curvature grows to its full value,
// metres.
constexpr double kSceneBand = 0.003;

// Adds the residual r of a point's coordinate along a direction n. Its rate is n.(v + w x d), as in
// FrameTerms::add_row.
// @param from_root  the vector d from the root's origin to the point.
void add_row(Composite& sum, const Vector3d& direction, const Vector3d& from_root, double weight,
             double residual) {
  const Vector3d turning = from_root.cross(direction);
  sum.linear += weight * direction * direction.transpose();
  sum.mixed += weight * direction * turning.transpose();
  sum.angular += weight * turning * turning.transpose();
  sum.force += weight * residual * direction;
  sum.torque += weight * residual * turning;
}

// Turns the hand so that its facing direction points against the surface normal.
double add_facing(const FitOptions& options, const SceneGoal& goal, const TreeState& pose, int link,
                  Composite& composite) {
  if (goal.facing.isZero(0.0)) return 0.0;
  const double weight = square(goal.share * options.scene_palm_weight);
  const Vector3d facing = pose.world_from_link[at(link)].rotation * goal.facing;
  // Rotation from the negative normal to the facing direction; its length is the sine of the angle.
  const Vector3d error = facing.cross(goal.normal);
  const Vector3d first = goal.normal.unitOrthogonal();
  double cost = 0.0;
  for (const Vector3d& axis : {first, Vector3d(goal.normal.cross(first))}) {
    const double residual = axis.dot(error);
    // Derivative of the residual with respect to a rotation of the link.
    const Vector3d turning = axis.dot(facing) * goal.normal - facing.dot(goal.normal) * axis;
    composite.angular += weight * turning * turning.transpose();
    composite.torque += weight * residual * turning;
    cost += weight * square(residual);
  }
  return cost;
}

double add_contact(const FitModel& model, const FitOptions& options, const FitScene& scene,
                   int frame, const SceneGoal& goal, const TreeState& pose,
                   std::span<Composite> composites) {
  const SupportBody& body = model.supports[at(goal.support)];
  const Vector3d& origin = pose.origin();
  const SupportBody::SceneTouch touch = body.nearest(pose, scene.world, frame, at(goal.body));
  const double apart = touch.distance - goal.distance;
  const double normal_weight = square(goal.share * options.scene_contact_weight);
  add_row(composites[at(touch.link)], touch.normal, touch.place - origin, normal_weight, apart);
  double cost = normal_weight * square(apart);
  // The middle of the body must be over the contact point, so these rows are tangential.
  const Vector3d middle = body.world_middle(pose);
  const Vector3d off = middle - goal.place;
  const double place_weight =
      square(goal.share * (goal.held ? options.scene_hold_weight : options.scene_place_weight));
  const Vector3d first = goal.normal.unitOrthogonal();
  for (const Vector3d& tangent : {first, Vector3d(goal.normal.cross(first))}) {
    const double error = tangent.dot(off);
    add_row(composites[at(body.link)], tangent, middle - origin, place_weight, error);
    cost += place_weight * square(error);
  }
  return cost + add_facing(options, goal, pose, body.link, composites[at(body.link)]);
}

// Pushes a sphere of a link out of a body.
// @param margin  required distance between sphere and body, metres.
double keep_outside(const FitScene& scene, int frame, std::size_t scene_body,
                    const FloorPoint& point, const Pose& world_from_link, const Vector3d& origin,
                    double margin, double weight, Composite& composite) {
  const Vector3d place = world_from_link * point.position;
  const SurfaceDistance found = scene.world.distance(frame, scene_body, place);
  const OneSidedRow row = one_sided(found.distance - point.radius - margin, kSceneBand);
  if (row.weight <= 0.0) return 0.0;
  add_row(composite, found.normal, place - origin, weight * row.weight, row.residual);
  return weight * row.cost;
}

}  // namespace

SceneCosts add_scene_terms(const FitModel& model, const FitOptions& options, const FitScene& scene,
                           int frame, const TreeState& pose, std::span<const char> stands,
                           std::span<Composite> composites) {
  SceneCosts costs;
  for (const SceneGoal& goal : scene.goals_of(frame)) {
    costs.contact += add_contact(model, options, scene, frame, goal, pose, composites);
  }
  const Vector3d& origin = pose.origin();
  for (std::size_t link = 0; link < scene.points.size(); ++link) {
    if (scene.points[link].empty()) continue;
    const bool is_foot = model.is_foot[link] != 0;
    // The shapes of a foot in the air, or of one that lies, need not penetrate anything.
    const bool on_sole = is_foot && stands[at(model.foot_of_link[link])] != 0;
    const double margin = on_sole ? -kFootShapeDepth : is_foot ? 0.0 : options.scene_margin;
    const double weight = square(options.body_floor_weight);
    const Pose& world_from_link = pose.world_from_link[link];
    const BoundingSphere& sphere = scene.spheres[link];
    const Vector3d centre = world_from_link * sphere.centre;
    for (std::size_t body = 0; body < scene.world.body_count(); ++body) {
      const double reach = sphere.radius + margin + kSceneBand;
      if (scene.world.is_beyond(frame, body, centre, reach) ||
          scene.world.distance(frame, body, centre).distance > reach) {
        continue;
      }
      for (const FloorPoint& point : scene.points[link]) {
        costs.penetration += keep_outside(scene, frame, body, point, world_from_link, origin,
                                          margin, weight, composites[link]);
      }
    }
  }
  return costs;
}

}  // namespace retarget
