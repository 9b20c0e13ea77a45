#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include "base/file.h"
#include "base/lower_case.h"
#include "base/number_text.h"
#include "base/plain_name.h"
#include "base/try.h"
#include "retarget/view.h"
#include "robot/model_meshes.h"
#include "view/mesh_files.h"
#include "view/triangle_mesh.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxBytes = std::size_t{64} << 20U;
constexpr std::size_t kMaxTriangles = 1600;  // of a body

Result<FileContent> read_mesh_file(const std::string& path) {
  return read_file(path, ErrorKind::kInput, kMaxBytes, "meshes for a page need not be that fine");
}

Result<TriangleMesh> simple_mesh(const TriangleMesh& mesh, const std::string& file) {
  TriangleMesh simple = simplified(mesh, kMaxTriangles);
  // all at one place
  if (simple.triangles.empty()) return input_failure(file, "its triangles have no area");
  return simple;
}

// a mesh of a model on a body of the robot
struct PlacedMesh {
  const ModelMesh* mesh = nullptr;
  Pose body_from_mesh;
};

class RobotMeshLoader {
 public:
  RobotMeshLoader(const Robot& robot, std::string folder, bool must)
      : robot_(robot), folder_(std::move(folder)), must_(must), covered_(robot.bodies().size()) {}

  Result<void> add_model(const std::string& model);
  Result<void> add_folder();
  [[nodiscard]] RobotMeshes finish();

 private:
  [[nodiscard]] std::map<int, std::vector<PlacedMesh>> by_body(
      const std::vector<ModelMesh>& meshes) const;
  Result<TriangleMesh> body_mesh(const std::vector<PlacedMesh>& meshes, const fs::path& model);
  Result<const TriangleMesh*> mesh_of_file(const std::string& path);
  void note_missing(const std::string& model, std::size_t files);

  const Robot& robot_;
  const std::string folder_;
  const bool must_;            // errors are errors, and not notes
  std::vector<bool> covered_;  // by body
  std::map<std::string, TriangleMesh> known_;
  std::vector<std::string> missing_;     // as the model names them
  std::vector<std::string> unreadable_;  // and why
  RobotMeshes result_;
};

// those that are only seen go before those that collide, which are often the same once more
std::map<int, std::vector<PlacedMesh>> RobotMeshLoader::by_body(
    const std::vector<ModelMesh>& meshes) const {
  std::map<int, std::vector<PlacedMesh>> bodies;
  for (const ModelMesh& mesh : meshes) {
    for (const auto& [name, pose] : mesh.carriers) {
      const auto body = robot_.find_body(name);
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

Result<const TriangleMesh*> RobotMeshLoader::mesh_of_file(const std::string& path) {
  const auto found = known_.find(path);
  if (found != known_.end()) return &found->second;
  TRY_ASSIGN(const FileContent content, read_mesh_file(path));
  TRY_ASSIGN(TriangleMesh mesh, read_mesh_as_written(content.view(), path));
  return &known_.emplace(path, std::move(mesh)).first->second;
}

// all of a body's meshes as one; without triangles where a file is missing
Result<TriangleMesh> RobotMeshLoader::body_mesh(const std::vector<PlacedMesh>& meshes,
                                                const fs::path& model) {
  TriangleMesh all;
  std::string files;
  bool complete = true;
  for (const auto& [mesh, body_from_mesh] : meshes) {
    const auto path = find_mesh_file(mesh->file, model, folder_);
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
  return simple_mesh(all, files);
}

Result<void> RobotMeshLoader::add_model(const std::string& model) {
  const auto meshes = model_meshes(model);
  if (!meshes && must_ && folder_.empty()) return failure(meshes.error());
  if (!meshes) {
    result_.notes.push_back("the meshes of " + fs::path(model).filename().string() +
                            " are not drawn: " + meshes.error().message);
    return {};
  }
  std::size_t files = 0;
  for (const auto& [body, placed] : by_body(*meshes)) {
    files += placed.size();
    auto mesh = body_mesh(placed, model);
    if (!mesh && must_) return failure(mesh.error());
    if (!mesh) {
      unreadable_.push_back(fs::path(mesh.error().location.file).filename().string() + ": " +
                            mesh.error().message);
    } else if (!mesh->triangles.empty()) {
      covered_[static_cast<std::size_t>(body)] = true;
      result_.bodies.push_back({body, std::move(*mesh)});
    }
  }
  note_missing(fs::path(model).filename().string(), files);
  return {};
}

void RobotMeshLoader::note_missing(const std::string& model, std::size_t files) {
  const std::string primitives = "; primitives are drawn in their place";
  if (!missing_.empty()) {
    const bool none = missing_.size() == files;
    result_.notes.push_back((none ? "no mesh file that " + model + " names is there, such as "
                                  : count_text(missing_.size(), "mesh file") + " of " +
                                        std::to_string(files) + " that " + model + " names " +
                                        (missing_.size() == 1 ? "is" : "are") +
                                        " not there, such as ") +
                            missing_.front() + primitives);
  }
  if (!unreadable_.empty()) {
    result_.notes.push_back("the meshes of " +
                            (unreadable_.size() == 1
                                 ? std::string("a body")
                                 : std::to_string(unreadable_.size()) + " bodies") +
                            " cannot be read: " + unreadable_.front() + primitives);
  }
}

Result<void> RobotMeshLoader::add_folder() {
  const std::vector<MeshFile> files = mesh_files(folder_);
  for (std::size_t i = 1; i < robot_.bodies().size(); ++i) {
    const std::string& name = robot_.bodies()[i].name;
    const auto path = name.empty() || covered_[i] ? std::nullopt : file_of_body(files, name);
    if (!path) continue;
    TRY_ASSIGN(const FileContent content, read_mesh_file(path->string()));
    TRY_ASSIGN(const TriangleMesh mesh, read_mesh(content.view(), path->string()));
    TRY_ASSIGN(TriangleMesh simple, simple_mesh(mesh, path->string()));
    result_.bodies.push_back({static_cast<int>(i), std::move(simple)});
  }
  return {};
}

RobotMeshes RobotMeshLoader::finish() {
  std::ranges::sort(result_.bodies, {}, &BodyMesh::body);
  return std::move(result_);
}

bool is_model(const std::string& named) {
  const std::string ending = lower_case(fs::path(named).extension().string());
  return (ending == ".xml" || ending == ".urdf" || ending == ".mjcf") && is_file(named);
}

}  // namespace

Result<RobotMeshes> load_robot_meshes(const Robot& robot, const std::string& model,
                                      const std::string& named) {
  std::error_code ignored;
  const bool other_model = is_model(named);
  const std::string folder = other_model ? std::string() : named;
  if (!folder.empty() && !fs::is_directory(folder, ignored)) {
    return usage_failure("there is no folder \"" + folder + "\" with meshes",
                         "a model, MJCF or URDF, is taken as well");
  }
  RobotMeshLoader loader(robot, folder, !named.empty());
  const std::string& used = other_model ? named : model;
  if (!used.empty()) TRY(loader.add_model(used));
  if (!folder.empty()) TRY(loader.add_folder());
  RobotMeshes meshes = loader.finish();
  if (named.empty() || !meshes.bodies.empty()) return meshes;
  const std::string hint = "its bodies are called " + robot.bodies()[1].name + " and so on";
  if (!meshes.notes.empty()) return input_failure(named, meshes.notes.front(), hint);
  return input_failure(named,
                       other_model ? "the model names no mesh for a body of " + robot.name()
                                   : "no STL or OBJ file is named like a body of " + robot.name(),
                       hint);
}

}  // namespace retarget
