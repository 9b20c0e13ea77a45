#include "argument_tables.h"
#include "arguments.h"
#include "declare.h"
#include "declare_table.h"

namespace retarget::cli {

CLI::App* add_live_command(CLI::App& app, LiveArguments& arguments) {
  CLI::App* command = app.add_subcommand("live", "Retarget a stream in real time (docs/live.md)");
  declare(*command, live_command_table(arguments));
  return command;
}

}  // namespace retarget::cli
