#pragma once

#include <CLI/CLI.hpp>

#include "options.h"

namespace retarget::cli {

/// Groups of the help text.
inline constexpr const char* kInput = "Input";
inline constexpr const char* kHuman = "Human (all of it is found and printed; this overrides)";
inline constexpr const char* kRobot = "Robot and method";
inline constexpr const char* kTime = "Time";
inline constexpr const char* kOutput = "Output";
inline constexpr const char* kGeneral = "General";

/// What --source-fps and --start may say; wider than any motion, narrower than any slip
inline constexpr double kSlowestRate = 0.001;
inline constexpr double kFastestRate = 1e6;
inline constexpr double kLongestTime = 1e9;

/// A check without words of its own in the help: the option's own say what it takes.
[[nodiscard]] CLI::Validator silent(CLI::Validator validator);

/// A finite number in a range, with words of its own where it is not.
[[nodiscard]] CLI::Validator number_from(double least, double most);

/// Options that several commands have.
void add_common_options(CLI::App& app, CommonOptions& options);
void add_source_options(CLI::App& app, SourceOptions& options);
void add_memory_option(CLI::App& app, SourceOptions& options);
void add_lead_in_option(CLI::App& app, RunOptions& run);
void add_human_options(CLI::App& app, HumanOptions& options);
void add_output_options(CLI::App& app, OutputOptions& options);
void add_robot_choice(CLI::App& app, RunOptions& run);
void add_reading_options(CLI::App& app, ReadingOptions& options);
/// The parts of add_reading_options: the rate, and all else.
void add_reading_rate(CLI::App& app, ReadingOptions& options);
void add_reading_layout(CLI::App& app, ReadingOptions& options);
void add_motion_options(CLI::App& app, RunOptions& run);

}  // namespace retarget::cli
