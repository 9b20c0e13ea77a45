#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "retarget/error.h"
#include "retarget/motion_scene.h"
#include "retarget/scene.h"
#include "retarget/triangle_mesh.h"
#include "view/track_packer.h"

namespace retarget {

/// Why a page cannot hold a scene; empty if it can.
[[nodiscard]] std::string scene_excess(const SceneClip& scene);

/// Adds a mesh as two tracks whose frames are vertices (metres) and triangles, and puts their indices
/// into `json`. Errors: those of TrackPacker::add.
[[nodiscard]] Result<void> pack_mesh(const TriangleMesh& mesh, TrackPacker& packer,
                                     nlohmann::ordered_json& json);

/// Makes the scenes of a page. A mesh that several scenes share is written once.
class ScenePacker {
 public:
  /// Packs a scene: `bodies` with names and shapes in the sizes of the robot's world; `robot` and, if
  /// there is one, `human`: the worlds. A world has the number of `frames`, `poses` by body (null: the
  /// body moves), and tracks of the moving bodies: `position` (metres) and `rotation` (wxyz), body by
  /// body. `scale`: size of static bodies in the robot's world relative to the human's.
  /// Errors: those of TrackPacker::add.
  [[nodiscard]] Result<nlohmann::ordered_json> pack(const MotionScene& scene, TrackPacker& packer);

 private:
  [[nodiscard]] Result<nlohmann::ordered_json> shape_json(const SceneShape& shape,
                                                          TrackPacker& packer);

  std::map<const TriangleMesh*, nlohmann::ordered_json> meshes_;
};

/// The contacts of a motion with bodies of its scene, a list of objects: `part`, `surface`, and
/// `phases`, frames [begin, end) sorted by time.
/// @param frames  of the motion; contacts end there.
[[nodiscard]] nlohmann::ordered_json page_touches(const ContactLabels& labels, int frames);

}  // namespace retarget
