// Any bytes as a scene, JSON, URDF or OBJ, and as the track of an object.

#include <algorithm>
#include <cmath>
#include <string_view>

#include "fuzz/fuzz_target.h"
#include "retarget/scene.h"

namespace retarget::fuzz {
namespace {

void check_pose(const Pose& pose) {
  require(pose.translation.allFinite(), "positions are finite");
  require(std::abs(pose.rotation.norm() - 1.0) < 1e-6, "quaternions have unit length");
}

// Grids of large meshes would take all the time.
bool is_small(const SceneBody& body) {
  constexpr std::size_t kMost = 60;
  return std::ranges::all_of(body.shapes, [](const SceneShape& shape) {
    return !shape.mesh || shape.mesh->triangles.size() <= kMost;
  });
}

void check_distances(const SceneBody& body) {
  const auto field = make_distance_field(body);
  if (!good(field)) return;
  for (const double x : {-1.0, 0.0, 0.3}) {
    const SurfaceDistance found = field->at({x, 0.2, -0.1});
    require(std::isfinite(found.distance), "distances are finite");
    require(std::abs(found.normal.norm() - 1.0) < 1e-6, "normals have unit length");
  }
}

}  // namespace

void fuzz_scene(std::string_view bytes) {
  // MuJoCo reads MJCF, and its errors cannot be fixed here.
  if (bytes.find("<mujoco") != std::string_view::npos) return;
  for (const char* name : {"scene.json", "scene.urdf", "scene.obj"}) {
    const auto scene = load_scene(file_of(bytes, name));
    if (!good(scene)) continue;
    require(!scene->bodies.empty(), "scenes have bodies");
    for (const SceneBody& body : scene->bodies) {
      require(!body.name.empty() && !body.shapes.empty(), "bodies have names and shapes");
      check_pose(body.world_from_body);
      for (const SceneShape& shape : body.shapes) check_pose(shape.body_from_shape);
      if (is_small(body)) check_distances(body);
    }
  }
}

void fuzz_object_track(std::string_view bytes) {
  for (const char* name : {"track.csv", "track.npy", "track.npz", "track.pt"}) {
    const auto track = load_object_track(file_of(bytes, name));
    if (!good(track)) continue;
    require(!track->world_from_body.empty(), "tracks have poses");
    std::ranges::for_each(track->world_from_body, check_pose);
  }
}

}  // namespace retarget::fuzz
