#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/scene/scene.h"
#include "retarget/error.h"
#include "retarget/file.h"

namespace retarget {

using GltfJson = nlohmann::ordered_json;

/// A member of an object; null if it is missing or `object` is not an object.
[[nodiscard]] const GltfJson* gltf_member(const GltfJson& object, const char* key);

/// A glTF 2.0 file: its JSON and the numbers that it refers to. Khronos, "glTF 2.0 Specification",
/// 2021.
///
/// Buffers are in the file itself (GLB), embedded as text (`data:`), or in files next to it, given
/// by a relative name that stays inside the file's folder. Buffers are read when their numbers are
/// requested, so textures are never read.
class GltfDocument {
 public:
  /// @param bytes      the whole file, GLB or JSON; must outlive the document.
  /// @param max_bytes  limit on external files and numbers together.
  [[nodiscard]] static Result<GltfDocument> open(std::string_view bytes,
                                                 const std::string& file_name,
                                                 std::size_t max_bytes);

  [[nodiscard]] const GltfJson& json() const { return json_; }
  [[nodiscard]] const std::string& file_name() const { return file_name_; }

  /// A list of the document, such as `nodes`; empty if it is missing.
  [[nodiscard]] const GltfJson& list(const char* name) const;
  /// An element of a list; null if the index is out of range or the element is not an object.
  [[nodiscard]] const GltfJson* element(const char* list, const GltfJson& number) const;

  /// Reads all numbers of an accessor, element by element. Normalised integers are scaled to -1 ...
  /// 1.
  /// @param width  expected count of numbers per element; another count is an error.
  /// Errors (kInput): data outside of a buffer, numbers that are not finite, compressed buffers.
  [[nodiscard]] Result<std::vector<double>> numbers(const GltfJson& accessor, int width);

  /// An error about this file.
  [[nodiscard]] Failure fault(std::string what, std::string hint = {}) const;

 private:
  // A strided sequence of elements in a buffer.
  struct Run {
    std::string_view bytes;
    std::size_t stride = 0;
  };

  // NOLINTNEXTLINE(bugprone-exception-escape): an empty JSON value allocates nothing
  GltfDocument() = default;
  Result<void> split(std::string_view bytes);
  Result<std::string_view> buffer(const GltfJson& number);
  Result<std::shared_ptr<const std::string>> read_buffer(const GltfJson& buffer);
  // Adds to the kept bytes; an error if there are too many.
  Result<void> take_bytes(std::size_t bytes);
  Result<std::string_view> buffer_view(const GltfJson& number, std::size_t& stride);
  Result<Run> run_of(const GltfJson& view, const GltfJson& place, std::size_t count,
                     std::size_t element_bytes);
  Result<void> replace_sparse(const GltfJson& sparse, const GltfJson& accessor, int width,
                              std::vector<double>& numbers);

  std::string file_name_;
  GltfJson json_;
  std::optional<std::string_view> binary_;                   // Binary chunk of a GLB.
  std::vector<std::shared_ptr<const std::string>> buffers_;  // Null until read.
  // External files by path, since several buffers may refer to one file.
  std::map<std::string, std::shared_ptr<const std::string>> files_;
  std::size_t max_bytes_ = 0;
  std::size_t taken_ = 0;      // Bytes of numbers read so far.
  std::size_t available_ = 0;  // Bytes of buffers read so far.
  std::size_t kept_ = 0;       // Bytes of both that are kept.
};

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
  /// @param nodes  nodes in the scene's order.
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
