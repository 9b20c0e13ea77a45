#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/file.h"

namespace retarget {

/// An STL, OBJ or COLLADA file.
struct MeshFile {
  std::string stem;  ///< Lower-case file name without extension.
  std::filesystem::path path;
};

/// Returns the mesh files of a folder, sorted by name.
[[nodiscard]] std::vector<MeshFile> mesh_files(const std::string& folder);

/// Finds the file named like a body, ignoring case: `left_knee_link.STL` for left_knee_link; also
/// `left_knee.obj`, otherwise the last revision, such as `left_knee_link_rev_2.stl`.
[[nodiscard]] std::optional<std::filesystem::path> file_of_body(const std::vector<MeshFile>& files,
                                                                const std::string& body);

/// Finds the mesh file that a model names: first in the folder, if given, under its full or last
/// name; then next to the model or one folder up, the extent of a model's package, or two folders up
/// if that folder has the package's name or a package.xml. Names with `package://` or `$(find PACKAGE)/`
/// are searched whole, then without their leading folders, one by one. No file outside these folders
/// is found.
[[nodiscard]] std::optional<std::filesystem::path> find_mesh_file(
    const std::string& named, const std::filesystem::path& model, const std::string& folder);

/// Reads a mesh file, with a size limit above that of any robot mesh. Errors: those of read_file.
[[nodiscard]] Result<FileContent> read_mesh_file(const std::string& path);

}  // namespace retarget
