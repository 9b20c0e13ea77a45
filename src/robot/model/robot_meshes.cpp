#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <system_error>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "retarget/data_folder.h"
#include "retarget/file.h"
#include "retarget/robot_meshes.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "robot/model/model_meshes.h"
#include "robot/model/read_mesh.h"
#include "robot/model/robot_meshes.h"

namespace retarget {
namespace {

using Cell = std::array<std::int64_t, 3>;
using Corners = std::array<int, 3>;

// Hash containers are only used for lookup, because their iteration order depends on the library.
struct Hash {
  template <typename Number>
  std::size_t operator()(const std::array<Number, 3>& numbers) const {
    std::uint64_t hash = 0;
    for (const Number number : numbers) {
      hash = (hash ^ static_cast<std::uint64_t>(number)) * 0x9E3779B97F4A7C15U;
      hash ^= hash >> 29U;
    }
    return static_cast<std::size_t>(hash);
  }
};

// Replaces the vertices of each grid cell by their mean and drops triangles that become degenerate.
// Cells are centred at multiples of the side, so that 0 and -0 share a cell.
TriangleMesh clustered(const TriangleMesh& mesh, double side) {
  struct Cluster {
    int index = 0;
    int count = 0;
  };
  std::unordered_map<Cell, Cluster, Hash> clusters;
  clusters.reserve(mesh.vertices.size() / 4);
  TriangleMesh result;
  std::vector<int> index_of(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3d& vertex = mesh.vertices[i];
    Cell cell{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      cell[axis] =
          static_cast<std::int64_t>(std::nearbyint(vertex[static_cast<Eigen::Index>(axis)] / side));
    }
    Cluster& cluster = clusters[cell];
    if (cluster.count == 0) {
      cluster.index = static_cast<int>(result.vertices.size());
      result.vertices.emplace_back(Eigen::Vector3d::Zero());
    }
    Eigen::Vector3d& mean = result.vertices[static_cast<std::size_t>(cluster.index)];
    mean += (vertex - mean) / ++cluster.count;
    index_of[i] = cluster.index;
  }
  std::unordered_set<Corners, Hash> known;
  known.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    Corners corners = {index_of[static_cast<std::size_t>(a)], index_of[static_cast<std::size_t>(b)],
                       index_of[static_cast<std::size_t>(c)]};
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    // Rotate the smallest index to the front, which keeps the orientation.
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    if (known.insert(corners).second) result.triangles.push_back(corners);
  }
  return result;
}

double area_of(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d& corner = mesh.vertices[static_cast<std::size_t>(a)];
    area += 0.5 * (mesh.vertices[static_cast<std::size_t>(b)] - corner)
                      .cross(mesh.vertices[static_cast<std::size_t>(c)] - corner)
                      .norm();
  }
  return area;
}

}  // namespace

TriangleMesh simplified(const TriangleMesh& mesh, std::size_t max_triangles) {
  constexpr double kSame = 1e-5;  // Metres.
  constexpr double kCoarser = 1.3;
  TriangleMesh result = clustered(mesh, kSame);
  if (result.triangles.size() <= max_triangles) return result;
  // A cell has about two triangles. Restart from the first mesh each time, because repeated
  // averaging would move vertices.
  const TriangleMesh first = result;
  double side = 0.7 * std::sqrt(area_of(first) / static_cast<double>(max_triangles));
  for (side = std::max(side, kSame); result.triangles.size() > max_triangles; side *= kCoarser) {
    result = clustered(first, side);
  }
  return result;
}

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxTriangles = 1600;  // Per body.

Result<TriangleMesh> simple_mesh(const TriangleMesh& mesh, const std::string& file) {
  TriangleMesh simple = simplified(mesh, kMaxTriangles);
  // Clustering removed all triangles, so they are degenerate.
  if (simple.triangles.empty()) return input_failure(file, "its triangles have no area");
  return simple;
}

class RobotMeshLoader {
 public:
  RobotMeshLoader(const Robot& robot, std::string folder, bool must)
      : robot_(robot), folder_(std::move(folder)), must_(must), covered_(robot.bodies().size()) {}

  Result<void> add_model(const std::string& model);
  void add_folder();
  [[nodiscard]] RobotMeshes finish();

  /// The fault of the first unreadable mesh, otherwise a sentence about missing ones, if any.
  [[nodiscard]] const std::optional<Error>& fault() const { return fault_; }
  [[nodiscard]] std::string gap() const { return gaps_.empty() ? std::string() : gaps_.front(); }

 private:
  void note_missing(const std::string& model, const BodySurfaces& surfaces);

  const Robot& robot_;
  const std::string folder_;
  const bool must_;            // If true, an unreadable model is an error instead of a note.
  std::vector<bool> covered_;  // One per body.
  std::vector<std::string> unreadable_;
  std::optional<Error> fault_;
  std::vector<std::string> gaps_;  // Sentences about meshes that are replaced by primitives.
  RobotMeshes result_;
};

Result<void> RobotMeshLoader::add_model(const std::string& model) {
  auto surfaces = read_body_surfaces(robot_, model, folder_);
  if (!surfaces && must_ && folder_.empty()) return failure(surfaces.error());
  if (!surfaces) {
    result_.notes.push_back("the meshes of " + fs::path(model).filename().string() +
                            " are not drawn: " + surfaces.error().message);
    return {};
  }
  for (const auto& [body, mesh] : surfaces->bodies) {
    auto simple = simple_mesh(mesh, model);
    if (!simple) {
      surfaces->unreadable.push_back(std::move(simple.error()));
      continue;
    }
    covered_[static_cast<std::size_t>(body)] = true;
    result_.bodies.push_back({body, std::move(*simple)});
  }
  note_missing(fs::path(model).filename().string(), *surfaces);
  return {};
}

void RobotMeshLoader::note_missing(const std::string& model, const BodySurfaces& surfaces) {
  const auto& [bodies, files, missing, unreadable] = surfaces;
  if (!missing.empty()) {
    const bool none = missing.size() == files;
    gaps_.push_back((none ? "all mesh files of " + model + " are missing, such as "
                          : count_text(missing.size(), "mesh file") + " of " +
                                std::to_string(files) + " of " + model +
                                (missing.size() == 1 ? " is" : " are") + " missing, such as ") +
                    missing.front());
  }
  for (const Error& each : unreadable) unreadable_.push_back(each.location.file);
  if (!unreadable.empty()) {
    if (!fault_) fault_ = unreadable.front();
    gaps_.push_back(
        "the meshes of " +
        (unreadable.size() == 1 ? std::string("a body")
                                : std::to_string(unreadable.size()) + " bodies") +
        " cannot be read: " + fs::path(unreadable.front().location.file).filename().string() +
        ": " + unreadable.front().message);
  }
}

Result<TriangleMesh> read_simple_mesh(const std::string& path) {
  RETARGET_TRY_ASSIGN(const FileContent content, read_mesh_file(path));
  RETARGET_TRY_ASSIGN(const TriangleMesh mesh, read_mesh(content.view(), path));
  return simple_mesh(mesh, path);
}

void RobotMeshLoader::add_folder() {
  const std::vector<MeshFile> files = mesh_files(folder_);
  BodySurfaces surfaces;
  for (std::size_t i = 1; i < robot_.bodies().size(); ++i) {
    const std::string& name = robot_.bodies()[i].name;
    const auto path = name.empty() || covered_[i] ? std::nullopt : file_of_body(files, name);
    if (!path || std::ranges::find(unreadable_, path->string()) != unreadable_.end()) continue;
    auto simple = read_simple_mesh(path->string());
    if (!simple) {
      surfaces.unreadable.push_back(std::move(simple.error()));
      continue;
    }
    result_.bodies.push_back({static_cast<int>(i), std::move(*simple)});
  }
  note_missing(folder_, surfaces);
}

RobotMeshes RobotMeshLoader::finish() {
  std::ranges::sort(result_.bodies, {}, &BodyMesh::body);
  for (const std::string& gap : gaps_) {
    result_.notes.push_back(gap + "; drawing primitives instead");
  }
  return std::move(result_);
}

bool is_model(const std::string& named) {
  const std::string ending = lower_case(fs::path(named).extension().string());
  return (ending == ".xml" || ending == ".urdf" || ending == ".mjcf") && is_file(named);
}

Result<RobotMeshes> load_meshes(const Robot& robot, const std::string& model,
                                const std::string& named, bool must);

// The meshes that the user installed for a robot, if any. An unreadable file affects only the mesh
// of its body.
std::optional<RobotMeshes> kept_meshes(const Robot& robot, const std::string& model) {
  const auto data = user_data_folder();
  const auto is_plain = [](char letter) { return letter != '/' && letter != '\\'; };
  if (!data || robot.name().empty() || !std::ranges::all_of(robot.name(), is_plain)) return {};
  const fs::path folder = *data / "meshes" / robot.name();
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) return std::nullopt;
  // A model in the folder is more specific than file names.
  std::vector<std::string> models;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (is_model(entry.path().string())) models.push_back(entry.path().string());
  }
  std::ranges::sort(models);
  auto meshes = load_meshes(robot, model, models.empty() ? folder.string() : models.front(), false);
  if (meshes) return std::move(*meshes);
  RobotMeshes none;
  const std::string file = fs::path(meshes.error().location.file).filename().string();
  none.notes.push_back("the meshes in " + printable(folder.string()) + " are not drawn: " +
                       (file.empty() ? "" : printable(file) + ": ") + meshes.error().message);
  return none;
}

// @param must  if true, an unreadable model is an error instead of a note.
Result<RobotMeshes> load_meshes(const Robot& robot, const std::string& model,
                                const std::string& named, bool must) {
  std::error_code ignored;
  const bool other_model = is_model(named);
  const std::string folder = other_model ? std::string() : named;
  if (!folder.empty() && !fs::is_directory(folder, ignored)) {
    return usage_failure("no folder \"" + folder + "\" with meshes",
                         "give a folder or a model (MJCF or URDF)");
  }
  RobotMeshLoader loader(robot, folder, must);
  const std::string& used = other_model ? named : model;
  if (!used.empty()) RETARGET_TRY(loader.add_model(used));
  if (!folder.empty()) loader.add_folder();
  RobotMeshes meshes = loader.finish();
  if (named.empty() || !meshes.bodies.empty()) return meshes;
  const std::string hint = "its body names are " + robot.bodies()[1].name + " and so on";
  if (auto fault = loader.fault()) {
    fault->kind = ErrorKind::kInput;
    return failure(*std::move(fault));
  }
  if (!loader.gap().empty()) return input_failure(named, loader.gap(), hint);
  if (!meshes.notes.empty()) return input_failure(named, meshes.notes.front(), hint);
  return input_failure(named,
                       other_model ? "the model names no mesh for a body of " + robot.name()
                                   : "no STL or OBJ file is named like a body of " + robot.name(),
                       hint);
}

}  // namespace

Result<RobotMeshes> load_robot_meshes(const Robot& robot, const std::string& model,
                                      const std::string& named) {
  if (named.empty()) {
    if (auto kept = kept_meshes(robot, model)) return std::move(*kept);
  }
  return load_meshes(robot, model, named, !named.empty());
}

}  // namespace retarget
