// Replaces ../outer_commands.cpp with RETARGET_QUICK_START, which builds only the core.

#include "outer_commands.h"

#include <string>

#include "commands.h"
#include "console.h"
#include "declare.h"

namespace retarget::cli {
namespace {

CLI::App* add_absent(CLI::App& app, const char* name) {
  CLI::App* command = app.add_subcommand(name, "(not part of this build)");
  command->allow_extras();
  return command;
}

Failure absent(const std::string& what) {
  return usage_failure("this build lacks " + what, "tools/demo.sh --all builds all commands");
}

}  // namespace

CLI::App* add_batch_command(CLI::App& app, BatchArguments& /*arguments*/) {
  return add_absent(app, "batch");
}

CLI::App* add_edit_command(CLI::App& app, EditArguments& /*arguments*/) {
  return add_absent(app, "edit");
}

CLI::App* add_live_command(CLI::App& app, LiveArguments& /*arguments*/) {
  return add_absent(app, "live");
}

CLI::App* add_robots_command(CLI::App& app, RobotsArguments& /*arguments*/) {
  return add_absent(app, "robots");
}

Result<ExitCode> batch(const BatchArguments& /*arguments*/, Console& /*console*/) {
  return absent("retarget batch");
}

Result<void> edit(const EditArguments& /*arguments*/, Console& /*console*/) {
  return absent("retarget edit");
}

Result<void> live(const LiveArguments& /*arguments*/, Console& /*console*/) {
  return absent("retarget live");
}

Result<ExitCode> robots(const RobotsArguments& /*arguments*/, Console& /*console*/) {
  return absent("retarget robots");
}

Result<void> view_gallery(const ViewArguments& /*arguments*/, Console& /*console*/) {
  return absent("galleries of batches");
}

OptionTable outer_option_table() {
  return {};
}

}  // namespace retarget::cli
