#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "retarget/human.h"

namespace retarget {

/// Posture of the source's body, by frame of a motion.
struct Posture {
  /// By frame: included in metrics of standing bodies. Excludes frames in which the body lies or
  /// crawls and those within half a second, during which it is getting down or up.
  std::vector<char> upright;
  /// Percentage of the source's frames in which the body lies or crawls. Nothing for bodies without
  /// a trunk or a leg, whose posture is unknown; they count as upright.
  std::optional<double> lying_pct;

  [[nodiscard]] bool is_upright(int frame) const {
    return upright[static_cast<std::size_t>(frame)] != 0;
  }
  /// Whether the body is upright in any of the first frames.
  [[nodiscard]] bool ever_upright(int frames) const {
    return std::find(upright.begin(), upright.begin() + frames, 1) != upright.begin() + frames;
  }
};

/// @param frames         number of frames of the motion.
/// @param source_frames  number of these that the source covers; the rest counts as upright.
[[nodiscard]] Posture find_posture(const HumanClip& human, int frames, int source_frames);

/// Posture of a motion whose source is unknown.
[[nodiscard]] Posture upright_posture(int frames);

}  // namespace retarget
