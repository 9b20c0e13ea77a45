#pragma once

#include "arguments.h"
#include "options/option_table.h"

namespace retarget::cli {

/// The rows of arguments that only the command line has; those of a run are in options/run_tables.h.
[[nodiscard]] OptionTable common_table(CommonArguments& arguments);
[[nodiscard]] OptionTable request_table(RunArguments& arguments);
[[nodiscard]] OptionTable batch_table(BatchArguments& arguments);
[[nodiscard]] OptionTable reading_table(ReadingArguments& arguments);
[[nodiscard]] OptionTable evaluate_table(EvaluateArguments& arguments);

/// All of the default command.
[[nodiscard]] OptionTable run_command_table(RunArguments& arguments);

}  // namespace retarget::cli
