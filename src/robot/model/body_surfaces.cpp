#include "robot/model/body_surfaces.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "base/try.h"
#include "robot/model/mesh_files.h"
#include "robot/model/model_meshes.h"
#include "robot/model/read_mesh.h"

namespace retarget {
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
