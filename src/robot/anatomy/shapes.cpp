// Samples points on bodies' surfaces from a model's meshes.

#include "robot/anatomy/shapes.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "retarget/kinematic_tree.h"
#include "retarget/pose.h"
#include "retarget/shape_distance.h"
#include "retarget/so3.h"
#include "robot/anatomy/underside.h"
#include "robot/model/load_model.h"
#include "robot/model/model_meshes.h"
#include "robot/model/model_values.h"

namespace retarget {
namespace {

using Type = CollisionShape::Type;

// Human proportions relative to leg length (hip to ankle).
constexpr double kAnkleHeight = 0.085;
constexpr double kFootLength = 0.29;
constexpr double kHeelShare = 0.25;  // Fraction of the foot's length behind the ankle.
constexpr double kFootWidth = 0.11;
// Radius of a limb segment relative to its length.
constexpr double kRadius = 0.15;

// Replaces each corner of the bounding box by the nearest touching point: feet are not rectangles,
// and corners outside them would touch the floor first. Keeps the corners if two of them share a
// point.
void take_touching_points(const std::vector<Eigen::Vector3d>& touching,
                          std::vector<Eigen::Vector3d>& corners) {
  std::vector<std::size_t> taken;
  for (const Eigen::Vector3d& corner : corners) {
    const auto nearest = std::ranges::min_element(touching, {}, [&](const Eigen::Vector3d& point) {
      const double x = point.x() - corner.x(), right = point.z() - corner.z();
      return x * x + right * right;
    });
    taken.push_back(static_cast<std::size_t>(nearest - touching.begin()));
  }
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (std::ranges::count(taken, taken[i]) > 1) return;
  }
  for (std::size_t i = 0; i < taken.size(); ++i) {
    corners[i].x() = touching[taken[i]].x();
    corners[i].z() = touching[taken[i]].z();
  }
}

class ShapeFinder {
 public:
  ShapeFinder(const Robot& robot, const RobotAnatomy& limbs, const MeshPoints& mesh)
      : robot_(robot),
        limbs_(limbs),
        mesh_(mesh.bodies),
        mesh_files_(mesh),
        tree_(robot.tree()),
        posed_(tree_, reference_configuration(robot)) {}

  RobotShapes find();

 private:
  void keep_model_shapes();
  void fit_meshes();
  void estimate_segments();
  void find_sole(std::size_t side);
  [[nodiscard]] bool has_shape(int body) const;
  [[nodiscard]] std::vector<RoundedShape> shapes_fixed_to(int body) const;
  [[nodiscard]] bool is_covered(int body, std::span<const Eigen::Vector3d> points,
                                double within) const;
  [[nodiscard]] std::vector<Eigen::Vector3d> foot_points(const LimbPart& foot) const;
  [[nodiscard]] double leg_length() const {
    return limbs_.legs[0].upper_length + limbs_.legs[0].lower_length;
  }

  const Robot& robot_;
  const RobotAnatomy& limbs_;
  const BodyPoints& mesh_;
  const MeshPoints& mesh_files_;
  const KinematicTree& tree_;
  TreeState posed_;
  bool touches_edge_ = false;  // Whether a foot with known shapes has no flat underside.
  RobotShapes found_;
};

bool ShapeFinder::has_shape(int body) const {
  return std::ranges::any_of(found_.shapes,
                             [&](const RoughShape& rough) { return rough.shape.body == body; });
}

// Returns the shapes of the bodies that move with a body, in its frame.
std::vector<RoundedShape> ShapeFinder::shapes_fixed_to(int body) const {
  std::vector<RoundedShape> shapes;
  const Pose body_from_world = posed_.world_from_body(body).inverse();
  for (const RoughShape& rough : found_.shapes) {
    const int part = rough.shape.body;
    if (tree_.carrier(part) != tree_.carrier(body)) continue;
    shapes.push_back(place(rough.shape, body_from_world * posed_.world_from_body(part)));
  }
  return shapes;
}

// Returns true if a body needs no further shape: it has one, or those of the bodies fixed to it are
// within a distance of most of its points. A hand at the end of a forearm does not cover it.
bool ShapeFinder::is_covered(int body, std::span<const Eigen::Vector3d> points,
                             double within) const {
  if (has_shape(body)) return true;
  const std::vector<RoundedShape> shapes = shapes_fixed_to(body);
  const auto is_near = [&](const Eigen::Vector3d& point) {
    RoundedShape probe;
    probe.centre = point;
    return std::ranges::any_of(shapes, [&](const RoundedShape& shape) {
      return shape_distance(probe, shape).distance < within;
    });
  };
  return 2 * std::ranges::count_if(points, is_near) > std::ssize(points);
}

void ShapeFinder::keep_model_shapes() {
  for (const CollisionShape& shape : contact_shapes(robot_)) {
    found_.shapes.push_back({shape, ShapeSource::kModel});
  }
}

void ShapeFinder::fit_meshes() {
  constexpr double kFinest = 0.005, kCoarser = 1.3;  // Cell size in metres; growth factor.
  constexpr std::size_t kEnough = 1000;
  constexpr double kSparse = 0.02;  // Metres.
  constexpr double kNear = 0.05;    // Fraction of the mesh's diagonal.
  // Added at the end: the mesh of one part does not replace that of another.
  std::vector<RoughShape> fitted;
  for (std::size_t b = 1; b < mesh_.size(); ++b) {
    const int body = static_cast<int>(b);
    if (mesh_[b].size() < 4) continue;
    const std::vector<Eigen::Vector3d> sparse = thinned(mesh_[b], kSparse);
    if (is_covered(body, sparse, kNear * diagonal_of(sparse))) continue;
    const auto add = [&](const CollisionShape& shape) {
      fitted.push_back({shape, ShapeSource::kMesh});
    };
    const auto foot = std::ranges::find_if(
        limbs_.legs, [&](const Limb& leg) { return leg.end && body == leg.end->body; });
    if (foot != limbs_.legs.end()) {
      add(box_around(body, mesh_[b], foot->end->body_from_bone));
      continue;
    }
    double cell = kFinest;
    std::vector<Eigen::Vector3d> points = thinned(mesh_[b], cell);
    while (points.size() > kEnough) points = thinned(points, cell *= kCoarser);
    const auto capsules = capsules_around(body, points);
    double sum = 0.0;
    for (const CollisionShape& capsule : capsules) sum += volume(capsule);
    const bool is_trunk = body == limbs_.pelvis || body == limbs_.torso;
    const CollisionShape box = box_around(
        body, mesh_[b], body == limbs_.pelvis ? limbs_.pelvis_from_hips : limbs_.torso_from_spine2);
    if (is_trunk && volume(box) < sum) {
      add(box);
    } else {
      for (const CollisionShape& capsule : capsules) add(capsule);
    }
  }
  found_.shapes.insert(found_.shapes.end(), fitted.begin(), fitted.end());
}

// Adds capsules along limb segments whose bodies have no shape.
void ShapeFinder::estimate_segments() {
  const auto add = [&](const LimbPart& part, double length) {
    const Eigen::Vector3d along = part.body_from_bone.col(0);
    std::vector<Eigen::Vector3d> on_bone;
    for (const double share : {0.25, 0.5, 0.75}) {
      on_bone.emplace_back(part.joint + share * length * along);
    }
    if (is_covered(part.body, on_bone, kRadius * length)) return;
    CollisionShape capsule;
    capsule.type = Type::kCapsule;
    capsule.body = part.body;
    capsule.radius = kRadius * length;
    capsule.half_length = 0.5 * length - capsule.radius;
    capsule.body_from_shape = {rotation_between(Eigen::Vector3d::UnitZ(), along).normalized(),
                               part.joint + 0.5 * length * along};
    found_.shapes.push_back({capsule, ShapeSource::kEstimated});
  };
  for (const auto* pair : {&limbs_.legs, &limbs_.arms}) {
    for (const Limb& limb : *pair) {
      if (limb.joints.empty()) continue;
      add(limb.upper, limb.upper_length);
      add(limb.lower, limb.lower_length);
    }
  }
}

// Returns the known points of the foot's surface, in its frame, including bodies fixed to it.
std::vector<Eigen::Vector3d> ShapeFinder::foot_points(const LimbPart& foot) const {
  const Eigen::Vector3d up = foot.body_from_bone.col(1);
  std::vector<Eigen::Vector3d> points;
  for (const FootBall& ball : foot_balls(contact_shapes(robot_), posed_, foot.body)) {
    points.emplace_back(ball.centre - ball.radius * up);
  }
  if (!points.empty()) return points;
  const Pose foot_from_world = posed_.world_from_body(foot.body).inverse();
  for (const int part : tree_.rigid_group(foot.body)) {
    if (static_cast<std::size_t>(part) >= mesh_.size()) continue;
    const Pose foot_from_part = foot_from_world * posed_.world_from_body(part);
    for (const Eigen::Vector3d& point : mesh_[part]) points.push_back(foot_from_part * point);
  }
  return points;
}

void ShapeFinder::find_sole(std::size_t side) {
  const LimbPart& foot = *limbs_.legs[side].end;
  const Eigen::Matrix3d& axes = foot.body_from_bone;  // Forward, up, right.
  std::vector<Eigen::Vector3d> points = foot_points(foot);
  Eigen::Vector3d lower = Eigen::Vector3d::Constant(INFINITY);
  Eigen::Vector3d upper = -lower;
  double lowest = INFINITY;
  const double level = kSoleLayer * leg_length();
  std::vector<Eigen::Vector3d> touching;  // Forward, up, right.
  for (const Eigen::Vector3d& point : points) {
    lowest = std::min(lowest, (axes.transpose() * (point - foot.joint)).y());
  }
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3d local = axes.transpose() * (point - foot.joint);
    if (local.y() > lowest + level) continue;
    touching.push_back(local);
    lower = lower.cwiseMin(local);
    upper = upper.cwiseMax(local);
  }
  const bool is_area = points.size() >= 3 && upper.x() - lower.x() > kLeastSole * leg_length();
  const bool of_model = std::ranges::any_of(found_.shapes, [&](const RoughShape& rough) {
    return tree_.carrier(rough.shape.body) == foot.body && rough.source == ShapeSource::kModel;
  });
  if (!is_area) {
    // The foot is unknown, or touches the floor in a point or a line.
    const double length = kFootLength * leg_length();
    if (points.empty()) lowest = -kAnkleHeight * leg_length();
    if (!points.empty()) touches_edge_ = true;
    lower = {-kHeelShare * length, lowest, -0.5 * kFootWidth * leg_length()};
    upper = {(1.0 - kHeelShare) * length, lowest, 0.5 * kFootWidth * leg_length()};
    found_.sole_source = ShapeSource::kEstimated;
  } else if (found_.sole_source == ShapeSource::kModel && !of_model) {
    found_.sole_source = ShapeSource::kMesh;
  }
  Sole sole;
  sole.side = side == 0 ? "left" : "right";
  sole.body = foot.body;
  sole.labels = {"heel_left", "heel_right", "toe_left", "toe_right"};
  std::vector<Eigen::Vector3d> corners;
  for (const double x : {lower.x(), upper.x()}) {
    for (const double right : {lower.z(), upper.z()}) corners.emplace_back(x, lowest, right);
  }
  if (is_area) take_touching_points(touching, corners);
  for (const Eigen::Vector3d& corner : corners) {
    sole.points.emplace_back(foot.joint + axes * corner);
  }
  found_.ankle_height += 0.5 * -lowest;
  found_.soles.push_back(sole);
  if (!has_shape(foot.body) && !(is_area && of_model)) {
    const double top = std::max(0.5 * -lowest, 1e-3);
    std::vector<Eigen::Vector3d> box = sole.points;
    for (const Eigen::Vector3d& point : sole.points) box.emplace_back(point + top * axes.col(1));
    found_.shapes.push_back({box_around(foot.body, box, axes), ShapeSource::kEstimated});
  }
}

// The human-readable name of a source, such as `mesh vertices`.
std::string source_text(ShapeSource source) {
  constexpr std::array kTexts = {"the model's contact geoms", "mesh vertices",
                                 "estimated from the limbs' lengths"};
  return kTexts[static_cast<std::size_t>(source)];
}

RobotShapes ShapeFinder::find() {
  keep_model_shapes();
  fit_meshes();
  estimate_segments();
  for (std::size_t side = 0; side < 2 && limbs_.has_legs; ++side) find_sole(side);
  found_.sole_note = limbs_.has_legs ? source_text(found_.sole_source) : "none (fixed base)";
  if (touches_edge_) {
    found_.sole_note +=
        " (in the zero configuration the shapes of a foot touch the floor only in a point or a "
        "line)";
  } else if (found_.sole_source == ShapeSource::kEstimated && mesh_files_.absent > 0) {
    found_.sole_note +=
        fmt::format(" ({} of {} mesh files of the model {} missing or unreadable, such as {})",
                    mesh_files_.absent, mesh_files_.named, mesh_files_.absent == 1 ? "is" : "are",
                    mesh_files_.example);
  }
  std::ranges::stable_sort(found_.shapes, {},
                           [](const RoughShape& rough) { return rough.shape.body; });
  return found_;
}

}  // namespace

RobotShapes find_shapes(const Robot& robot, const RobotAnatomy& limbs, const MeshPoints& mesh) {
  return ShapeFinder(robot, limbs, mesh).find();
}

namespace {

using Eigen::Vector3d;

// Adds the corners of a triangle, and interior points if it is large: a plate has vertices only at
// its corners.
void add_triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c,
                  std::vector<Vector3d>& points) {
  constexpr double kSpacing = 0.01;  // Metres.
  constexpr int kMost = 60;
  const double longest = std::max({(b - a).norm(), (c - a).norm(), (c - b).norm()});
  if (!(longest < 100.0)) return;
  const int steps = std::clamp(static_cast<int>(std::ceil(longest / kSpacing)), 1, kMost);
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; i + j <= steps; ++j) {
      points.emplace_back(a + (b - a) * (static_cast<double>(i) / steps) +
                          (c - a) * (static_cast<double>(j) / steps));
    }
  }
}

// Reads all meshes through MuJoCo, including those written in the model; fails if a file is
// missing.
BodyPoints points_by_mujoco(const std::string& model_path) {
  ModelChanges changes;
  changes.float_base = true;
  changes.keep_meshes = true;
  const auto loaded = load_model(model_path, changes);
  if (!loaded) return {};
  const mjModel& model = *loaded->model;
  BodyPoints points(static_cast<std::size_t>(model.nbody));
  for (int g = 0; g < model.ngeom; ++g) {
    const int mesh = model.geom_dataid[g];
    if (model.geom_type[g] != mjGEOM_MESH || mesh < 0) continue;
    const Pose body_from_geom = pose_at(model.geom_pos, model.geom_quat, g);
    std::vector<Vector3d>& of_body = points[static_cast<std::size_t>(model.geom_bodyid[g])];
    const auto corner = [&](int index) -> Vector3d {
      const float* vertex = model.mesh_vert + 3 * (model.mesh_vertadr[mesh] + index);
      return body_from_geom * Vector3d(vertex[0], vertex[1], vertex[2]);
    };
    for (int v = 0; v < model.mesh_vertnum[mesh]; ++v) of_body.push_back(corner(v));
    for (int f = 0; f < model.mesh_facenum[mesh]; ++f) {
      const int* face = model.mesh_face + 3 * (model.mesh_faceadr[mesh] + f);
      add_triangle(corner(face[0]), corner(face[1]), corner(face[2]), of_body);
    }
  }
  return points;
}

}  // namespace

MeshPoints mesh_points(const Robot& robot, const std::string& model_path) {
  MeshPoints points;
  const auto surfaces = read_body_surfaces(robot, model_path);
  if (surfaces) {
    points.named = surfaces->named;
    points.absent = surfaces->missing.size() + surfaces->unreadable.size();
    if (!surfaces->missing.empty()) {
      points.example = surfaces->missing.front();
    } else if (!surfaces->unreadable.empty()) {
      points.example = surfaces->unreadable.front().location.file;
    }
  }
  points.bodies = points_by_mujoco(model_path);
  if (!surfaces) return points;
  points.bodies.resize(robot.bodies().size());
  for (const auto& [body, mesh] : surfaces->bodies) {
    std::vector<Vector3d>& of_body = points.bodies[static_cast<std::size_t>(body)];
    // MuJoCo reads only the collision meshes of a URDF.
    if (!of_body.empty()) continue;
    of_body = mesh.vertices;
    for (const auto& [a, b, c] : mesh.triangles) {
      add_triangle(mesh.vertices[static_cast<std::size_t>(a)],
                   mesh.vertices[static_cast<std::size_t>(b)],
                   mesh.vertices[static_cast<std::size_t>(c)], of_body);
    }
  }
  return points;
}

}  // namespace retarget
