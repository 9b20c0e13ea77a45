#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/normalize_start.h"
#include "retarget/pose.h"
#include "retarget/solve.h"
#include "retarget/view.h"
#include "view/scene_data.h"

namespace retarget {

/// A solved motion as it is written, and its source frame by frame.
struct WrittenMotion {
  RobotClip clip;
  HumanClip human;

  explicit WrittenMotion(const Motion& motion)
      : clip(motion.clip), human(to_human(*motion.source, motion.plan.human.calibration)) {
    if (motion.plan.options.save.normalize_start) normalize_start(clip);
  }
};

// Steps of numbers on a page; the error is half a step.
inline constexpr double kPageRootStep = 1e-4;        ///< Metres.
inline constexpr double kPageQuaternionStep = 2e-5;  ///< Step of each component.
inline constexpr double kPageMeshStep = 4e-4;        ///< Metres.

/// A pose as [x, y, z, w, x, y, z], the quaternion last.
[[nodiscard]] nlohmann::ordered_json page_pose(const Pose& pose);

/// Returns the robot data of a page: links, bodies, joints, shapes, soles. Lengths in metres,
/// quaternions wxyz, poses as [x, y, z, w, x, y, z] with the quaternion last.
[[nodiscard]] nlohmann::ordered_json page_robot(const Robot& robot);

/// Returns the colours by side, 0xRRGGBB, and the chains of bones with which pages draw humans.
[[nodiscard]] nlohmann::ordered_json page_figure();

/// Returns `left`, `right` or `middle`.
[[nodiscard]] const char* side_name(Side side);

/// Returns the report data of a page: metrics with descriptions, gates, faults by kind, tracking.
[[nodiscard]] nlohmann::ordered_json page_report(const QualityReport& report, const Robot& robot);

/// Returns the kind of a metric's faults, as pages group them: `jump`, `penetration`, `slip`,
/// `self-collision`, `limit`, `speed`, `floating`, `lean`, `scene`, `other`.
[[nodiscard]] std::string_view fault_kind(std::string_view metric);

/// Placement that draws a human next to its robot: scaled to the robot's size, with its path on the
/// robot's. On the ground x_shown = scale * turned(x) + shift; heights are only scaled.
struct HumanPlacement {
  double scale = 1.0;
  double yaw = 0.0;  ///< Anticlockwise seen from above, rad.
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
};

/// Computes the placement from the paths of root and hips over all frames (least squares, because
/// the motion may have been rotated and moved). For motions in place, the scale is the ratio of the
/// mean heights. If the paths do not correspond, the rotation is that from the human's to the
/// robot's facing direction, provided it exceeds a threshold (0.3 rad).
[[nodiscard]] HumanPlacement place_human(const RobotClip& motion, const HumanClip& human);

/// All data of a page: a header and time series; both as packed_text, which is safe in HTML for any
/// names.
struct PageData {
  std::string header;  ///< JSON.
  std::string tracks;  ///< Output of TrackPacker.
};

/// @param options  must have a title.
[[nodiscard]] Result<PageData> page_data(std::span<const PageMotion> motions,
                                         const PageOptions& options);

/// The tracks of a page as its header lists them.
[[nodiscard]] nlohmann::ordered_json tracks_json(const TrackPacker& packer);

[[nodiscard]] Result<PageData> packed_page(const nlohmann::ordered_json& header,
                                           const TrackPacker& packer);

/// Assembles the whole file from shell, style, script and data.
[[nodiscard]] std::string assemble_page(const std::string& title, PageData data);

}  // namespace retarget
