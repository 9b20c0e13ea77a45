// Replaces ../outer_commands.cpp with RETARGET_QUICK_START, which builds only the core.

#include "outer_commands.h"

#include <string>

#include "commands.h"
#include "console.h"

namespace retarget::cli {
namespace {

// Arguments of a command that only reports its absence.
struct AbsentArguments {
  CommonArguments common;
  std::string name;
};

template <char const* const& kName>
CLI::App* add_absent(CLI::App& app, AbsentArguments& arguments) {
  arguments.name = kName;
  CLI::App* command = app.add_subcommand(kName, "(not part of this build)");
  command->allow_extras();
  return command;
}

Failure absent(const std::string& what) {
  return usage_failure("this build lacks " + what, "tools/demo.sh --all builds all commands");
}

Result<void> report_absent(const AbsentArguments& arguments, Console& /*console*/) {
  return absent("retarget " + arguments.name);
}

constexpr const char* kBatch = "batch";
constexpr const char* kEdit = "edit";
constexpr const char* kLive = "live";
constexpr const char* kRobots = "robots";

}  // namespace

void add_batch(CLI::App& app, Commands& commands) {
  commands.add(app, &add_absent<kBatch>, &report_absent);
}

void add_edit(CLI::App& app, Commands& commands) {
  commands.add(app, &add_absent<kEdit>, &report_absent);
}

void add_live(CLI::App& app, Commands& commands) {
  commands.add(app, &add_absent<kLive>, &report_absent);
}

void add_robots(CLI::App& app, Commands& commands) {
  commands.add(app, &add_absent<kRobots>, &report_absent);
}

Result<void> view_gallery(const ViewArguments& /*arguments*/, Console& /*console*/) {
  return absent("galleries of batches");
}

OptionTable outer_option_table() {
  return {};
}

}  // namespace retarget::cli
