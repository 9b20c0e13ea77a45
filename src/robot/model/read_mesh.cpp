#include "robot/model/read_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include "base/try.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr std::size_t kStlHead = 84, kStlTriangle = 50;

// Removes the next word from a text and returns it.
std::string_view next_word(std::string_view& text) {
  constexpr std::string_view kBlank = " \t\r\n";
  const std::size_t begin = std::min(text.find_first_not_of(kBlank), text.size());
  const std::size_t end = std::min(text.find_first_of(kBlank, begin), text.size());
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

std::optional<Eigen::Vector3d> next_point(std::string_view& text) {
  Eigen::Vector3d point;
  for (double& value : point) {
    const auto number = parse_number<double>(next_word(text));
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
    if (next_word(text) != "vertex") continue;
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
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::string_view what = next_word(line);
    const auto bad = [&](const char* message) {
      Error error;
      error.kind = ErrorKind::kInput;
      error.location.file = file;
      error.location.line = number;
      error.message = message;
      return failure(std::move(error));
    };
    if (what == "v") {
      const auto point = next_point(line);
      if (!point) return bad("expected three numbers after \"v\"");
      mesh.vertices.push_back(*point);
    } else if (what == "f") {
      std::vector<int> corners;
      for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
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

Result<TriangleMesh> read_mesh_as_written(std::string_view bytes, const std::string& file) {
  TriangleMesh mesh;
  if (is_binary_stl(bytes)) {
    mesh = read_binary_stl(bytes);
  } else if (lower_case(file).ends_with(".dae")) {
    TRY_ASSIGN(mesh, read_collada(bytes, file));
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
