#pragma once

#include <span>
#include <string>
#include <vector>

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

/// Where a page of a gallery leads to: addresses relative to it; empty: nowhere.
struct PageLinks {
  std::string index;  ///< The gallery's own page; empty: the page is of no gallery.
  std::string previous, next;
};

struct PageOptions {
  std::string title;  ///< Of the window; any text. Empty: the labels.
  /// Folder with STL or OBJ files named like bodies, in metres or millimetres and in the bodies'
  /// frames: these are drawn in place of the collision primitives. Empty: none.
  std::string meshes = {};
  PageLinks links = {};
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

/// A human's motion as a file has it, before anything is made of it.
struct SkeletonPage {
  std::string title;           ///< Any text.
  const Clip* clip = nullptr;  ///< Without frames: the rest pose alone is shown.
  /// How the human in it is understood; null: it is not, and the body is drawn upright by the axis along
  /// which it is longest, 1.7 m high.
  const Calibration* calibration = nullptr;
  std::string facts;                ///< What was found, lines of text.
  std::vector<std::string> doubts;  ///< What may be wrong, one sentence each.
};

/// One HTML file like view_page's: the skeleton in motion beside its rest pose, the file's axes, joints
/// that stand for a bone coloured by side. Errors as view_page's.
[[nodiscard]] Result<std::string> skeleton_page(const SkeletonPage& page);

}  // namespace retarget
