#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/file.h"
#include "retarget/triangle_mesh.h"

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

/// Maximum distance of a mesh vertex from the body's origin along any axis, metres.
inline constexpr double kMeshReach = 10.0;

/// Reads a mesh from the bytes of an STL file (binary or text), an OBJ or a COLLADA file (.dae);
/// only geometry is read. A mesh larger than 10 m is assumed to be in millimetres.
/// Errors (kInput): no triangles, invalid numbers, corner indices out of range.
/// @param file  used in messages.
[[nodiscard]] Result<TriangleMesh> read_mesh(std::string_view bytes, const std::string& file);

/// Axes of the mesh that is read from a COLLADA file.
enum class ColladaAxes : unsigned char {
  kOfFile,  ///< The stated up axis is ignored, as robot tools do.
  kZUp,     ///< The file's axes, Y up if it states none, are rotated to Z up.
};

/// Reads a mesh without guessing its unit: STL and OBJ in the file's unit, COLLADA, which states
/// its unit, in metres.
[[nodiscard]] Result<TriangleMesh> read_mesh_as_written(std::string_view bytes,
                                                        const std::string& file,
                                                        ColladaAxes axes = ColladaAxes::kOfFile);

/// Reads the triangles of a COLLADA file in metres, with the poses of its nodes. Instances in node
/// libraries are ignored.
[[nodiscard]] Result<TriangleMesh> read_collada(std::string_view bytes, const std::string& file,
                                                ColladaAxes axes);

/// Rejects a mesh that exceeds kMeshReach.
[[nodiscard]] Result<void> check_mesh_reach(const TriangleMesh& mesh, const std::string& file);

}  // namespace retarget
