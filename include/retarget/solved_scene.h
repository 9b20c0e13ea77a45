#pragma once

#include <string>
#include <vector>

#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/scene.h"

namespace RETARGET_API retarget {

/// A contact of a human's body part with a body of the scene.
struct SceneContact {
  Bone part = Bone::kHips;  ///< One of kSupportBones.
  int body = 0;             ///< Of the scene.
  int begin = 0, end = 0;   ///< Frames [begin, end).
  bool slides = false;      ///< It moves over the surface.

  friend bool operator==(const SceneContact&, const SceneContact&) = default;
};

/// The scene of a robot's motion.
struct SolvedScene {
  SceneClip clip;      ///< Static bodies and all paths scaled about the origin; objects of their size.
  SceneClip human;     ///< Around the human, in the frames of the motion.
  double scale = 1.0;  ///< From the human's world to the robot's.
  std::vector<SceneContact> contacts;  ///< Of the human; those of feet are in Motion::contacts.
};

}  // namespace retarget
