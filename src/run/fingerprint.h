#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "retarget/error.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/report.h"
#include "run/run_to_files.h"

namespace retarget {

/// All that decides, beside a clip itself, what becomes of it for one robot.
struct RunFingerprint {
  std::string hash;         ///< Changes with any of it.
  std::string description;  ///< JSON, one object: tool, options, files with their hashes, robot.
};

/// Options are taken by what they mean, so that a default that is given is none that is changed;
/// files (configuration, limits, fit options, profiles, ...) by their content, the robot by its compiled
/// model and its profile, the tool by its version.
/// @param run      its motion, robot and output do not count.
/// @param request  whether sidecars are written and motions measured counts.
[[nodiscard]] Result<RunFingerprint> run_fingerprint(const Run& run, const RunRequest& request,
                                                     const RobotSetup& setup);

/// Gates as a description tells of them, by metric.
[[nodiscard]] nlohmann::ordered_json gates_json(const Gates& gates);

}  // namespace retarget
