#pragma once

#include <span>
#include <string>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/report.h"
#include "retarget/robot.h"
#include "retarget/solve.h"

namespace RETARGET_API retarget {

/// A motion on a page, and what is known of it. What the pointers name lives until the page is made.
struct PageMotion {
  std::string label;                 ///< Any text; empty: the robot's name.
  const RobotClip* clip = nullptr;   ///< With frames.
  const HumanClip* human = nullptr;  ///< Its source, frame by frame; null: none.
  /// Its figures, gates, faults and contacts, as measure or evaluate gives them; null: none are shown.
  const QualityReport* report = nullptr;
  const LimitSet* limits = nullptr;  ///< Shaded beside the curves; null: the model's ranges.
};

struct PageOptions {
  std::string title;  ///< Of the window; any text. Empty: the labels.
  /// Folder with STL or OBJ files named like bodies, in metres or millimetres and in the bodies'
  /// frames: these are drawn in place of the collision primitives. Empty: none.
  std::string meshes;
};

/// One HTML file, with everything in it, that plays motions in a browser: side by side and in step,
/// each with its robot, its source, figures, gates and faults (docs/viewing.md). It asks for nothing
/// from anywhere, and its content security policy allows only its own script and style.
///
/// Positions are within 0.1 mm of the motion's, joint positions within 1e-4 rad (slides: 0.1 mm); the
/// page says how near. The same motions give the same bytes.
/// Errors (kInput): numbers that are no motion's, such as a root a hundred kilometres away; meshes that
/// cannot be read.
/// @pre at least one motion
[[nodiscard]] Result<std::string> view_page(std::span<const PageMotion> motions,
                                            const PageOptions& options = {});

/// The page of a motion that was solved, beside its source, with its figures.
/// @param report  of evaluate; null: it is measured here.
[[nodiscard]] Result<std::string> view_page(const Motion& motion, const std::string& label,
                                            const QualityReport* report = nullptr);

}  // namespace retarget
