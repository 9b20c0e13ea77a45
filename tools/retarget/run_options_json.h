#pragma once

#include <nlohmann/json.hpp>

#include "options.h"
#include "retarget/base/result.h"

namespace retarget::cli {

/// Every option of a run that decides what its outputs are, by the name that the command line has
/// for it, also where it was not given.
[[nodiscard]] nlohmann::ordered_json run_options_json(const RunOptions& options);

/// The options of run_options_json; what is not there keeps its default.
/// Errors (kInput): unknown names, values of another kind.
[[nodiscard]] Result<RunOptions> run_options_from_json(const nlohmann::ordered_json& json,
                                                       const std::string& file);

}  // namespace retarget::cli
