#pragma once

#include <string>
#include <vector>

#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/error.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"

namespace retarget {

/// The same of a human that is posed already.
[[nodiscard]] Result<PathMotion> fit_path(const HumanClip& human, const PathFitOptions& options);

/// The frame that moves along a path, per frame of a motion: its place, and the heading of the
/// tangent, going on steadily. While the body is still the heading goes over smoothly from that
/// before to that after, whatever the path does there; it takes the way round that is nearer to
/// `turns` (one per still phase), by whole turns.
/// @param along  metres, one per frame.
[[nodiscard]] std::vector<GroundPose> path_frames(const GroundPath& path,
                                                  const std::vector<double>& along,
                                                  const std::vector<StillPhase>& still,
                                                  const std::vector<double>& turns);

/// Turns at corners and cusps that are faster than a body turns (4 rad/s) are spread over the frames
/// before and after, up to a second; all other frames keep their headings.
void spread_turns(std::vector<GroundPose>& frames, const FrameRate& rate);

/// `3.2 m in 4 segments`
[[nodiscard]] std::string path_text(const GroundPath& path);

}  // namespace retarget
