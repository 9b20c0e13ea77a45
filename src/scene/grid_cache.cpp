#include "scene/grid_cache.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <system_error>
#include <vector>

#include "retarget/bytes.h"
#include "retarget/file.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

__extension__ using Uint128 = unsigned __int128;

constexpr std::string_view kMagic = "RTGRID\r\n";
// To be raised whenever the samples of the same mesh and layout change.
constexpr std::uint64_t kVersion = 1;
constexpr std::size_t kHashLength = 32;

void append_number(std::string& bytes, double value) {
  append_little_endian(bytes, std::bit_cast<std::uint64_t>(value), 8);
}

std::string head_of(const GridLayout& layout) {
  std::string bytes(kMagic);
  append_little_endian(bytes, kVersion, 4);
  append_number(bytes, layout.spacing);
  for (const double value : layout.origin) append_number(bytes, value);
  for (const int count : layout.nodes) {
    append_little_endian(bytes, static_cast<std::uint64_t>(count), 4);
  }
  return bytes;
}

}  // namespace

std::string fnv1a_128(std::string_view bytes) {
  constexpr Uint128 kPrime = (Uint128{1} << 88U) + 0x13B;
  Uint128 hash = (Uint128{0x6C62272E07BB0142U} << 64U) + 0x62B821756295C58DU;
  for (const char byte : bytes) {
    hash ^= static_cast<unsigned char>(byte);
    hash *= kPrime;
  }
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (int shift = 124; shift >= 0; shift -= 4) {
    text += kDigits[static_cast<std::size_t>((hash >> static_cast<unsigned>(shift)) & 15U)];
  }
  return text;
}

std::string grid_file_name(const TriangleMesh& mesh, const GridLayout& layout) {
  std::string content = head_of(layout);
  content.reserve(content.size() + 24 * mesh.vertices.size() + 12 * mesh.triangles.size());
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    for (const double value : vertex) append_number(content, value);
  }
  for (const auto& triangle : mesh.triangles) {
    for (const int corner : triangle) {
      append_little_endian(content, static_cast<std::uint64_t>(corner), 4);
    }
  }
  return fnv1a_128(content) + ".grid";
}

std::optional<DistanceGrid> read_grid(const std::string& file, const GridLayout& layout) {
  if (!is_file(file)) return std::nullopt;
  const std::string head = head_of(layout);
  const std::size_t size = head.size() + 4 * layout.count() + kHashLength;
  const auto content = read_file(file, ErrorKind::kInput, size);
  if (!content || content->view().size() != size) return std::nullopt;
  const std::string_view bytes = content->view();
  if (!bytes.starts_with(head)) return std::nullopt;
  const std::string_view checked = bytes.substr(0, size - kHashLength);
  if (bytes.substr(checked.size()) != fnv1a_128(checked)) return std::nullopt;
  ByteReader<std::endian::little> reader(checked.substr(head.size()));
  std::vector<float> values(layout.count());
  for (float& value : values) value = reader.number<float>();
  const auto finite = [](float value) { return std::isfinite(value); };
  if (!std::ranges::all_of(values, finite)) return std::nullopt;
  return DistanceGrid(layout, values);
}

void write_grid(const std::string& file, const DistanceGrid& grid) {
  std::error_code error;
  fs::create_directories(fs::path(file).parent_path(), error);
  if (error) return;
  std::string bytes = head_of(grid.layout());
  bytes.reserve(bytes.size() + 4 * grid.layout().count() + kHashLength);
  for (const float value : grid.values()) append_little_endian(bytes, value);
  bytes += fnv1a_128(bytes);
  static_cast<void>(write_file(file, bytes));
}

}  // namespace retarget
