#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "retarget/human.h"
#include "scene/scene_world.h"

namespace retarget {

/// Posture of the source's body in the frames of a motion.
struct Posture {
  /// One entry per frame: whether the body is upright. Metrics of standing bodies use only these
  /// frames.
  /// Frames less than half a second from one in which the body lies or crawls are not upright,
  /// because the body is getting down or up.
  std::vector<char> upright;
  /// Percentage of the source's frames in which the body lies or crawls. Empty for bodies without a
  /// trunk or a leg, whose posture is unknown; all their frames are upright.
  std::optional<double> lying_pct;
  double floor = 0.0;  ///< Height of the floor under the source, metres.

  [[nodiscard]] bool is_upright(int frame) const {
    return upright[static_cast<std::size_t>(frame)] != 0;
  }
  /// Whether the body is upright in at least one of the first `frames` frames.
  [[nodiscard]] bool ever_upright(int frames) const {
    return std::find(upright.begin(), upright.begin() + frames, 1) != upright.begin() + frames;
  }
};

/// Finds the posture from trunk and hips of the human.
/// @param frames         number of frames of the motion.
/// @param source_frames  number of these frames that the source covers; the rest is upright.
/// @param floor          height of the floor under the source, metres.
/// @param scene          scene around the source, whose bodies may carry it; null: none.
[[nodiscard]] Posture find_posture(const HumanClip& human, int frames, int source_frames,
                                   double floor, const SceneWorld* scene);

/// Posture of a motion without a known source: upright in all frames.
[[nodiscard]] Posture upright_posture(int frames);

}  // namespace retarget
