#include "robot/model/read_mesh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <system_error>

#include "base/try.h"
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
  // Files are sorted by name, so this keeps the last revision.
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

namespace {

constexpr std::size_t kStlHead = 84, kStlTriangle = 50;

std::optional<Eigen::Vector3d> next_point(std::string_view& text) {
  Eigen::Vector3d point;
  for (double& value : point) {
    const auto number = parse_number<double>(take_word(text));
    if (!number) return std::nullopt;
    value = *number;
  }
  return point;
}

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    word |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  }
  return word;
}

bool is_binary_stl(std::string_view bytes) {
  return bytes.size() >= kStlHead &&
         bytes.size() == kStlHead + kStlTriangle * std::uint64_t{word_at(bytes, kStlHead - 4)};
}

void add_corners(TriangleMesh& mesh) {
  const int last = static_cast<int>(mesh.vertices.size());
  mesh.triangles.push_back({last - 3, last - 2, last - 1});
}

TriangleMesh read_binary_stl(std::string_view bytes) {
  TriangleMesh mesh;
  for (std::size_t at = kStlHead; at < bytes.size(); at += kStlTriangle) {
    // Skip the facet normal; the corners define it.
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Eigen::Vector3d& vertex = mesh.vertices.emplace_back();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::uint32_t word = word_at(bytes, at + 12 + 12 * corner + 4 * axis);
        float value = 0.0F;
        std::memcpy(&value, &word, sizeof value);
        vertex[static_cast<Eigen::Index>(axis)] = value;
      }
    }
    add_corners(mesh);
  }
  return mesh;
}

Result<TriangleMesh> read_text_stl(std::string_view text, const std::string& file) {
  TriangleMesh mesh;
  while (!text.empty()) {
    if (take_word(text) != "vertex") continue;
    const auto point = next_point(text);
    if (!point) return input_failure(file, "expected three numbers after \"vertex\"");
    mesh.vertices.push_back(*point);
    if (mesh.vertices.size() % 3 == 0) add_corners(mesh);
  }
  return mesh;
}

// Formats `3`, `3/1`, `3//2`, `-1`: one-based, or relative to the end if negative.
std::optional<int> corner_of(std::string_view word, std::size_t vertices) {
  const auto number = parse_number<long>(word.substr(0, word.find('/')));
  if (!number || *number == 0) return std::nullopt;
  const long count = static_cast<long>(vertices);
  const long index = *number > 0 ? *number - 1 : count + *number;
  if (index < 0 || index >= count) return std::nullopt;
  return static_cast<int>(index);
}

Result<TriangleMesh> read_obj(std::string_view text, const std::string& file) {
  TriangleMesh mesh;
  std::size_t number = 0;
  while (!text.empty()) {
    ++number;
    std::string_view line = take_until(text, '\n');
    const std::string_view what = take_word(line);
    const auto bad = [&](const char* message) {
      return failure({ErrorKind::kInput, {file, number, 0}, message, {}, {}});
    };
    if (what == "v") {
      const auto point = next_point(line);
      if (!point) return bad("expected three numbers after \"v\"");
      mesh.vertices.push_back(*point);
    } else if (what == "f") {
      std::vector<int> corners;
      for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
        const auto corner = corner_of(word, mesh.vertices.size());
        if (!corner) return bad("expected indices of preceding vertices");
        corners.push_back(*corner);
      }
      for (std::size_t i = 2; i < corners.size(); ++i) {
        mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
      }
    }
  }
  return mesh;
}

double largest_of(const TriangleMesh& mesh) {
  double largest = 0.0;
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    largest = std::max(largest, vertex.cwiseAbs().maxCoeff());
  }
  return largest;
}

}  // namespace

Result<TriangleMesh> read_mesh_as_written(std::string_view bytes, const std::string& file,
                                          ColladaAxes axes) {
  TriangleMesh mesh;
  if (is_binary_stl(bytes)) {
    mesh = read_binary_stl(bytes);
  } else if (lower_case(file).ends_with(".dae")) {
    TRY_ASSIGN(mesh, read_collada(bytes, file, axes));
  } else if (lower_case(file).ends_with(".obj")) {
    TRY_ASSIGN(mesh, read_obj(bytes, file));
  } else {
    TRY_ASSIGN(mesh, read_text_stl(bytes, file));
  }
  if (mesh.triangles.empty()) {
    return input_failure(file,
                         "found no triangles: the file is neither STL nor OBJ, or it is truncated");
  }
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    if (!vertex.allFinite()) return input_failure(file, "a vertex is not a finite number");
  }
  return mesh;
}

Result<TriangleMesh> read_mesh(std::string_view bytes, const std::string& file) {
  TRY_ASSIGN(TriangleMesh mesh, read_mesh_as_written(bytes, file));
  const double largest = largest_of(mesh);
  if (largest > 1e3 * kMeshReach) {
    return input_failure(file, "a vertex is more than 10 m away, even in millimetres");
  }
  if (largest > kMeshReach) {
    for (Eigen::Vector3d& vertex : mesh.vertices) vertex *= 1e-3;
  }
  return mesh;
}

Result<void> check_mesh_reach(const TriangleMesh& mesh, const std::string& file) {
  if (largest_of(mesh) <= kMeshReach) return {};
  return input_failure(file, "a vertex is more than 10 m away");
}

}  // namespace retarget
