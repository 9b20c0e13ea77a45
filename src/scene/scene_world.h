#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "retarget/error.h"
#include "retarget/scene.h"

namespace retarget {

/// A scene over time and the distance fields of its bodies. World frame: metres, Z up, floor z = 0.
struct SceneWorld {
  SceneClip clip;
  std::vector<DistanceField> fields;  ///< One per body, for the sizes in `scales`.
  std::vector<double> scales;         ///< Size relative to that of the field, by body.
  std::vector<char> fixed;            ///< By body: whether it keeps the pose of the scene's file.

  [[nodiscard]] std::size_t body_count() const { return fields.size(); }
  [[nodiscard]] bool moves(std::size_t body) const { return clip.scene->bodies[body].moves; }
  /// Whether a body carries feet and scales with its surroundings: it is static, or may move but has
  /// no track.
  [[nodiscard]] bool is_fixed(std::size_t body) const { return fixed[body] != 0; }
  /// Signed distance of a point in the world to a body; the normal is in world axes. No way leads
  /// out of a fixed body through an underside on the floor; its sides and its top are the nearest.
  [[nodiscard]] SurfaceDistance distance(int frame, std::size_t body,
                                         const Eigen::Vector3d& point) const;
  /// Whether a body is farther from a point than `distance`, metres, by its bounding sphere: a fast
  /// test that is true only if distance() is greater.
  [[nodiscard]] bool is_beyond(int frame, std::size_t body, const Eigen::Vector3d& point,
                               double distance) const {
    const double reach = scales[body] * fields[body].reach() + distance;
    return (point - clip.pose(frame, body).translation).squaredNorm() > reach * reach;
  }
  /// Height of the highest surface of the fixed bodies that is below a point, metres; 0 (the
  /// floor) if there is none. Bodies that contain the point are not below it.
  [[nodiscard]] double ground_below(int frame, const Eigen::Vector3d& point) const;
};

/// Builds the distance fields of a scene. Errors: those of make_distance_field.
[[nodiscard]] Result<SceneWorld> make_scene_world(SceneClip clip);

/// The shape scaled about the origin of its body's frame.
[[nodiscard]] SceneShape scaled_shape(SceneShape shape, double scale);

/// The point of a moving body that stays in place relative to its surroundings when their size, or
/// its own, changes: it has the height of the body's lowest point, so that an object rests on a
/// scaled surface as on the original one, below or above the centre of its shapes. It does not
/// depend on the origin of the body's frame.
class BodyAnchor {
 public:
  /// @param field  distance field of the body; must outlive the result.
  BodyAnchor(const SceneBody& body, const DistanceField& field);

  /// The anchor relative to the origin of the body's frame, world axes, metres.
  [[nodiscard]] Eigen::Vector3d at(const Eigen::Quaterniond& world_from_body) const;

 private:
  Eigen::Vector3d centre_;  // Of its shapes, in the frame of the body.
  const DistanceField* field_;
};

/// The scene around a body of another size: fixed bodies and all paths are scaled about the origin
/// of the world. Other bodies keep their size, and their anchors have scaled positions.
[[nodiscard]] SceneWorld scaled_world(const SceneWorld& world, double scale);

}  // namespace retarget
