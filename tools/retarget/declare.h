#pragma once

#include <CLI/CLI.hpp>

#include "arguments.h"
#include "edit_arguments.h"

namespace retarget::cli {

/// Declares the options of the default command and its positional arguments, a motion file and a
/// robot; returns `app`.
CLI::App* add_run_command(CLI::App& app, RunArguments& arguments);

/// Declares each of the other commands with its options.
CLI::App* add_contacts_command(CLI::App& app, ContactsArguments& arguments);
CLI::App* add_scene_from_motion_command(CLI::App& app, SceneFromMotionArguments& arguments);
CLI::App* add_inspect_command(CLI::App& app, InspectArguments& arguments);
CLI::App* add_evaluate_command(CLI::App& app, EvaluateArguments& arguments);
CLI::App* add_convert_command(CLI::App& app, ConvertArguments& arguments);
CLI::App* add_compare_command(CLI::App& app, CompareArguments& arguments);
CLI::App* add_certify_command(CLI::App& app, CertifyArguments& arguments);
CLI::App* add_simulate_command(CLI::App& app, SimulateArguments& arguments);
CLI::App* add_verify_command(CLI::App& app, VerifyArguments& arguments);
CLI::App* add_view_command(CLI::App& app, ViewArguments& arguments);

/// The same for commands of outer modules. With RETARGET_QUICK_START, these commands only report
/// how to build them (quick_start/outer_commands.cpp).
CLI::App* add_batch_command(CLI::App& app, BatchArguments& arguments);
CLI::App* add_edit_command(CLI::App& app, EditArguments& arguments);
CLI::App* add_live_command(CLI::App& app, LiveArguments& arguments);
CLI::App* add_robots_command(CLI::App& app, RobotsArguments& arguments);

}  // namespace retarget::cli
