#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "retarget/triangle_mesh.h"
#include "scene/distance_grid.h"

namespace retarget {

/// FNV-1a with 128 bits, as 32 hexadecimal digits. It names content and detects damage; it does not
/// resist forgery.
[[nodiscard]] std::string fnv1a_128(std::string_view bytes);

/// Name of the file for the grid of a mesh: a hash of its vertices and triangles, of the layout and
/// of the version of the method, and the ending `.grid`.
[[nodiscard]] std::string grid_file_name(const TriangleMesh& mesh, const GridLayout& layout);

/// Reads a grid. Returns nothing if the file is missing or not exactly such a grid: wrong magic
/// number, version, layout, size or check sum.
[[nodiscard]] std::optional<DistanceGrid> read_grid(const std::string& file,
                                                    const GridLayout& layout);

/// Writes a grid, completely or not at all, and makes the folder. Failures are ignored: the grid
/// can be computed again.
void write_grid(const std::string& file, const DistanceGrid& grid);

}  // namespace retarget
