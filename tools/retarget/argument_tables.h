#pragma once

#include <set>
#include <string>

#include "arguments.h"
#include "options/option_table.h"

namespace retarget::cli {

/// The rows of arguments that only the command line has; those of a run are in options/run_tables.h.
[[nodiscard]] OptionTable common_table(CommonArguments& arguments);
[[nodiscard]] OptionTable request_table(RunArguments& arguments);
[[nodiscard]] OptionTable batch_table(BatchArguments& arguments);
[[nodiscard]] OptionTable evaluate_table(EvaluateArguments& arguments);

[[nodiscard]] Option write_map_row(std::string& file);
[[nodiscard]] OptionTable convert_table(ConvertArguments& arguments);
[[nodiscard]] OptionTable compare_table(CompareArguments& arguments);
[[nodiscard]] OptionTable inspect_table(InspectArguments& arguments);
[[nodiscard]] OptionTable view_table(ViewArguments& arguments);
/// All of a live run that a recording keeps; and what else there is.
[[nodiscard]] OptionTable live_run_table(LiveArguments& arguments);
[[nodiscard]] OptionTable live_command_table(LiveArguments& arguments);

/// Names of the options that a command's short help leaves out; of a command's parts (`edit trim`)
/// those that are the same for all.
[[nodiscard]] std::set<std::string> advanced_option_names();
[[nodiscard]] std::set<std::string> shared_option_names();

/// All of the default command.
[[nodiscard]] OptionTable run_command_table(RunArguments& arguments);

}  // namespace retarget::cli
