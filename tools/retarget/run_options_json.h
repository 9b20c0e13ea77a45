#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "options.h"
#include "retarget/error.h"

namespace retarget::cli {

/// A text of bytes that need not be UTF-8, such as a file's name: what is none of it is replaced, and
/// KEY_hex beside has all bytes.
void put_name(nlohmann::ordered_json& json, const std::string& key, const std::string& bytes);

/// What put_name put there; empty where there is nothing.
[[nodiscard]] std::string name_from(const nlohmann::ordered_json& json, const std::string& key);

/// Every option of a run that decides what its outputs are, by the name that the command line has
/// for it, also where it was not given.
[[nodiscard]] nlohmann::ordered_json run_options_json(const RunOptions& options);

/// The options of run_options_json; what is not there keeps its default.
/// Errors (kInput): unknown names, values of another kind or that the command line would not take.
[[nodiscard]] Result<RunOptions> run_options_from_json(const nlohmann::ordered_json& json,
                                                       const std::string& file);

}  // namespace retarget::cli
