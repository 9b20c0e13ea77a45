// Command line entry point: parses the options and calls a command.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "command_list.h"
#include "commands.h"
#include "console.h"
#include "declare.h"
#include "declare_table.h"
#include "generate.h"
#include "help_format.h"
#include "retarget/error.h"
#include "retarget/file.h"
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
constexpr std::array<std::pair<const char*, const char*>, 15> kExamples = {{
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
    {"view",
     "  retarget view walk.csv --robot g1 --bvh walk.bvh -o walk.html\n"
     "  retarget view walk.csv --robot g1 -o walk.svg"},
    {"edit",
     "  retarget edit trim walk.bvh --start 2 --end 5 -o part.bvh\n"
     "  retarget edit loop walk.bvh -o cycle.bvh"},
    {"robots",
     "  retarget robots list\n"
     "  retarget robots add my_robot --model my_robot.xml"},
    {"generate", "  retarget generate bash > retarget.bash\n  retarget generate man > retarget.1"},
}};

void add_help_all(CLI::App& app) {
  app.set_help_all_flag("--help-all", "Show all options")->group(kGeneralGroup);
  app.get_help_ptr()->group(kGeneralGroup);
  for (CLI::App* command : app.get_subcommands({})) add_help_all(*command);
}

// Removes the footer that commands inherit; it describes the default command.
void clear_footers(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands({})) {
    command->footer("");
    clear_footers(*command);
  }
}

void add_help(CLI::App& app) {
  add_help_all(app);
  clear_footers(app);
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
    std::ostringstream text;
    app.exit(success, text, text);
    const auto written = write_file("-", text.str());
    return written ? kDone : console.fail(written.error());
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

int main_with(const std::vector<std::string>& given) {
  CLI::App app("Human motion capture to joint trajectories of humanoid robots.", "retarget");
  // On Windows, CLI11 would take /names for options.
  app.allow_windows_style_options(false);
  app.footer(kFooter);
  app.formatter(std::make_shared<HelpFormat>());
  app.set_version_flag("--version", [] { return version_text(); })->group(kGeneralGroup);

  Commands commands;
  commands.add(app, &add_run_command, &run);
  commands.add(app, &add_batch_command, &batch);
  commands.add(app, &add_inspect_command, &inspect);
  commands.add(app, &add_contacts_command, &contacts);
  commands.add(app, &add_scene_from_motion_command, &find_scene);
  commands.add(app, &add_edit_command, &edit);
  commands.add(app, &add_evaluate_command, &evaluate);
  commands.add(app, &add_convert_command, &convert);
  commands.add(app, &add_compare_command, &compare);
  commands.add(app, &add_certify_command, &certify);
  commands.add(app, &add_simulate_command, &simulate);
  commands.add(app, &add_verify_command, &verify);
  commands.add(app, &add_view_command, &view);
  commands.add(app, &add_live_command, &live);
  commands.add(app, &add_robots_command, &robots);

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
