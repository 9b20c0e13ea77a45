#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/scene.h"

namespace RETARGET_API retarget {

/// SceneContact::body of a contact with the floor z = 0.
inline constexpr int kFloorBody = -1;
/// Name of the floor among the surfaces of contacts.
inline constexpr const char* kFloorName = "floor";

/// A contact of a human's body part with a body of the scene.
struct SceneContact {
  Bone part = Bone::kHips;  ///< One of kSupportBones.
  int body = 0;             ///< Index of the scene's body, or kFloorBody.
  int begin = 0, end = 0;   ///< Frames [begin, end).
  bool slides = false;      ///< Whether the part slides along the surface.

  friend bool operator==(const SceneContact&, const SceneContact&) = default;
};

struct SceneWorld;

/// The scene of a robot's motion.
struct SolvedScene {
  /// Static bodies and all paths scaled about the origin; objects at their own size.
  SceneClip clip;
  std::shared_ptr<const SceneWorld> human;  ///< Scene around the human, in the same frames.
  double scale = 1.0;                       ///< Scale from the human's to the robot's scene.
  /// Contacts of the human's parts with bodies of the scene; those of feet are in Motion::contacts.
  std::vector<SceneContact> contacts;
  std::vector<SceneContact> on_floor;  ///< Contacts of the same parts with the floor.
  /// Body of the scene under the foot, or kFloorBody, for each phase of Motion::contacts.
  std::array<std::vector<int>, 4> under_feet;
};

/// A contact of a robot's body with a surface that the fit takes from the human.
struct SurfaceTouch {
  std::string part;        ///< Part of the human: `left_hand`, `left_heel`, `seat`, ...
  std::string link;        ///< Body of the robot.
  std::string surface;     ///< Body of the scene, or kFloorName.
  int begin = 0, end = 0;  ///< Frames [begin, end) of the motion.
  bool slides = false;     ///< Whether the part slides along the surface.
};

/// All contacts of a motion, sorted by part and surface.
struct ContactLabels {
  int frame_count = 0;  ///< Number of frames of the motion.
  std::vector<SurfaceTouch> touches;
};

}  // namespace retarget
