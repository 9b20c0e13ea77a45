#include "retarget/write_scene.h"

#include <fmt/format.h>
#include <filesystem>

#include "base/json.h"
#include "base/option_name.h"
#include "base/try.h"
#include "retarget/text.h"
#include "scene/scene_shapes.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;
using Type = SceneShape::Type;

Json json_of(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

void put_pose(Json& json, const Pose& pose) {
  json["position"] = json_of(pose.translation);
  const Eigen::Quaterniond& q = pose.rotation;
  json["quaternion"] = {q.w(), q.x(), q.y(), q.z()};
}

void put_mesh(Json& json, const TriangleMesh& mesh) {
  Json vertices = Json::array();
  for (const Vector3d& vertex : mesh.vertices) vertices.push_back(json_of(vertex));
  json["vertices"] = std::move(vertices);
  json["triangles"] = mesh.triangles;
}

Json json_of(const SceneShape& shape) {
  Json json;
  const auto put_round = [&](const char* type) {
    json["type"] = type;
    json["radius"] = shape.radius;
  };
  switch (shape.type) {
    case Type::kPlane:
      json["type"] = "plane";
      break;
    case Type::kBox:
      json["type"] = "box";
      json["size"] = json_of(2.0 * shape.half_size);
      break;
    case Type::kSphere:
      put_round("sphere");
      break;
    case Type::kCapsule:
    case Type::kCylinder:
      // A capsule without length is a sphere.
      put_round(shape.half_length == 0.0       ? "sphere"
                : shape.type == Type::kCapsule ? "capsule"
                                               : "cylinder");
      if (shape.half_length > 0.0) json["length"] = 2.0 * shape.half_length;
      break;
    case Type::kMesh:
      json["type"] = "mesh";
      put_mesh(json, *shape.mesh);
      break;
  }
  put_pose(json, shape.body_from_shape);
  return json;
}

Pose first_pose(const SceneClip& scene, std::size_t body) {
  return scene.frame_count > 0 ? scene.pose(0, body) : scene.scene->bodies[body].world_from_body;
}

std::string ending_of_scene(const std::string& file) {
  return lower_case(std::filesystem::path(file).extension().string());
}

}  // namespace

std::string format_scene_json(const SceneClip& scene) {
  Json bodies = Json::array();
  for (std::size_t i = 0; i < scene.scene->bodies.size(); ++i) {
    const SceneBody& body = scene.scene->bodies[i];
    Json json;
    json["name"] = body.name;
    put_pose(json, first_pose(scene, i));
    if (body.moves) json["moves"] = true;
    if (body.mass > 0.0) json["mass"] = body.mass;
    for (const SceneShape& shape : body.shapes) json["shapes"].push_back(json_of(shape));
    bodies.push_back(std::move(json));
  }
  return Json{{"bodies", std::move(bodies)}}.dump(2) + "\n";
}

std::string format_scene_obj(const SceneClip& scene) {
  std::string text = "# Static bodies; metres, z up\n";
  std::size_t first = 1;
  for (std::size_t i = 0; i < scene.scene->bodies.size(); ++i) {
    const SceneBody& body = scene.scene->bodies[i];
    if (body.moves) continue;
    const Pose world_from_body = first_pose(scene, i);
    text += fmt::format("o {}\n", body.name);
    for (const SceneShape& shape : body.shapes) {
      const TriangleMesh mesh = mesh_of_shape(shape);
      for (const Vector3d& vertex : mesh.vertices) {
        const Vector3d v = world_from_body * vertex;
        text += fmt::format("v {:.6f} {:.6f} {:.6f}\n", v.x(), v.y(), v.z());
      }
      for (const auto& corners : mesh.triangles) {
        text += 'f';
        for (const int corner : corners) {
          text += fmt::format(" {}", first + static_cast<std::size_t>(corner));
        }
        text += '\n';
      }
      first += mesh.vertices.size();
    }
  }
  return text;
}

Result<void> check_scene_ending(const std::string& file) {
  const std::string ending = ending_of_scene(file);
  if (ending == ".xml" || ending == ".json" || ending == ".obj") return {};
  return usage_failure(
      OPTION("scene-out") " must end in .xml, .json or .obj, found \"" + file + "\"",
      ".xml: robot and scene as MJCF; .json: the scene; .obj: its static bodies");
}

Result<std::string> format_scene(const std::string& file, const RobotClip& motion,
                                 const SceneClip& scene) {
  TRY(check_scene_ending(file));
  const std::string ending = ending_of_scene(file);
  if (ending == ".xml") return format_scene_mjcf(motion, scene);
  return ending == ".json" ? format_scene_json(scene) : format_scene_obj(scene);
}

}  // namespace retarget
