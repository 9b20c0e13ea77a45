#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "retarget/error.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/report.h"
#include "retarget/run.h"

namespace retarget {

/// Identifies everything besides the clip itself that determines the result for one robot.
struct RunFingerprint {
  std::string hash;         ///< Changes when any of it changes.
  std::string description;  ///< A JSON object: tool, options, files with their hashes, robot.
};

/// Options count by value, so giving a default explicitly changes nothing. Files (configuration,
/// limits, fit options, profiles, ...) count by content, the robot by its compiled model and its
/// profile, the tool by its version.
/// @param run      its motion, robot and output are ignored.
/// @param request  counts whether sidecars are written and motions are measured.
[[nodiscard]] Result<RunFingerprint> run_fingerprint(const Run& run, const RunRequest& request,
                                                     const RobotSetup& setup);

/// Gates by metric, in the form used in RunFingerprint::description.
[[nodiscard]] nlohmann::ordered_json gates_json(const Gates& gates);

}  // namespace retarget
