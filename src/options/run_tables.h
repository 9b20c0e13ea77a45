#pragma once

#include <optional>
#include <string>

#include "options/option_table.h"
#include "retarget/error.h"
#include "retarget/options.h"

namespace retarget {

/// Groups of options in help and docs.
inline constexpr const char* kInputGroup = "Input";
inline constexpr const char* kMotionFileGroup =
    "Motion files (detected and printed; these options override it)";
inline constexpr const char* kHumanGroup =
    "Human (detected and printed; these options override it)";
inline constexpr const char* kRobotGroup = "Robot and method";
inline constexpr const char* kTimeGroup = "Time";
inline constexpr const char* kOutputGroup = "Output";
inline constexpr const char* kGeneralGroup = "General";

/// Rows that several commands have.
[[nodiscard]] Option memory_row(double& memory_gb);
[[nodiscard]] Option output_row(std::string& output);

/// Rows of how a robot's motion is read, of the commands that are about such and of runs from one
/// robot to another.
/// @param decides  whether the bytes of what is made depend on them.
[[nodiscard]] OptionTable motion_file_table(MotionFileOptions& options, bool decides);

/// The rows of each struct of options; they are bound to the struct, which must outlive them.
[[nodiscard]] OptionTable source_table(SourceOptions& options);
[[nodiscard]] OptionTable human_table(HumanOptions& options);
[[nodiscard]] OptionTable part_table(PartOptions& options);
[[nodiscard]] OptionTable robot_table(RobotChoice& options);
[[nodiscard]] OptionTable solve_table(SolveOptions& options);
[[nodiscard]] OptionTable time_table(TimeOptions& options);
[[nodiscard]] OptionTable save_table(SaveOptions& options);
/// All of a run, in the order in which a sidecar has them.
[[nodiscard]] OptionTable run_table(Run& run);

/// The rate that a text means; of `source` nothing.
[[nodiscard]] Result<std::optional<double>> rate_from_text(const std::string& text);

/// Metres that a unit's name or number means; nothing for an empty text.
[[nodiscard]] Result<std::optional<double>> unit_from_text(const std::string& text);

}  // namespace retarget
