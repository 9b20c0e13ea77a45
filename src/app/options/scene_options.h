#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "retarget/error.h"
#include "retarget/option_table.h"
#include "retarget/options.h"

namespace retarget {

/// Option rows of a scene and its changes.
[[nodiscard]] OptionTable scene_table(SolveOptions& options);

/// Ground that rises in one direction (SolveOptions::terrain).
struct TerrainShape {
  double rise = 0.0, tread = 0.0;  ///< Height and depth of a step, metres; 0: a slope.
  int count = 0;                   ///< Number of steps; 0: as many as the human climbs.
  double slope = 0.0;              ///< Angle, radians.
};

/// Parses SolveOptions::terrain; nothing for an empty text. Errors: kUsage.
[[nodiscard]] Result<std::optional<TerrainShape>> terrain_from_text(const std::string& text);

/// Parses SolveOptions::terrain_scale: factors for x, y and z. Errors: kUsage.
[[nodiscard]] Result<Eigen::Vector3d> terrain_scale_from_text(const std::string& text);

/// Parses SolveOptions::object_shift, metres. Errors: kUsage.
[[nodiscard]] Result<Eigen::Vector3d> object_shift_from_text(const std::string& text);

}  // namespace retarget
