#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "retarget/human.h"

namespace retarget {

/// A human with only these bones, by name, which do not move.
inline HumanClip still_human(const std::vector<std::pair<std::string, Eigen::Vector3d>>& places,
                             int frames) {
  HumanClip human;
  human.frame_count = frames;
  human.world_from_bone.resize(static_cast<std::size_t>(frames));
  for (const auto& [name, place] : places) {
    const Bone bone = bone_from_name(name).value();
    human.sources[bone] = name;
    for (HumanPose& frame : human.world_from_bone) frame[bone].translation = place;
  }
  return human;
}

}  // namespace retarget
