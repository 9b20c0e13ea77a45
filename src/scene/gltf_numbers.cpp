#include "scene/gltf_numbers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "base/json_members.h"

namespace retarget {
namespace {

struct Shape {
  std::string_view name;
  int width, columns;
};
constexpr std::array<Shape, 7> kShapes = {{{"SCALAR", 1, 1},
                                           {"VEC2", 2, 1},
                                           {"VEC3", 3, 1},
                                           {"VEC4", 4, 1},
                                           {"MAT2", 4, 2},
                                           {"MAT3", 9, 3},
                                           {"MAT4", 16, 4}}};

// the value that stands for 1
double largest(GltfComponent component) {
  switch (component) {
    case GltfComponent::kInt8:
      return 127.0;
    case GltfComponent::kUint8:
      return 255.0;
    case GltfComponent::kInt16:
      return 32767.0;
    case GltfComponent::kUint16:
      return 65535.0;
    default:
      return 1.0;
  }
}

}  // namespace

std::optional<GltfComponent> gltf_component(const nlohmann::ordered_json& type) {
  const auto number = value_from<int>(type);
  if (!number || *number < 5120 || *number > 5126 || *number == 5124) return std::nullopt;
  return static_cast<GltfComponent>(*number);
}

std::size_t gltf_size(GltfComponent component) {
  switch (component) {
    case GltfComponent::kInt8:
    case GltfComponent::kUint8:
      return 1;
    case GltfComponent::kInt16:
    case GltfComponent::kUint16:
      return 2;
    default:
      return 4;
  }
}

double gltf_number(std::string_view bytes, GltfComponent component) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < gltf_size(component); ++i) {
    bits |= std::uint32_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
  }
  switch (component) {
    case GltfComponent::kInt8:
      return static_cast<std::int8_t>(bits);
    case GltfComponent::kInt16:
      return static_cast<std::int16_t>(bits);
    case GltfComponent::kFloat:
      return std::bit_cast<float>(bits);
    default:
      return bits;
  }
}

std::size_t GltfLayout::column_bytes() const {
  const std::size_t bytes = static_cast<std::size_t>(width / columns) * gltf_size(component);
  return columns == 1 ? bytes : (bytes + 3) / 4 * 4;
}

std::size_t GltfLayout::bytes() const {
  return column_bytes() * static_cast<std::size_t>(columns);
}

void GltfLayout::append(std::string_view bytes, std::vector<double>& numbers) const {
  const double one = normalized ? largest(component) : 1.0;
  const std::size_t rows = static_cast<std::size_t>(width / columns);
  for (std::size_t column = 0; column < static_cast<std::size_t>(columns); ++column) {
    for (std::size_t row = 0; row < rows; ++row) {
      const std::size_t at = column * column_bytes() + row * gltf_size(component);
      const double value = gltf_number(bytes.substr(at), component);
      numbers.push_back(normalized ? std::max(value / one, -1.0) : value);
    }
  }
}

std::optional<GltfLayout> gltf_layout(const nlohmann::ordered_json& accessor) {
  const auto type = accessor.find("type"), kind = accessor.find("componentType");
  if (type == accessor.end() || kind == accessor.end() || !type->is_string()) return std::nullopt;
  const auto component = gltf_component(*kind);
  const auto* shape = std::ranges::find(kShapes, type->get_ref<const std::string&>(), &Shape::name);
  if (!component || shape == kShapes.end()) return std::nullopt;
  const auto normalized = accessor.find("normalized");
  const bool is_normalized =
      normalized != accessor.end() && value_from<bool>(*normalized).value_or(false);
  return GltfLayout{*component, shape->width, shape->columns,
                    is_normalized && *component != GltfComponent::kFloat};
}

}  // namespace retarget
