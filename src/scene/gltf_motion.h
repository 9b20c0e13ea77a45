#pragma once

#include <memory>
#include <vector>

#include "scene/gltf_document.h"
#include "scene/scene.h"

namespace retarget {

/// Values at times: glTF's animation sampler.
struct GltfTrack {
  enum class Kind { kStep, kLinear, kCubic };

  Kind kind = Kind::kLinear;
  int width = 3;
  std::shared_ptr<const std::vector<double>> times;  ///< Seconds, ascending.
  std::vector<double> values;  ///< Cubic: in-tangent, value and out-tangent of each key.

  /// At a time; before the first key its value, after the last one the last one's. Rotations (width 4,
  /// x y z w) are interpolated as such, and of unit length.
  [[nodiscard]] Eigen::Vector4d at(double seconds) const;

  /// Whether its keys differ by more than rounding.
  [[nodiscard]] bool varies() const;

 private:
  [[nodiscard]] Eigen::Vector4d value(std::size_t key, std::size_t part) const;
};

/// What glTF animates of a node.
enum class GltfPath { kTranslation, kRotation, kScale };

class GltfMotion : public SceneMotion {
 public:
  /// @param nodes  in the scene's order.
  explicit GltfMotion(const std::vector<SceneNode>& nodes);

  /// Reads an animation. @param scene_nodes  the scene's node of each node of the document
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
  // by node
  using Channels = std::vector<Channel>;
  std::vector<Channels> takes_;
};

}  // namespace retarget
