#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "retarget/view.h"
#include "view/track_packer.h"

namespace retarget {

/// What a page shows of a robot: links, bodies, joints, shapes, soles. Lengths in metres, quaternions
/// wxyz, poses as [x, y, z, w, x, y, z] with the quaternion last.
[[nodiscard]] nlohmann::ordered_json page_robot(const Robot& robot);

/// How pages draw humans: colours by side, 0xRRGGBB, and chains of bones.
[[nodiscard]] nlohmann::ordered_json page_figure();

/// `left`, `right`, `middle`.
[[nodiscard]] const char* side_name(Side side);

/// What a page shows of a report: figures with what they mean, gates, faults by kind, tracking.
[[nodiscard]] nlohmann::ordered_json page_report(const QualityReport& report, const Robot& robot);

/// In what way a fault of a metric is one, as pages tell them apart: `jump`, `penetration`, `slip`,
/// `self-collision`, `limit`, `speed`, `floating`, `lean`, `other`.
[[nodiscard]] std::string_view fault_kind(std::string_view metric);

/// Where a human is drawn so that it walks beside its robot: at the robot's size, its path on the
/// robot's. x_shown = scale * turned(x) + shift on the ground; heights are scaled alone.
struct HumanPlacement {
  double scale = 1.0;
  double yaw = 0.0;  ///< Anticlockwise seen from above, rad.
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
};

/// From the paths of root and hips over all frames (least squares: the motion may have been turned and
/// moved). Of those who stay where they are the scale is the ratio of their mean heights; where the
/// paths are not alike the turn is that from where the human faces to where the robot does, if it is
/// more than some degrees.
[[nodiscard]] HumanPlacement place_human(const RobotClip& motion, const HumanClip& human);

/// All data of a page: a header, and numbers over time; both as packed_text, which may stand anywhere
/// in HTML, whatever the names in it are.
struct PageData {
  std::string header;  ///< JSON.
  std::string tracks;  ///< TrackPacker's.
};

/// @param options  with a title.
[[nodiscard]] Result<PageData> page_data(std::span<const PageMotion> motions,
                                         const PageOptions& options);

/// JSON as packed_text.
[[nodiscard]] Result<std::string> packed_json(const nlohmann::ordered_json& json);

/// The whole file: shell, style, script and data.
[[nodiscard]] std::string assemble_page(const std::string& title, PageData data);

}  // namespace retarget
