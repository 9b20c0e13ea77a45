#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/motion_scene.h"
#include "retarget/report.h"
#include "retarget/robot.h"
#include "retarget/robot_meshes.h"
#include "retarget/run.h"
#include "retarget/scene.h"
#include "retarget/solve.h"

namespace RETARGET_API retarget {

// Pages and renderings of motions. A page is one HTML file that loads no other resource.

/// Number of bodies of a page with meshes and names of missing ones, as summary lines; empty if the
/// robot has none.
[[nodiscard]] std::vector<SummaryLine> mesh_lines(const RobotMeshes& meshes);

/// Summary line that states why a page omits a scene: more than 300,000 triangles, 20,000 shapes,
/// or a million poses of moving bodies. Empty if the page shows the scene, or if it is null.
[[nodiscard]] std::vector<SummaryLine> scene_lines(const SceneClip* scene);

/// A motion on a page, with optional data. The pointees must outlive the call that makes the page.
struct PageMotion {
  std::string label;                 ///< Any text; empty: the robot's name.
  const RobotClip* clip = nullptr;   ///< Motion with at least one frame.
  const HumanClip* human = nullptr;  ///< Source, one frame per frame of the clip; null: none.
  /// Metrics, gates, faults and contacts, from measure or evaluate; null: none are shown.
  const QualityReport* report = nullptr;
  const LimitSet* limits = nullptr;         ///< Shaded in the plots; null: the model's ranges.
  std::optional<FrameRate> file_rate = {};  ///< Original rate of a resampled clip.
  /// Drawn instead of the collision primitives; null: none. For several motions of one robot, the
  /// first motion's meshes are used.
  const RobotMeshes* meshes = nullptr;
  /// Drawn around the robot, and its human world around the human; null: none. Motions may share
  /// one.
  const MotionScene* scene = nullptr;
};

/// Links of a page in a gallery: addresses relative to the page; empty: no link.
struct PageLinks {
  std::string index;  ///< Index page of the gallery; empty: the page is not in a gallery.
  std::string previous, next;
};

/// Options of a page.
struct PageOptions {
  std::string title;  ///< Window title, any text; empty: the labels.
  PageLinks links = {};
};

/// Makes a self-contained HTML file that plays motions in a browser, side by side and in sync, each
/// with its robot, source, metrics, gates and faults (docs/viewing.md). The page loads no other
/// resource, and its content security policy allows only its own script and style.
///
/// Quantisation errors: root position 0.05 mm, joint positions 5e-5 rad (slides: 0.05 mm), bones
/// 0.075 mm along each axis, and bodies, whose errors accumulate along the kinematic chain, 0.2 mm
/// at most. The page states its accuracy. Equal motions give equal bytes for one zlib version.
/// Errors (kInput): implausible values, such as a root 100 km away.
/// @pre at least one motion
[[nodiscard]] Result<std::string> view_page(std::span<const PageMotion> motions,
                                            const PageOptions& options = {});

/// Makes the page of a solved motion, with its source and metrics.
/// @param report  result of evaluate; null: measured here.
/// @param meshes  see PageMotion::meshes.
[[nodiscard]] Result<std::string> view_page(const Motion& motion, const std::string& label,
                                            const QualityReport* report = nullptr,
                                            const RobotMeshes* meshes = nullptr);

/// Contents of a page that shows a human motion as in its file, before retargeting.
struct SkeletonPage {
  std::string title;           ///< Any text.
  const Clip* clip = nullptr;  ///< Without frames: only the rest pose is shown.
  /// Calibration of the human; null: not recognised. The body is then drawn 1.7 m high, with its
  /// longest axis up.
  const Calibration* calibration = nullptr;
  std::string facts;                ///< Findings, lines of text.
  std::vector<std::string> doubts;  ///< Warnings, one sentence each.
};

/// Makes an HTML file like view_page: the moving skeleton next to its rest pose, with the file's
/// axes. Joints mapped to a bone are coloured by side. Errors as view_page.
[[nodiscard]] Result<std::string> skeleton_page(const SkeletonPage& page);

/// A clip in a gallery. Texts need no escaping.
struct GalleryClip {
  std::string name;
  std::string robot;
  std::string page;     ///< URL of its page; empty: none.
  std::string picture;  ///< URL of its thumbnail; empty: none.
  int frames = 0;
  double fps = 30.0;
  bool failed = false;
  std::string message;    ///< Why the page or its motion is missing; empty: complete.
  bool measured = false;  ///< True if metrics and gates are known.
  std::vector<std::pair<std::string, double>> figures;  ///< Values by metric.
  std::vector<std::string> missed;                      ///< Metrics that missed their gates.
};

/// The group in which the index of a gallery opens with a clip: 0 all gates passed, 1 not measured,
/// 2 a gate missed, 3 failed, which is collapsed. Clips of a group keep their order.
[[nodiscard]] int opening_rank(const GalleryClip& clip);

/// Size of thumbnails, pixels.
inline constexpr double kThumbnailWidth = 320.0, kThumbnailHeight = 96.0;

/// Returns the page that lists the clips of a batch, with search, sorting and filters: one HTML
/// file that loads nothing except the thumbnails next to it.
/// @param clips  sorted, worst first.
[[nodiscard]] std::string gallery_page(const std::string& title,
                                       std::span<const GalleryClip> clips);

/// Returns the page for a clip without a playable motion: the reason, and links to the other clips.
[[nodiscard]] std::string gallery_note_page(const std::string& title, const std::string& message,
                                            const PageLinks& links);

/// Options for drawing a strip as SVG.
struct StripOptions {
  int poses = 6;      ///< Number of poses, at least one; limited to the number of frames.
  std::string title;  ///< Any text; empty: none.
};

/// Draws a motion as a row of evenly spaced poses from first to last frame, as an SVG file: the
/// robot's collision shapes above a floor line, with the time below. The root is centred in each
/// cell and heights are kept; all poses have the same scale and are seen from the robot's right,
/// relative to its mean facing direction.
/// @pre The motion has at least one frame.
/// @param human  the source of the motion, frame by frame, drawn in a separate row above the robot;
///   poses after its end are omitted. Null: none.
[[nodiscard]] std::string draw_strip(const RobotClip& motion, const HumanClip* human,
                                     const StripOptions& options = {});

/// Options for drawing a strip as PNG.
struct StripPictureOptions {
  int poses = 6;                  ///< See StripOptions::poses.
  double width = 1200.0;          ///< Maximum width of the image, pixels.
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

/// A page of a run (run_to_files): view_page of its motion, with meshes and metrics.
/// @param path  the file to write.
[[nodiscard]] RunDrawing page_of_run(std::string path);

/// A rendering of a run: draw_strip_picture of its motion.
/// @param poses  number of poses; 0: the default.
[[nodiscard]] RunDrawing picture_of_run(std::string path, int poses = 0);

}  // namespace retarget
