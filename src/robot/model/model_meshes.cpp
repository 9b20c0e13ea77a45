#include "robot/model/model_meshes.h"

#include <tinyxml2.h>
#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "base/parse_xml.h"
#include "base/try.h"
#include "retarget/file.h"
#include "retarget/so3.h"
#include "retarget/text.h"
#include "robot/model/check_model.h"
#include "robot/model/load_model.h"
#include "robot/model/read_mesh.h"
#include "robot/model/urdf_extras.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using tinyxml2::XMLElement;

// Parses three numbers; returns `otherwise` if the attribute is missing or malformed.
Vector3d vector_of(const XMLElement* element, const char* name, const Vector3d& otherwise) {
  const std::string text = attribute_of(element, name);
  std::string_view rest = text;
  Vector3d vector;
  for (double& value : vector) {
    const auto number = number_from_text(take_word(rest));
    if (!number) return otherwise;
    value = *number;
  }
  return vector;
}

// URDF applies roll, pitch and yaw about fixed axes.
Pose origin_of(const XMLElement& element) {
  const XMLElement* origin = element.FirstChildElement("origin");
  const Vector3d angles = vector_of(origin, "rpy", Vector3d::Zero());
  return {exp_so3(angles.z() * Vector3d::UnitZ()) * exp_so3(angles.y() * Vector3d::UnitY()) *
              exp_so3(angles.x() * Vector3d::UnitX()),
          vector_of(origin, "xyz", Vector3d::Zero())};
}

// Links indexed by the link that they are fixed to.
class FixedLinks {
 public:
  explicit FixedLinks(const XMLElement& robot) {
    for (const XMLElement* joint : children_of(robot, "joint")) {
      if (attribute_of(joint, "type") != "fixed") continue;
      parents_[attribute_of(joint->FirstChildElement("child"), "link")] = {
          attribute_of(joint->FirstChildElement("parent"), "link"), origin_of(*joint)};
    }
  }

  [[nodiscard]] std::vector<ModelMesh::Carrier> carriers(std::string link, Pose pose) const {
    std::vector<ModelMesh::Carrier> carriers = {{link, pose}};
    // The bound ends the walk if the file's joints form a cycle.
    for (auto found = parents_.find(link);
         found != parents_.end() && carriers.size() <= parents_.size();
         found = parents_.find(link)) {
      link = found->second.body;
      pose = found->second.body_from_mesh * pose;
      carriers.push_back({link, pose});
    }
    return carriers;
  }

 private:
  std::map<std::string, ModelMesh::Carrier> parents_;  // Parent link, and the child's pose in it,
                                                       // by child link.
};

// Adds the meshes of `<visual>` or `<collision>` elements.
void add_meshes(const XMLElement& link, const char* kind, const FixedLinks& fixed,
                std::vector<ModelMesh>& meshes) {
  for (const XMLElement* shape : children_of(link, kind)) {
    const XMLElement* geometry = shape->FirstChildElement("geometry");
    const XMLElement* mesh = geometry == nullptr ? nullptr : geometry->FirstChildElement("mesh");
    ModelMesh found;
    found.file = attribute_of(mesh, "filename");
    if (found.file.empty()) continue;
    found.scale = vector_of(mesh, "scale", Vector3d::Ones());
    found.is_visual = std::string_view(kind) == "visual";
    found.carriers = fixed.carriers(attribute_of(&link, "name"), origin_of(*shape));
    meshes.push_back(std::move(found));
  }
}

// A link without visual meshes uses its collision meshes.
std::vector<ModelMesh> urdf_meshes(const XMLElement& robot) {
  const FixedLinks fixed(robot);
  std::vector<ModelMesh> meshes;
  for (const XMLElement* link : children_of(robot, "link")) {
    const std::size_t before = meshes.size();
    add_meshes(*link, "visual", fixed, meshes);
    if (meshes.size() == before) add_meshes(*link, "collision", fixed, meshes);
  }
  return meshes;
}

}  // namespace

namespace {

namespace fs = std::filesystem;

// A mesh of the model, placed on a body of the robot.
struct PlacedMesh {
  const ModelMesh* mesh = nullptr;
  Pose body_from_mesh;
};

// Visual meshes take precedence: collision meshes often duplicate them.
std::map<int, std::vector<PlacedMesh>> by_body(const Robot& robot,
                                               const std::vector<ModelMesh>& meshes) {
  std::map<int, std::vector<PlacedMesh>> bodies;
  for (const ModelMesh& mesh : meshes) {
    for (const auto& [name, pose] : mesh.carriers) {
      const auto body = robot.find_body(name);
      if (!body) continue;
      bodies[*body].push_back({&mesh, pose});
      break;
    }
  }
  for (auto& [body, placed] : bodies) {
    const auto is_seen = [](const PlacedMesh& each) { return each.mesh->is_visual; };
    if (std::ranges::any_of(placed, is_seen)) {
      std::erase_if(placed, [&](const PlacedMesh& each) { return !is_seen(each); });
    }
  }
  return bodies;
}

class SurfaceReader {
 public:
  SurfaceReader(fs::path model, std::string folder)
      : model_(std::move(model)), folder_(std::move(folder)) {}

  Result<TriangleMesh> read(const std::vector<PlacedMesh>& meshes);
  std::vector<std::string> take_missing() { return std::move(missing_); }

 private:
  Result<const TriangleMesh*> mesh_of_file(const std::string& path);

  const fs::path model_;
  const std::string folder_;
  std::map<std::string, TriangleMesh> known_;  // Left and right links often share a mesh.
  std::vector<std::string> missing_;
};

Result<const TriangleMesh*> SurfaceReader::mesh_of_file(const std::string& path) {
  const auto found = known_.find(path);
  if (found != known_.end()) return &found->second;
  TRY_ASSIGN(const FileContent content, read_mesh_file(path));
  TRY_ASSIGN(TriangleMesh mesh, read_mesh_as_written(content.view(), path));
  return &known_.emplace(path, std::move(mesh)).first->second;
}

// Merges all meshes of a body; returns no triangles if a file is missing.
Result<TriangleMesh> SurfaceReader::read(const std::vector<PlacedMesh>& meshes) {
  TriangleMesh all;
  std::string files;
  bool complete = true;
  for (const auto& [mesh, body_from_mesh] : meshes) {
    const auto path = find_mesh_file(mesh->file, model_, folder_);
    if (!path) {
      complete = false;
      missing_.push_back(mesh->file);
      continue;
    }
    files = path->string();
    TRY_ASSIGN(const TriangleMesh* read, mesh_of_file(files));
    const auto first = static_cast<int>(all.vertices.size());
    const Pose mesh_from_file = mesh->file_from_mesh.inverse();
    for (const Eigen::Vector3d& vertex : read->vertices) {
      all.vertices.push_back(body_from_mesh *
                             Eigen::Vector3d(mesh->scale.cwiseProduct(mesh_from_file * vertex)));
    }
    const bool mirrored = mesh->scale.prod() < 0.0;
    for (const auto& [a, b, c] : read->triangles) {
      all.triangles.push_back({first + a, first + (mirrored ? c : b), first + (mirrored ? b : c)});
    }
  }
  if (!complete) return TriangleMesh();
  TRY(check_mesh_reach(all, files));
  return all;
}

// Lists the meshes of an MJCF or URDF file without reading them; the mesh files need not exist.
// Errors (kConfig): load_model's; mesh files outside the model's package (check_model).
Result<std::vector<ModelMesh>> model_meshes(const std::string& path) {
  TRY(check_model(path, true));
  TRY_ASSIGN(const auto text, read_file(path, ErrorKind::kConfig));
  tinyxml2::XMLDocument document;
  static_cast<void>(parse_xml(text.view(), document));
  const XMLElement* top = document.RootElement();
  if (top != nullptr && is_urdf(*top)) return urdf_meshes(*top);
  ModelChanges changes;
  changes.find_meshes = true;
  TRY_ASSIGN(LoadedModel loaded, load_model(path, changes));
  return std::move(loaded.meshes);
}

}  // namespace

Result<BodySurfaces> read_body_surfaces(const Robot& robot, const std::string& model,
                                        const std::string& folder) {
  TRY_ASSIGN(const auto meshes, model_meshes(model));
  BodySurfaces surfaces;
  SurfaceReader reader(model, folder);
  for (const auto& [body, placed] : by_body(robot, meshes)) {
    surfaces.named += placed.size();
    auto mesh = reader.read(placed);
    if (!mesh) {
      surfaces.unreadable.push_back(std::move(mesh.error()));
    } else if (!mesh->triangles.empty()) {
      surfaces.bodies.emplace(body, std::move(*mesh));
    }
  }
  surfaces.missing = reader.take_missing();
  return surfaces;
}

}  // namespace retarget
