#pragma once

#include <CLI/CLI.hpp>

#include "arguments.h"
#include "edit_options.h"
#include "options.h"
#include "view_options.h"

namespace retarget::cli {

/// Declares the options of the default command.
void add_run_options(CLI::App& app, RunArguments& arguments);

/// Declares the words of the default command that are no options: a motion file and a robot.
void add_run_words(CLI::App& app, RunArguments& arguments);

/// Declare the other commands with their options.
CLI::App* add_batch_command(CLI::App& app, BatchArguments& arguments);
CLI::App* add_inspect_command(CLI::App& app, InspectOptions& options);
CLI::App* add_edit_command(CLI::App& app, EditOptions& options);
CLI::App* add_evaluate_command(CLI::App& app, EvaluateArguments& arguments);
CLI::App* add_convert_command(CLI::App& app, ConvertOptions& options);
CLI::App* add_compare_command(CLI::App& app, CompareOptions& options);
CLI::App* add_verify_command(CLI::App& app, VerifyArguments& arguments);
CLI::App* add_view_command(CLI::App& app, ViewOptions& options);
CLI::App* add_robots_command(CLI::App& app, RobotsOptions& options);

}  // namespace retarget::cli
