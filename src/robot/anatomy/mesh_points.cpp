// Samples points on bodies' surfaces from a model's meshes.

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robot/anatomy/shapes.h"
#include "robot/model/body_surfaces.h"
#include "robot/model/load_model.h"
#include "robot/model/model_values.h"

namespace retarget {
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
  if (!points.bodies.empty() || !surfaces) return points;
  points.bodies.resize(robot.bodies().size());
  for (const auto& [body, mesh] : surfaces->bodies) {
    std::vector<Vector3d>& of_body = points.bodies[static_cast<std::size_t>(body)];
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
