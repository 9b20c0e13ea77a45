#pragma once

#include <set>
#include <string>

#include "arguments.h"
#include "retarget/option_table.h"

namespace retarget::cli {

/// Returns the option tables of arguments that only the command line has; options/run_tables.h has
/// those of a run.
[[nodiscard]] OptionTable common_table(CommonArguments& arguments);
[[nodiscard]] OptionTable request_table(RunArguments& arguments);
[[nodiscard]] OptionTable evaluate_table(EvaluateArguments& arguments);

[[nodiscard]] Option write_map_row(std::string& file);
[[nodiscard]] OptionTable convert_table(ConvertArguments& arguments);
[[nodiscard]] OptionTable certify_table(CertifyArguments& arguments);
[[nodiscard]] OptionTable simulate_table(SimulateArguments& arguments);
[[nodiscard]] OptionTable compare_table(CompareArguments& arguments);
[[nodiscard]] OptionTable inspect_table(InspectArguments& arguments);
[[nodiscard]] OptionTable contacts_table(ContactsArguments& arguments);
[[nodiscard]] OptionTable scene_from_motion_table(SceneFromMotionArguments& arguments);
[[nodiscard]] OptionTable view_table(ViewArguments& arguments);

/// Returns the names of the options that a command's short help leaves out. For subcommands (`edit
/// trim`), shared_option_names are the options that all of them share.
[[nodiscard]] std::set<std::string> advanced_option_names();
[[nodiscard]] std::set<std::string> shared_option_names();

/// Returns all options of the default command.
[[nodiscard]] OptionTable run_command_table(RunArguments& arguments);

}  // namespace retarget::cli
