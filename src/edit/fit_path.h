#pragma once

#include <string>
#include <vector>

#include "edit/ground_path.h"
#include "human/human_clip.h"
#include "retarget/error.h"

namespace retarget {

struct PathFitOptions {
  double tolerance = 0.05;       ///< Largest distance of the curve from the track, metres.
  double low_pass = 0.5;         ///< Cut-off for the hips' track, Hz: what strides sway is no path.
  double still_step = 0.03;      ///< The track goes on when the hips have come so far, metres.
  double first_piece = 2.0;      ///< Length of the segments that are tried first, metres,
  double shortest_piece = 0.25;  ///< and of the shortest into which they are split.
  double still_speed = 0.1;      ///< Slower than this a body has no direction of its way, m/s.
};

/// Frames [begin, end) in which the body does not go anywhere.
struct StillPhase {
  int begin = 0, end = 0;
  double turn = 0.0;  ///< Of the hips, from the frame before to the frame after, radians.
};

/// The way of a human over the ground.
struct PathMotion {
  GroundPath path;
  std::vector<double> along;  ///< Metres along the path, per frame; never decreasing.
  std::vector<StillPhase> still;
  double largest_distance = 0.0;  ///< Of the path from the smoothed track, metres.
};

/// Fits a path to the track of the hips (Gleicher: Motion Path Editing, 2001).
///
/// The track is low-passed without delay and thinned to steps of `still_step`, so that who stands
/// makes no path. A chain of cubics by chord length, with one tangent at each joint and hence
/// without corners, is fitted to it by least squares; segments that leave the track by more than
/// the tolerance are split and all is fitted again. A body that stays within a step gets a path of
/// a millimetre in the direction it faces.
///
/// @param file  for messages.
/// @return a kInput error for a clip without frames.
[[nodiscard]] Result<PathMotion> fit_path(const HumanClip& human, const PathFitOptions& options,
                                          const std::string& file);

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

}  // namespace retarget
