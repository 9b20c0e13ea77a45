#pragma once

#include <optional>
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
#include "retarget/triangle_mesh.h"

namespace RETARGET_API retarget {

/// What a body looks like.
struct BodyMesh {
  int body = 0;
  TriangleMesh mesh;  ///< In the body's frame.
};

/// What the bodies of a robot look like.
struct RobotMeshes {
  std::vector<BodyMesh> bodies;    ///< At most one for each body.
  std::vector<std::string> notes;  ///< What could not be had, a sentence each.
};

/// The meshes of a robot, STL, OBJ and COLLADA files, simplified so that a page stays small.
///
/// The files are those that a model names (MJCF: `<mesh file>` with meshdir, scale, refpos and refquat;
/// URDF: `<visual>`, also `package://`), at the places and in the unit that it gives them. A body that is
/// shown by geoms without contacts has these, else all of its meshes.
/// @param model  the robot's own; its files lie in its folder or in that above. What cannot be had is
///               noted and no error. Empty: none is known.
/// @param named  what someone asked for; empty: nothing. Another model of the robot, in place of its own;
///               or a folder in which the model's files are looked for first, then files that are named like
///               bodies: in metres, or in millimetres if larger than 10 m, and in the bodies' frames.
/// Errors (of what was named): kUsage, no such folder; kInput, a mesh that cannot be read, none that
/// fits; kConfig, a model that cannot be read.
[[nodiscard]] Result<RobotMeshes> load_robot_meshes(const Robot& robot, const std::string& model,
                                                    const std::string& named = {});

/// A motion on a page, and what is known of it. What the pointers name lives until the page is made.
struct PageMotion {
  std::string label;                 ///< Any text; empty: the robot's name.
  const RobotClip* clip = nullptr;   ///< With frames.
  const HumanClip* human = nullptr;  ///< Its source, frame by frame; null: none.
  /// Its figures, gates, faults and contacts, as measure or evaluate gives them; null: none are shown.
  const QualityReport* report = nullptr;
  const LimitSet* limits = nullptr;         ///< Shaded beside the curves; null: the model's ranges.
  std::optional<FrameRate> file_rate = {};  ///< If the clip was resampled: its rate before.
  /// Drawn in place of the collision primitives; null: none. Of several motions of one robot the first's.
  const RobotMeshes* meshes = nullptr;
};

/// Where a page of a gallery leads to: addresses relative to it; empty: nowhere.
struct PageLinks {
  std::string index;  ///< The gallery's own page; empty: the page is of no gallery.
  std::string previous, next;
};

struct PageOptions {
  std::string title;  ///< Of the window; any text. Empty: the labels.
  PageLinks links = {};
};

/// One HTML file, with everything in it, that plays motions in a browser: side by side and in step,
/// each with its robot, its source, figures, gates and faults (docs/viewing.md). It asks for nothing
/// from anywhere, and its content security policy allows only its own script and style.
///
/// The root is within 0.05 mm of the motion's, joint positions within 5e-5 rad (slides: 0.05 mm), bones
/// within 0.075 mm along each axis, and bodies, whose errors add up along their chains, within 0.2 mm;
/// the page says how near. The same motions give the same bytes with the same version of zlib.
/// Errors (kInput): numbers that are no motion's, such as a root a hundred kilometres away.
/// @pre at least one motion
[[nodiscard]] Result<std::string> view_page(std::span<const PageMotion> motions,
                                            const PageOptions& options = {});

/// The page of a motion that was solved, beside its source, with its figures.
/// @param report  of evaluate; null: it is measured here.
/// @param meshes  as PageMotion's.
[[nodiscard]] Result<std::string> view_page(const Motion& motion, const std::string& label,
                                            const QualityReport* report = nullptr,
                                            const RobotMeshes* meshes = nullptr);

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
