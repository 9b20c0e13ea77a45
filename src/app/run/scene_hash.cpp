#include "app/run/scene_hash.h"

#include <Eigen/Core>
#include <array>
#include <bit>
#include <utility>

#include "base/try.h"
#include "retarget/hash.h"
#include "retarget/scene.h"
#include "scene/read_scene.h"

namespace retarget {
namespace {

// Feeds values to a hash; numbers as their bytes.
class SceneHasher {
 public:
  explicit SceneHasher(ContentHasher hasher) : hasher_(std::move(hasher)) {}

  void add(const SceneBody& body) {
    add(body.name);
    add(body.world_from_body);
    add(body.moves ? 1.0 : 0.0);
    add(body.mass);
    add(static_cast<double>(body.shapes.size()));
    for (const SceneShape& shape : body.shapes) add(shape);
  }
  [[nodiscard]] Result<std::string> finish() { return hasher_.finish(); }

 private:
  void add(double value) {
    const auto bytes = std::bit_cast<std::array<char, sizeof value>>(value);
    hasher_.update({bytes.data(), bytes.size()});
  }
  void add(const std::string& text) {
    add(static_cast<double>(text.size()));
    hasher_.update(text);
  }
  void add(const Eigen::Vector3d& vector) {
    for (const double value : vector) add(value);
  }
  void add(const Pose& pose) {
    for (const double value : pose.rotation.coeffs()) add(value);
    add(pose.translation);
  }
  void add(const SceneShape& shape) {
    add(static_cast<double>(shape.type));
    add(shape.body_from_shape);
    add(shape.half_size);
    add(shape.radius);
    add(shape.half_length);
    add(shape.mesh ? static_cast<double>(shape.mesh->vertices.size()) : -1.0);
    if (!shape.mesh) return;
    for (const Eigen::Vector3d& vertex : shape.mesh->vertices) add(vertex);
    for (const auto& triangle : shape.mesh->triangles) {
      for (const int corner : triangle) add(static_cast<double>(corner));
    }
  }

  ContentHasher hasher_;
};

}  // namespace

Result<std::string> scene_hash(const std::string& file) {
  constexpr double kSmallestUnit = 0.001;  // Metres.
  TRY_ASSIGN(const Scene scene, load_scene_in_unit(file, kSmallestUnit));
  TRY_ASSIGN(auto content, ContentHasher::create());
  SceneHasher hasher(std::move(content));
  for (const SceneBody& body : scene.bodies) hasher.add(body);
  return hasher.finish();
}

}  // namespace retarget
