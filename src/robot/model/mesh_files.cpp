#include "robot/model/mesh_files.h"

#include <array>
#include <string_view>
#include <system_error>

#include "retarget/file.h"
#include "retarget/text.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// A file as a model names it.
struct NamedMesh {
  std::string package;          // Empty: none.
  std::vector<fs::path> names;  // Candidate paths below a folder, most specific first.
};

// The name of a file in a package, without the scheme: nothing for other names.
std::optional<std::string_view> name_in_package(std::string_view named) {
  // MuJoCo collapses a double slash.
  constexpr std::array<std::string_view, 3> kSchemes = {"package://", "package:/", "model://"};
  for (const std::string_view scheme : kSchemes) {
    if (named.starts_with(scheme)) return named.substr(scheme.size());
  }
  return std::nullopt;
}

// Replaces `$(find PACKAGE)` of ROS by PACKAGE.
std::optional<std::string> found_package(std::string_view named) {
  constexpr std::string_view kFile = "file://", kFind = "$(find ";
  if (named.starts_with(kFile)) named.remove_prefix(kFile.size());
  const std::size_t end = named.find(')');
  if (!named.starts_with(kFind) || end == std::string_view::npos) return std::nullopt;
  return std::string(named.substr(kFind.size(), end - kFind.size())) +
         std::string(named.substr(end + 1));
}

// Packages lie in other folders on other machines, so leading folders of the name may be missing.
NamedMesh named_mesh(std::string_view named) {
  constexpr std::string_view kFile = "file://";
  const auto found = found_package(named);
  const auto in_package = found ? std::optional<std::string_view>(*found) : name_in_package(named);
  if (!in_package) {
    if (named.starts_with(kFile)) named.remove_prefix(kFile.size());
    return {{}, {fs::path(named)}};
  }
  NamedMesh mesh;
  std::string_view rest = *in_package;
  mesh.package = rest.substr(0, rest.find('/'));
  while (true) {
    if (!rest.empty()) mesh.names.emplace_back(rest);
    const std::size_t slash = rest.find('/');
    if (slash == std::string_view::npos) return mesh;
    rest.remove_prefix(slash + 1);
  }
}

// The folder that a model's package may extend to: one above the model's, or two if that is the
// package itself.
fs::path package_folder(const fs::path& model_folder, const std::string& package) {
  const fs::path above = model_folder.parent_path(), two_above = above.parent_path();
  const bool is_package = !package.empty() && above != two_above &&
                          (two_above.filename() == package || is_file(two_above / "package.xml"));
  return is_package ? two_above : above;
}

std::optional<fs::path> first_below(const std::vector<fs::path>& folders,
                                    const std::vector<fs::path>& names, const fs::path& root) {
  for (const fs::path& folder : folders) {
    for (const fs::path& name : names) {
      const fs::path file = folder / name;
      if (is_file(file) && is_below(file, root)) return file;
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<MeshFile> mesh_files(const std::string& folder) {
  std::vector<MeshFile> files;
  for (const fs::path& path : files_in_folder(folder)) {
    const std::string ending = lower_case(path.extension().string());
    if (ending != ".stl" && ending != ".obj" && ending != ".dae") continue;
    files.push_back({lower_case(path.stem().string()), path});
  }
  return files;
}

std::optional<fs::path> file_of_body(const std::vector<MeshFile>& files, const std::string& body) {
  constexpr std::string_view kLink = "_link";
  const std::string name = lower_case(body);
  std::string bare = name;
  if (bare.ends_with(kLink)) bare.resize(bare.size() - kLink.size());
  for (const std::string& wanted : {name, bare}) {
    for (const MeshFile& file : files) {
      if (file.stem == wanted) return file.path;
    }
  }
  // Files are sorted by name, so this keeps the last of several revisions.
  std::optional<fs::path> found;
  for (const MeshFile& file : files) {
    if (file.stem.starts_with(name + "_")) found = file.path;
  }
  return found;
}

std::optional<fs::path> find_mesh_file(const std::string& named, const fs::path& model,
                                       const std::string& folder) {
  const NamedMesh mesh = named_mesh(named);
  if (!folder.empty()) {
    std::vector<fs::path> in_folder = mesh.names;
    in_folder.push_back(fs::path(named).filename());
    if (auto found = first_below({folder}, in_folder, folder)) return found;
    // Vendors may supply the same mesh as STL and in another format.
    const std::string stem = lower_case(fs::path(named).stem().string());
    for (const MeshFile& file : mesh_files(folder)) {
      if (file.stem == stem) return file.path;
    }
  }
  std::error_code error;
  const fs::path root = fs::canonical(fs::absolute(model, error).parent_path(), error);
  if (error) return std::nullopt;
  const fs::path package = package_folder(root, mesh.package);
  std::vector<fs::path> folders = {root, root.parent_path()};
  if (package != folders.back()) folders.push_back(package);
  return first_below(folders, mesh.names, package);
}

Result<FileContent> read_mesh_file(const std::string& path) {
  constexpr std::size_t kMost = std::size_t{64} << 20U;  // Bytes.
  return read_file(path, ErrorKind::kInput, kMost, "use simpler meshes for the robot");
}

}  // namespace retarget
