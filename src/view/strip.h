#pragma once

#include <string>

#include "human/human_clip.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/solve.h"

namespace retarget {

struct StripOptions {
  int poses = 6;      ///< As many as the motion has frames at most; at least one.
  std::string title;  ///< Any text; empty: none.
};

/// A motion as a row of poses from its first frame to its last, evenly spread, as an SVG file: the
/// robot as its collision shapes above a line for the floor, its time below. The root stays in the
/// middle of its place, heights are kept; all is drawn to one scale, seen from the side that lies to
/// the right of where the robot faces on the whole.
/// @pre the motion has a frame
/// @param human  in a row of its own above the robot: frame by frame the source of the motion; poses
///               behind its end are left out. Null: none.
[[nodiscard]] std::string draw_strip(const RobotClip& motion, const HumanClip* human,
                                     const StripOptions& options = {});

struct StripPictureOptions {
  int poses = 6;                  ///< As of StripOptions.
  double width = 1200.0;          ///< Of the picture at most, pixels.
  double max_row_height = 420.0;  ///< Of the highest figure, pixels.
  bool times = true;              ///< Below the poses.
};

/// The same strip as the bytes of a PNG: shaded, with soft shadows, from the same place.
/// @pre the motion has a frame
[[nodiscard]] std::string draw_strip_picture(const RobotClip& motion, const HumanClip* human,
                                             const StripPictureOptions& options = {});

/// The picture of a motion that was solved, its source above it.
[[nodiscard]] std::string draw_strip_picture(const Motion& motion,
                                             const StripPictureOptions& options = {});

}  // namespace retarget
