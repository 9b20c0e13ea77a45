#pragma once

#include <CLI/CLI.hpp>

#include "command_list.h"
#include "retarget/option_table.h"

namespace retarget::cli {

/// Adds the commands `batch`, `edit`, `live` and `robots`. With RETARGET_QUICK_START, these
/// commands only report how to build them (quick_start/outer_commands.cpp).
void add_batch(CLI::App& app, Commands& commands);
void add_edit(CLI::App& app, Commands& commands);
void add_live(CLI::App& app, Commands& commands);
void add_robots(CLI::App& app, Commands& commands);

/// Returns the options of batch and live. Its rows refer to arguments that no longer exist; use only
/// their names and descriptions.
[[nodiscard]] OptionTable outer_option_table();

}  // namespace retarget::cli
