#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/file.h"
#include "retarget/error.h"

namespace retarget {

/// An STL, OBJ or COLLADA file.
struct MeshFile {
  std::string stem;  ///< Of its name, lower case.
  std::filesystem::path path;
};

/// Those of a folder, sorted by name.
[[nodiscard]] std::vector<MeshFile> mesh_files(const std::string& folder);

/// The file that is named like a body, in whatever case: `left_knee_link.STL` for left_knee_link; also
/// `left_knee.obj`, and, where there is no other, the last of `left_knee_link_rev_2.stl` and so on.
[[nodiscard]] std::optional<std::filesystem::path> file_of_body(const std::vector<MeshFile>& files,
                                                                const std::string& body);

/// Where a mesh file is that a model names: in the folder, if there is one, under its whole name or its
/// last part; else beside the model or one folder up, which is as far as a model's package goes. Names with
/// `package://` are looked for with and without the package's name.
[[nodiscard]] std::optional<std::filesystem::path> find_mesh_file(
    const std::string& named, const std::filesystem::path& model, const std::string& folder);

/// The bytes of a mesh file, if it is not larger than any robot's need be. Errors: read_file's.
[[nodiscard]] Result<FileContent> read_mesh_file(const std::string& path);

}  // namespace retarget
