#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <vector>

namespace retarget {

/// How a number of an accessor is stored: glTF's `componentType`.
enum class GltfComponent {
  kInt8 = 5120,
  kUint8 = 5121,
  kInt16 = 5122,
  kUint16 = 5123,
  kUint32 = 5125,
  kFloat = 5126,
};

[[nodiscard]] std::optional<GltfComponent> gltf_component(const nlohmann::ordered_json& type);

/// Bytes of a number.
[[nodiscard]] std::size_t gltf_size(GltfComponent component);

/// The number at the beginning of bytes, little-endian. @pre there are gltf_size bytes
[[nodiscard]] double gltf_number(std::string_view bytes, GltfComponent component);

/// How elements of an accessor are stored.
struct GltfLayout {
  GltfComponent component = GltfComponent::kFloat;
  int width = 1;            ///< Numbers of an element.
  int columns = 1;          ///< Of a matrix, each of which begins at a multiple of four bytes.
  bool normalized = false;  ///< Whole numbers stand for -1 ... 1 or 0 ... 1.

  /// Bytes of an element.
  [[nodiscard]] std::size_t bytes() const;
  /// Appends an element's numbers. @pre there are bytes() bytes
  void append(std::string_view bytes, std::vector<double>& numbers) const;

 private:
  [[nodiscard]] std::size_t column_bytes() const;
};

/// Of an accessor; nothing where it is none.
[[nodiscard]] std::optional<GltfLayout> gltf_layout(const nlohmann::ordered_json& accessor);

}  // namespace retarget
