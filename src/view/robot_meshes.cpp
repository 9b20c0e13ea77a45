#include "view/robot_meshes.h"

#include <filesystem>
#include <optional>
#include <system_error>

#include "base/file.h"
#include "base/lower_case.h"
#include "base/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxBytes = std::size_t{256} << 20U;
constexpr std::size_t kMaxTriangles = 1600;  // of a body

struct MeshFile {
  std::string stem;  // lower case
  fs::path path;
};

std::vector<MeshFile> mesh_files(const std::string& folder) {
  std::vector<MeshFile> files;
  for (const fs::path& path : files_in_folder(folder)) {
    const std::string ending = lower_case(path.extension().string());
    if (ending != ".stl" && ending != ".obj") continue;
    files.push_back({lower_case(path.stem().string()), path});
  }
  return files;
}

std::optional<fs::path> file_of(const std::vector<MeshFile>& files, const std::string& body) {
  constexpr std::string_view kLink = "_link";
  const std::string name = lower_case(body);
  std::string bare = name;
  if (bare.ends_with(kLink)) bare.resize(bare.size() - kLink.size());
  for (const std::string& wanted : {name, bare}) {
    for (const MeshFile& file : files) {
      if (file.stem == wanted) return file.path;
    }
  }
  // files are sorted by name: of several revisions the last
  std::optional<fs::path> found;
  for (const MeshFile& file : files) {
    if (file.stem.starts_with(name + "_")) found = file.path;
  }
  return found;
}

}  // namespace

Result<std::vector<BodyMesh>> load_body_meshes(const Robot& robot, const std::string& folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) {
    return usage_failure("there is no folder \"" + folder + "\" with meshes");
  }
  const std::vector<MeshFile> files = mesh_files(folder);
  std::vector<BodyMesh> meshes;
  for (std::size_t i = 1; i < robot.bodies().size(); ++i) {
    const std::string& name = robot.bodies()[i].name;
    const auto path = name.empty() ? std::nullopt : file_of(files, name);
    if (!path) continue;
    TRY_ASSIGN(const FileContent content, read_file(path->string(), ErrorKind::kInput, kMaxBytes,
                                                    "meshes for a page need not be that fine"));
    TRY_ASSIGN(const TriangleMesh mesh, read_mesh(content.view(), path->string()));
    meshes.push_back({static_cast<int>(i), simplified(mesh, kMaxTriangles)});
  }
  if (meshes.empty()) {
    return input_failure(folder, "no STL or OBJ file is named like a body of " + robot.name(),
                         "its bodies are called " + robot.bodies()[1].name + " and so on");
  }
  return meshes;
}

}  // namespace retarget
