#pragma once

#include <cstddef>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "formats/scene/gltf_document.h"
#include "formats/scene/scene.h"

namespace retarget {

/// Keyframes of one property: glTF's animation sampler.
struct GltfTrack {
  enum class Kind { kStep, kLinear, kCubic };

  Kind kind = Kind::kLinear;
  int width = 3;
  std::shared_ptr<const std::vector<double>> times;  ///< Seconds, non-decreasing.
  std::vector<double> values;  ///< Cubic: in-tangent, value and out-tangent per key.

  /// Evaluates the track. Before the first and after the last key the value is constant. Rotations
  /// (width 4, x y z w) are interpolated as rotations and have unit length.
  [[nodiscard]] Eigen::Vector4d at(double seconds) const;

  /// Whether the keys differ by more than rounding.
  [[nodiscard]] bool varies() const;

 private:
  [[nodiscard]] Eigen::Vector4d value(std::size_t key, std::size_t part) const;
};

/// The node properties that glTF can animate.
enum class GltfPath { kTranslation, kRotation, kScale };

class GltfMotion : public SceneMotion {
 public:
  /// @param nodes  in the scene's order.
  explicit GltfMotion(const std::vector<SceneNode>& nodes);

  /// Adds an animation. @param scene_nodes  maps nodes of the document to nodes of the scene
  [[nodiscard]] Result<SceneTake> add(GltfDocument& document, const GltfJson& animation,
                                      const std::vector<int>& scene_nodes);

  [[nodiscard]] NodeTransform at(int take, int node, double seconds) const override;
  [[nodiscard]] std::vector<double> key_times(int take,
                                              const std::vector<bool>& nodes) const override;

 private:
  struct Channel {
    int node = -1;
    GltfPath path = GltfPath::kTranslation;
    GltfTrack track;
  };
  Result<GltfTrack> read_track(GltfDocument& document, const GltfJson& sampler, GltfPath path);

  std::vector<NodeTransform> rest_;
  // By node.
  using Channels = std::vector<Channel>;
  std::vector<Channels> takes_;
};

/// Storage type of an accessor's numbers: glTF's `componentType`.
enum class GltfComponent {
  kInt8 = 5120,
  kUint8 = 5121,
  kInt16 = 5122,
  kUint16 = 5123,
  kUint32 = 5125,
  kFloat = 5126,
};

[[nodiscard]] std::optional<GltfComponent> gltf_component(const nlohmann::ordered_json& type);

/// Bytes per number.
[[nodiscard]] std::size_t gltf_size(GltfComponent component);

/// Decodes the little-endian number at the beginning of `bytes`. @pre there are gltf_size bytes
[[nodiscard]] double gltf_number(std::string_view bytes, GltfComponent component);

/// Memory layout of an accessor's elements.
struct GltfLayout {
  GltfComponent component = GltfComponent::kFloat;
  int width = 1;            ///< Numbers per element.
  int columns = 1;          ///< Columns of a matrix; each begins at a multiple of four bytes.
  bool normalized = false;  ///< Integers represent -1 ... 1 or 0 ... 1.

  /// Bytes per element.
  [[nodiscard]] std::size_t bytes() const;
  /// Appends the numbers of one element. @pre there are bytes() bytes
  void append(std::string_view bytes, std::vector<double>& numbers) const;

 private:
  [[nodiscard]] std::size_t column_bytes() const;
};

/// The layout of an accessor; nothing if it is invalid.
[[nodiscard]] std::optional<GltfLayout> gltf_layout(const nlohmann::ordered_json& accessor);

}  // namespace retarget
