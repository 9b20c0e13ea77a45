#pragma once

#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "retarget/bytes.h"

namespace retarget {

/// The bytes of numbers.
template <typename Number>
std::string packed(const std::vector<Number>& numbers) {
  std::string bytes(numbers.size() * sizeof(Number), '\0');
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

/// A glTF file of a moving node: times and values, stored as floats in the text.
struct Animated {
  std::string path = "translation", interpolation = "LINEAR", type = "VEC3";
  std::vector<float> times, values;
  std::string nodes = R"({"name": "Hips"})";
  std::string more;  ///< Members of the document, each preceded by a comma.
  std::string uri;   ///< URI of the buffer; empty: embedded in the text.

  [[nodiscard]] std::string bytes() const { return packed(times) + packed(values); }

  [[nodiscard]] std::string text() const {
    const std::string all = bytes();
    const std::size_t width = type == "VEC3" ? 3 : 4;
    return fmt::format(
        R"({{"asset": {{"version": "2.0"}}, "nodes": [{}], "buffers": [{{"byteLength": {}, "uri": "{}"}}],
"bufferViews": [{{"buffer": 0, "byteLength": {}}}, {{"buffer": 0, "byteOffset": {}, "byteLength": {}}}],
"accessors": [{{"bufferView": 0, "componentType": 5126, "count": {}, "type": "SCALAR"}},
{{"bufferView": 1, "componentType": 5126, "count": {}, "type": "{}"}}],
"animations": [{{"name": "move", "channels": [{{"sampler": 0, "target": {{"node": 0, "path": "{}"}}}}],
"samplers": [{{"input": 0, "output": 1, "interpolation": "{}"}}]}}]{}}})",
        nodes, all.size(),
        uri.empty() ? "data:application/octet-stream;base64," + base64_text(all) : uri,
        4 * times.size(), 4 * times.size(), 4 * values.size(), times.size(), values.size() / width,
        type, path, interpolation, more);
  }
};

}  // namespace retarget
