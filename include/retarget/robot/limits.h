#pragma once

#include <memory>
#include <string>
#include <vector>

#include "retarget/base/result.h"

namespace retarget {

class Robot;

/// Ranges of a robot's joints under one name.
struct LimitSet {
  std::string name;           ///< `official`, `gmr`, `model`, or the file it came from.
  std::string source;         ///< Where the figures come from, for people; may be empty.
  std::vector<double> lower;  ///< By joint in the robot's joint order, rad or m; -infinity: none.
  std::vector<double> upper;  ///< As lower; +infinity: none. lower <= upper.
};

/// A limit set of the robot by name, or from a file: JSON `{"joint": [lower, upper], ...}` or an
/// MJCF whose joint ranges count (by its extension .xml; with or without a free joint). Joints that
/// a file does not name keep the model's ranges; joints of an MJCF that the robot lacks are passed
/// over, in JSON they are faults. Joints
/// that the robot's variant holds have their one position as range. An unknown name lists the
/// robot's sets; all faults of a file are named at once (kConfig).
[[nodiscard]] Result<LimitSet> load_limits(const Robot& robot, const std::string& name_or_file);

}  // namespace retarget
