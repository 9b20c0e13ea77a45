#pragma once

#include <string>

#include "human/skeleton/human_clip.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/solve.h"

namespace retarget {

struct StripOptions {
  int poses = 6;      ///< At least one; limited to the number of frames.
  std::string title;  ///< Any text; empty: none.
};

/// Draws a motion as a row of evenly spaced poses from first to last frame, as an SVG file: the
/// robot's collision shapes above a floor line, with the time below. The root is centred in each
/// cell and heights are kept; all poses have the same scale and are seen from the robot's right,
/// relative to its mean facing direction.
/// @pre The motion has at least one frame.
/// @param human  the source of the motion, frame by frame, drawn in a separate row above the robot;
///   poses after its end are left out. Null: none.
[[nodiscard]] std::string draw_strip(const RobotClip& motion, const HumanClip* human,
                                     const StripOptions& options = {});

struct StripPictureOptions {
  int poses = 6;                  ///< As StripOptions::poses.
  double width = 1200.0;          ///< Maximum width of the picture, pixels.
  double max_row_height = 420.0;  ///< Maximum height of the tallest figure, pixels.
  bool times = true;              ///< Draw times below the poses.
};

/// Draws the same strip as a PNG: shaded, with soft shadows, from the same viewpoint.
/// @pre The motion has at least one frame.
[[nodiscard]] std::string draw_strip_picture(const RobotClip& motion, const HumanClip* human,
                                             const StripPictureOptions& options = {});

/// Draws a solved motion with its source above it.
[[nodiscard]] std::string draw_strip_picture(const Motion& motion,
                                             const StripPictureOptions& options = {});

}  // namespace retarget
