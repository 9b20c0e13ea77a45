#include "view/scene_data.h"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

#include "retarget/text.h"
#include "retarget/try.h"
#include "retarget/view.h"
#include "view/page_data.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

// About ten megabytes of a page each.
constexpr std::size_t kMaxSceneTriangles = 300'000;
constexpr std::size_t kMaxSceneShapes = 20'000;
constexpr std::size_t kMaxScenePoses = 1'000'000;

// The poses of a world: those of static bodies as numbers, those of moving bodies as tracks.
Result<Json> world_json(const SceneClip& world, TrackPacker& packer) {
  const std::vector<SceneBody>& bodies = world.scene->bodies;
  Json poses = Json::array();
  std::vector<std::size_t> moving;
  for (std::size_t body = 0; body < bodies.size(); ++body) {
    if (bodies[body].moves && world.frame_count > 0) {
      moving.push_back(body);
      poses.push_back(nullptr);
    } else {
      poses.push_back(
          page_pose(world.frame_count > 0 ? world.pose(0, body) : bodies[body].world_from_body));
    }
  }
  Json json = {{"frames", world.frame_count}, {"poses", std::move(poses)}};
  if (moving.empty()) return json;
  std::vector<double> positions, rotations;
  for (int frame = 0; frame < world.frame_count; ++frame) {
    for (const std::size_t body : moving) {
      const Pose& pose = world.pose(frame, body);
      positions.insert(positions.end(), pose.translation.begin(), pose.translation.end());
      const Eigen::Quaterniond& q = pose.rotation;
      rotations.insert(rotations.end(), {q.w(), q.x(), q.y(), q.z()});
    }
  }
  const auto count = static_cast<int>(moving.size());
  RETARGET_TRY_ASSIGN(json["position"], packer.add(3 * count, kPageRootStep, positions));
  RETARGET_TRY_ASSIGN(json["rotation"], packer.add(4 * count, kPageQuaternionStep, rotations));
  return json;
}

}  // namespace

std::string scene_excess(const SceneClip& scene) {
  std::size_t triangles = 0, shapes = 0, moving = 0;
  for (const SceneBody& body : scene.scene->bodies) {
    shapes += body.shapes.size();
    if (body.moves) ++moving;
    for (const SceneShape& shape : body.shapes) {
      if (shape.mesh) triangles += shape.mesh->triangles.size();
    }
  }
  const std::size_t poses = moving * static_cast<std::size_t>(scene.frame_count);
  const auto text = [](std::size_t count, const char* noun, std::size_t most) {
    const char* of = std::string_view(noun) == "pose" ? " of moving bodies" : "";
    return count_text(count, noun) + of + ", at most " + std::to_string(most) + " fit on a page";
  };
  if (triangles > kMaxSceneTriangles) return text(triangles, "triangle", kMaxSceneTriangles);
  if (shapes > kMaxSceneShapes) return text(shapes, "shape", kMaxSceneShapes);
  if (poses > kMaxScenePoses) return text(poses, "pose", kMaxScenePoses);
  return {};
}

std::vector<SummaryLine> scene_lines(const SceneClip* scene) {
  if (scene == nullptr) return {};
  const std::string excess = scene_excess(*scene);
  if (excess.empty()) return {};
  return {{"scene", "omitted from the page: " + excess}};
}

Result<void> pack_mesh(const TriangleMesh& mesh, TrackPacker& packer, Json& json) {
  std::vector<double> vertices, corners;
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    vertices.insert(vertices.end(), vertex.begin(), vertex.end());
  }
  for (const auto& triangle : mesh.triangles) {
    corners.insert(corners.end(), triangle.begin(), triangle.end());
  }
  RETARGET_TRY_ASSIGN(json["vertices"], packer.add(3, kPageMeshStep, vertices));
  RETARGET_TRY_ASSIGN(json["triangles"], packer.add(3, 1.0, corners));
  return {};
}

Result<Json> ScenePacker::shape_json(const SceneShape& shape, TrackPacker& packer) {
  Json json = {{"pose", page_pose(shape.body_from_shape)}};
  switch (shape.type) {
    case SceneShape::Type::kPlane:
      json["plane"] = true;
      break;
    case SceneShape::Type::kBox:
      json["box"] = {shape.half_size.x(), shape.half_size.y(), shape.half_size.z()};
      break;
    case SceneShape::Type::kSphere:
      json["sphere"] = shape.radius;
      break;
    case SceneShape::Type::kCapsule:
      json["capsule"] = {shape.radius, shape.half_length};
      break;
    case SceneShape::Type::kCylinder:
      json["cylinder"] = {shape.radius, shape.half_length};
      break;
    case SceneShape::Type::kMesh:
      Json& mesh = meshes_[shape.mesh.get()];
      if (mesh.is_null()) RETARGET_TRY(pack_mesh(*shape.mesh, packer, mesh));
      json["mesh"] = mesh;
      break;
  }
  return json;
}

Result<Json> ScenePacker::pack(const MotionScene& scene, TrackPacker& packer) {
  Json bodies = Json::array();
  for (const SceneBody& body : scene.robot.scene->bodies) {
    Json shapes = Json::array();
    for (const SceneShape& shape : body.shapes) {
      RETARGET_TRY_ASSIGN(Json json, shape_json(shape, packer));
      shapes.push_back(std::move(json));
    }
    bodies.push_back({{"name", body.name}, {"shapes", std::move(shapes)}});
  }
  Json json = {{"bodies", std::move(bodies)}, {"scale", scene.scale}};
  RETARGET_TRY_ASSIGN(json["robot"], world_json(scene.robot, packer));
  if (scene.human) {
    RETARGET_TRY_ASSIGN(json["human"], world_json(*scene.human, packer));
  }
  return json;
}

Json page_touches(const ContactLabels& labels, int frames) {
  std::vector<const SurfaceTouch*> sorted;
  for (const SurfaceTouch& touch : labels.touches) {
    if (touch.surface != kFloorName && touch.begin < frames) sorted.push_back(&touch);
  }
  std::ranges::stable_sort(sorted, {}, &SurfaceTouch::begin);
  Json json = Json::array();
  for (const SurfaceTouch& label : labels.touches) {
    const auto is_same = [&](const auto& row) {
      return row["part"] == label.part && row["surface"] == label.surface;
    };
    if (std::any_of(json.begin(), json.end(), is_same)) continue;
    Json phases = Json::array();
    for (const SurfaceTouch* touch : sorted) {
      if (touch->part != label.part || touch->surface != label.surface) continue;
      phases.push_back({touch->begin, std::min(touch->end, frames)});
    }
    if (phases.empty()) continue;
    json.push_back(
        {{"part", label.part}, {"surface", label.surface}, {"phases", std::move(phases)}});
  }
  return json;
}

}  // namespace retarget
