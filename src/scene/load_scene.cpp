#include <tinyxml2.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "base/parse_xml.h"
#include "base/try.h"
#include "retarget/file.h"
#include "retarget/scene.h"
#include "retarget/text.h"
#include "scene/read_scene.h"
#include "scene/scene_shapes.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using Type = SceneShape::Type;
using Bodies = std::vector<SceneBody>;

Result<Bodies> read_mesh_scene(const std::string& file, double reach) {
  TRY_ASSIGN(const TriangleMesh mesh, load_scene_mesh(file, ColladaAxes::kZUp, reach));
  SceneBody body;
  body.name = fs::path(file).stem().string();
  body.shapes = shapes_of_mesh(mesh, {});
  if (body.shapes.empty()) return input_failure(file, "its triangles have no area");
  return Bodies{std::move(body)};
}

Result<Bodies> read_xml_scene(const std::string& file, double reach) {
  std::error_code ignored;
  if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored)) {
    return input_failure(file, "a scene must be a regular file");
  }
  TRY_ASSIGN(const auto text, read_file(file, ErrorKind::kInput, kMaxTextBytes));
  tinyxml2::XMLDocument document;
  if (auto parsed = parse_xml(text.view(), document); !parsed) {
    Error error = std::move(parsed).error();
    error.location.file = file;
    return failure(std::move(error));
  }
  const tinyxml2::XMLElement* top = document.RootElement();
  const std::string kind = top == nullptr ? std::string() : top->Name();
  if (kind == "robot") return read_urdf_scene(file, reach);
  if (kind == "mujoco") return read_mjcf_scene(file, reach);
  if (kind == "mujocoinclude") {
    return input_failure(file, "the file is only a fragment of an MJCF model",
                         "load the model that includes it, or write <mujoco><worldbody> around its "
                         "bodies");
  }
  return input_failure(
      file, "found <" + kind.substr(0, 40) + ">: expected <mujoco> (MJCF) or <robot> (URDF)");
}

Result<Bodies> read_bodies(const std::string& file, double reach) {
  const std::string ending = lower_case(fs::path(file).extension().string());
  if (ending == ".json") return read_json_scene(file, reach);
  if (ending == ".obj" || ending == ".stl" || ending == ".dae") return read_mesh_scene(file, reach);
  if (ending == ".xml" || ending == ".mjcf" || ending == ".urdf")
    return read_xml_scene(file, reach);
  return input_failure(file, "a scene must be JSON, MJCF, URDF, OBJ, STL or COLLADA",
                       "the file name must end in .json, .xml, .mjcf, .urdf, .obj, .stl or .dae");
}

// Whether a shape is the floor that every clip has: a plane that faces up at z = 0.
bool is_floor(const SceneBody& body, const SceneShape& shape) {
  constexpr double kSame = 1e-6;
  if (shape.type != Type::kPlane || body.moves) return false;
  const Pose world = body.world_from_body * shape.body_from_shape;
  const Vector3d up = world.rotation * Vector3d::UnitZ();
  return (up - Vector3d::UnitZ()).norm() < kSame && std::abs(world.translation.z()) < kSame;
}

bool is_finite(const Pose& pose) {
  return pose.rotation.coeffs().allFinite() && pose.translation.allFinite();
}

// Checks the numbers of a shape, which readers need not check.
bool is_sound(const SceneShape& shape, double reach) {
  if (!is_finite(shape.body_from_shape)) return false;
  if (shape.body_from_shape.translation.cwiseAbs().maxCoeff() > reach) return false;
  const auto fits = [reach](double size) { return size > 0.0 && size <= reach; };
  const bool has_radius =
      shape.type == Type::kSphere || shape.type == Type::kCapsule || shape.type == Type::kCylinder;
  if (has_radius && !fits(shape.radius)) return false;
  if (shape.type == Type::kCylinder) return fits(shape.half_length);
  if (shape.type == Type::kCapsule) return shape.half_length == 0.0 || fits(shape.half_length);
  if (shape.type == Type::kBox) {
    return fits(shape.half_size.x()) && fits(shape.half_size.y()) && fits(shape.half_size.z());
  }
  return true;
}

Result<void> check_bodies(const Bodies& bodies, const std::string& file, double reach) {
  for (const SceneBody& body : bodies) {
    const std::string name = "the body \"" + body.name + "\"";
    if (!is_finite(body.world_from_body) ||
        body.world_from_body.translation.cwiseAbs().maxCoeff() > reach) {
      return input_failure(file, name + " is not within " + reach_text(reach) + " of the origin");
    }
    const auto sound = [&](const SceneShape& shape) { return is_sound(shape, reach); };
    if (!std::ranges::all_of(body.shapes, sound)) {
      return input_failure(
          file, name + " has a shape whose size or position is not a positive number of at most " +
                    reach_text(reach));
    }
  }
  return {};
}

// Names unnamed bodies, and numbers bodies with the name of an earlier one.
void name_bodies(Bodies& bodies) {
  std::set<std::string> taken;
  for (const SceneBody& body : bodies) taken.insert(body.name);
  std::set<std::string> used = {""};
  for (SceneBody& body : bodies) {
    if (used.insert(body.name).second) continue;
    const std::string word = body.name.empty() ? "body" : body.name;
    for (int number = body.name.empty() ? 1 : 2;; ++number) {
      std::string name = word + "_" + std::to_string(number);
      if (!taken.insert(name).second) continue;
      used.insert(name);
      body.name = std::move(name);
      break;
    }
  }
}

}  // namespace

std::vector<SceneBody> bodies_of_links(const std::vector<SceneLink>& links) {
  struct Placed {
    std::size_t owner;  // The link that carries the shapes.
    Pose world_from_link;
  };
  std::vector<Placed> placed;
  std::vector<SceneBody> all;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const SceneLink& link = links[i];
    SceneBody body = link.body;
    Placed place{i, link.parent_from_link};
    if (link.parent >= 0) {
      const Placed& parent = placed[static_cast<std::size_t>(link.parent)];
      place.world_from_link = parent.world_from_link * link.parent_from_link;
      if (all[parent.owner].moves && !body.moves) place.owner = parent.owner;
    }
    body.world_from_body = place.world_from_link;
    if (place.owner != i) {
      SceneBody& owner = all[place.owner];
      const Pose owner_from_link = owner.world_from_body.inverse() * place.world_from_link;
      for (SceneShape& shape : body.shapes) {
        shape.body_from_shape = owner_from_link * shape.body_from_shape;
        owner.shapes.push_back(std::move(shape));
      }
      owner.mass += body.mass;
      body.shapes.clear();
    }
    placed.push_back(place);
    all.push_back(std::move(body));
  }
  std::erase_if(all, [](const SceneBody& body) { return body.shapes.empty(); });
  return all;
}

Result<Scene> load_scene(const std::string& file) {
  return load_scene_in_unit(file, 1.0);
}

Result<Scene> load_scene_in_unit(const std::string& file, double metres_per_unit) {
  if (file == "-") return input_failure("", "a scene cannot come from standard input");
  const double reach = kMaxSceneReach / metres_per_unit;
  auto bodies = read_bodies(file, reach);
  if (!bodies) {
    Error error = std::move(bodies).error();
    error.kind = ErrorKind::kInput;
    return failure(std::move(error));
  }
  TRY(check_bodies(*bodies, file, reach));
  bool has_floor = false;
  for (SceneBody& body : *bodies) {
    const auto floors =
        std::erase_if(body.shapes, [&](const SceneShape& shape) { return is_floor(body, shape); });
    has_floor = has_floor || floors > 0;
  }
  std::erase_if(*bodies, [](const SceneBody& body) { return body.shapes.empty(); });
  if (bodies->empty()) {
    return input_failure(file, has_floor
                                   ? "the scene only contains a floor, which every clip already has"
                                   : "the scene has no shapes");
  }
  name_bodies(*bodies);
  return Scene{fs::path(file).filename().string(), std::move(*bodies)};
}

}  // namespace retarget
