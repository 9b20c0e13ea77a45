// Command line entry point: parses the options and calls a command.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "declare.h"
#include "declare_table.h"
#include "edit_arguments.h"
#include "generate.h"
#include "help_format.h"
#include "retarget/error.h"
#include "retarget/option_table.h"
#include "retarget/version.h"
#include "usage_errors.h"

namespace retarget::cli {
namespace {

constexpr const char* kFooter = R"(
Exit codes: 0 done, 1 the run failed, 2 wrong usage, 3 bad input file,
4 bad configuration, model or unknown robot, 130 interrupted.

Examples:
  retarget walk.bvh g1 -o walk.csv
  retarget walk.bvh g1 --start 2 --end 5 --fps 50 -o - --format csv)";

// Example calls by command.
constexpr std::array<std::pair<const char*, const char*>, 12> kExamples = {{
    {"certify", "  retarget certify walk.csv --robot g1 --bvh walk.bvh"},
    {"simulate",
     "  retarget simulate walk.csv --robot g1 -o simulated.csv\n"
     "  retarget view walk.csv simulated.csv --robot g1 -o both.html"},
    {"batch",
     "  retarget batch clips/ -o out/ --robot g1\n"
     "  retarget batch clips/ -o out/ --robot g1,t1 --resume"},
    {"inspect", "  retarget inspect walk.bvh\n  retarget inspect walk.bvh --json"},
    {"contacts",
     "  retarget contacts carry.bvh --robot g1 --scene box.json --object-track box.csv"},
    {"scene-from-motion", "  retarget scene-from-motion climb.bvh -o boxes.json"},
    {"evaluate",
     "  retarget evaluate walk.csv --robot g1 --bvh walk.bvh\n"
     "  retarget evaluate a.csv b.csv --robot g1 --json report.json"},
    {"convert",
     "  retarget convert walk.pkl walk.csv --robot g1\n"
     "  retarget convert walk.csv walk.npz --robot g1 --format npz-mjlab"},
    {"compare", "  retarget compare golden.csv walk.csv --tolerance 1e-6"},
    {"verify", "  retarget verify walk.csv.json"},
    {"live",
     "  retarget live --robot g1 --input udp:1118?format=bvh --skeleton walk.bvh\n"
     "  retarget live --play walk.bvh --to udp:1118?format=bvh"},
    {"view", "  retarget view walk.csv --robot g1 --bvh walk.bvh -o walk.svg"},
}};

void add_help_all(CLI::App& app) {
  app.set_help_all_flag("--help-all", "Show all options")->group(kGeneralGroup);
  app.get_help_ptr()->group(kGeneralGroup);
  for (CLI::App* command : app.get_subcommands({})) add_help_all(*command);
}

void add_help(CLI::App& app) {
  add_help_all(app);
  for (const auto& [name, examples] : kExamples) {
    app.get_subcommand(name)->footer(std::string("Examples:\n") + examples);
  }
}

// Parses the command line; returns nothing if a command should run.
std::optional<ExitCode> parse_words(CLI::App& app, const std::vector<std::string>& given) {
  Console console(false);
  std::vector<std::string> words = without_help_command(given);
  if (auto command = check_command(app, words, words != given); !command) {
    return console.fail(command.error());
  }
  // CLI11 expects the arguments in reverse order.
  std::ranges::reverse(words);
  try {
    app.parse(std::move(words));
  } catch (const CLI::Success& success) {
    // Help and version go to standard output.
    return app.exit(success) == 0 ? kDone : kRunFailed;
  } catch (const CLI::ExtrasError&) {
    return console.fail(unknown_words(app).value());
  } catch (const CLI::RequiredError& error) {
    auto needs = check_given(app);
    return console.fail(needs ? wrong_words(app, error).value() : needs.error());
  } catch (const CLI::ParseError& error) {
    return console.fail(wrong_words(app, error).value());
  }
  if (auto given_all = check_given(app); !given_all) return console.fail(given_all.error());
  return std::nullopt;
}

// The commands, each with the function to call after parsing.
class Commands {
 public:
  template <typename Arguments, typename Value>
  void add(const CLI::App* command, const Arguments& arguments, const CommonArguments& common,
           Result<Value> (*command_call)(const Arguments&, Console&)) {
    calls_.emplace_back(command, [&arguments, &common, command_call] {
      Console console(common.quiet);
      const Result<Value> done = command_call(arguments, console);
      if (!done) return console.fail(done.error());
      if constexpr (std::is_void_v<Value>) {
        return kDone;
      } else {
        return *done;
      }
    });
  }
  // Calls the first command that was parsed; the default command is last.
  [[nodiscard]] ExitCode call() const {
    const auto parsed =
        std::ranges::find_if(calls_, [](const auto& each) { return each.first->parsed(); });
    return parsed->second();
  }

 private:
  std::vector<std::pair<const CLI::App*, std::function<ExitCode()>>> calls_;
};

int main_with(const std::vector<std::string>& given) {
  CLI::App app("Human motion capture to joint trajectories of humanoid robots.", "retarget");
  // On Windows, CLI11 would take /names for options.
  app.allow_windows_style_options(false);
  app.footer(kFooter);
  app.formatter(std::make_shared<HelpFormat>());
  app.set_version_flag("--version", [] { return version_text(); })->group(kGeneralGroup);

  RunArguments run_of;
  add_run_options(app, run_of);
  add_run_words(app, run_of);
  Commands commands;
  BatchArguments batch_of;
  commands.add(add_batch_command(app, batch_of), batch_of, batch_of.run.common, batch);
  InspectArguments inspect_of;
  commands.add(add_inspect_command(app, inspect_of), inspect_of, inspect_of.run.common, inspect);
  ContactsArguments contacts_of;
  commands.add(add_contacts_command(app, contacts_of), contacts_of, contacts_of.run.common,
               contacts);
  SceneFromMotionArguments scene_of;
  commands.add(add_scene_from_motion_command(app, scene_of), scene_of, scene_of.run.common,
               find_scene);
  EditArguments edit_of;
  commands.add(add_edit_command(app, edit_of), edit_of, edit_of.common, edit);
  EvaluateArguments evaluate_of;
  commands.add(add_evaluate_command(app, evaluate_of), evaluate_of, evaluate_of.run.common,
               evaluate);
  ConvertArguments convert_of;
  commands.add(add_convert_command(app, convert_of), convert_of, convert_of.common, convert);
  CompareArguments compare_of;
  commands.add(add_compare_command(app, compare_of), compare_of, compare_of.common, compare);
  CertifyArguments certify_of;
  commands.add(add_certify_command(app, certify_of), certify_of, certify_of.run.common, certify);
  SimulateArguments simulate_of;
  commands.add(add_simulate_command(app, simulate_of), simulate_of, simulate_of.common, simulate);
  VerifyArguments verify_of;
  commands.add(add_verify_command(app, verify_of), verify_of, verify_of.common, verify);
  ViewArguments view_of;
  commands.add(add_view_command(app, view_of), view_of, view_of.run.common, view);
  LiveArguments live_of;
  commands.add(add_live_command(app, live_of), live_of, live_of.common, live);
  RobotsArguments robots_of;
  commands.add(add_robots_command(app, robots_of), robots_of, robots_of.common, robots);
  commands.add(&app, run_of, run_of.common, run);

  app.add_subcommand("help", "Help for a command: retarget help edit path");
  Generated generated;
  const CLI::App* generate = add_generate_command(app, generated);
  add_help(app);
  refuse_empty_values(app);
  if (const auto ended = parse_words(app, given)) return *ended;
  turn_write_signals_into_errors();
  return generate->parsed() ? print_generated(app, generated) : commands.call();
}

}  // namespace
}  // namespace retarget::cli

int main(int argc, char** argv) {
  // The library returns its errors; exceptions remain for exhausted memory.
  try {
    std::vector<std::string> words = retarget::cli::words_of_program(argc, argv);
    if (!words.empty()) words.erase(words.begin());
    return retarget::cli::main_with(words);
  } catch (const std::bad_alloc&) {
    std::fputs("error: not enough memory\n", stderr);
    return retarget::cli::kRunFailed;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return retarget::cli::kRunFailed;
  }
}
