#include "robot/model/mesh_files.h"

#include <array>
#include <string_view>
#include <system_error>

#include "retarget/file.h"
#include "retarget/text.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Returns the candidate paths of a file below a folder: its name without the scheme, with and
// without the package.
std::vector<fs::path> names_of(std::string_view named) {
  // MuJoCo collapses a double slash.
  constexpr std::array<std::string_view, 4> kSchemes = {"package://", "package:/", "model://",
                                                        "file://"};
  for (const std::string_view scheme : kSchemes) {
    if (!named.starts_with(scheme)) continue;
    named.remove_prefix(scheme.size());
    std::vector<fs::path> names = {fs::path(named)};
    const std::size_t slash = named.find('/');
    if (scheme != kSchemes.back() && slash != std::string_view::npos) {
      names.emplace_back(named.substr(slash + 1));
    }
    return names;
  }
  return {fs::path(named)};
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
  std::vector<fs::path> names = names_of(named);
  if (!folder.empty()) {
    std::vector<fs::path> in_folder = names;
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
  return first_below({root, root.parent_path()}, names, root.parent_path());
}

Result<FileContent> read_mesh_file(const std::string& path) {
  constexpr std::size_t kMost = std::size_t{64} << 20U;  // Bytes.
  return read_file(path, ErrorKind::kInput, kMost, "use simpler meshes for the robot");
}

}  // namespace retarget
