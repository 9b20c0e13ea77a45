#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "retarget/error.h"

namespace retarget::cli {

/// Whether the command line of a run would take these options: their ranges and words.
/// @param options   as of run_options_json.
/// @param defaults  the same without any option; what is as there is not looked at.
/// Errors (kInput): those of the command line.
[[nodiscard]] Result<void> check_as_command_line(const nlohmann::ordered_json& options,
                                                 const nlohmann::ordered_json& defaults,
                                                 const std::string& file);

}  // namespace retarget::cli
