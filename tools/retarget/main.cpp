// The command line: reads the options, calls a command.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "argument_tables.h"
#include "commands.h"
#include "declare.h"
#include "declare_table.h"
#include "generate.h"
#include "help_format.h"
#include "interrupt.h"
#include "options/run_tables.h"
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

// what calls of a command look like
constexpr std::array<std::pair<const char*, const char*>, 7> kExamples = {{
    {"batch",
     "  retarget batch clips/ -o out/ --robot g1\n"
     "  retarget batch clips/ -o out/ --robot g1,t1 --resume"},
    {"inspect", "  retarget inspect walk.bvh\n  retarget inspect walk.bvh --json"},
    {"evaluate",
     "  retarget evaluate walk.csv --robot g1 --bvh walk.bvh\n"
     "  retarget evaluate a.csv b.csv --robot g1 --json report.json"},
    {"convert",
     "  retarget convert walk.pkl walk.csv --robot g1\n"
     "  retarget convert walk.csv walk.npz --robot g1 --format npz-mjlab"},
    {"compare", "  retarget compare golden.csv walk.csv --tolerance 1e-6"},
    {"verify", "  retarget verify walk.csv.json"},
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

// reads the words into the options; nothing: go on with the command
std::optional<ExitCode> parse_words(CLI::App& app, int argc, char** argv) {
  Console console(false);
  const std::vector<std::string> given(argv + 1, argv + argc);
  std::vector<std::string> words = without_help_command(given);
  if (auto command = check_command(app, words, words != given); !command) {
    return console.fail(command.error());
  }
  // from the last to the first, as the parser takes them off
  std::ranges::reverse(words);
  try {
    app.parse(std::move(words));
  } catch (const CLI::Success& success) {
    // help and version, on standard output
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

int main_with(int argc, char** argv) {
  CLI::App app("Human motion capture to joint trajectories of humanoid robots.", "retarget");
  app.footer(kFooter);
  app.formatter(std::make_shared<HelpFormat>(advanced_option_names(), shared_option_names()));
  app.get_help_ptr()->group(kGeneralGroup);
  app.set_version_flag("--version", [] { return version_text(); })->group(kGeneralGroup);

  RunArguments run_arguments;
  add_run_options(app, run_arguments);
  add_run_words(app, run_arguments);
  BatchArguments batch_arguments;
  const CLI::App* batch_command = add_batch_command(app, batch_arguments);
  InspectArguments inspect_arguments;
  const CLI::App* inspect_command = add_inspect_command(app, inspect_arguments);
  EditArguments edit_arguments;
  const CLI::App* edit_command = add_edit_command(app, edit_arguments);
  EvaluateArguments evaluate_arguments;
  const CLI::App* evaluate_command = add_evaluate_command(app, evaluate_arguments);
  ConvertArguments convert_arguments;
  const CLI::App* convert_command = add_convert_command(app, convert_arguments);
  CompareArguments compare_arguments;
  const CLI::App* compare_command = add_compare_command(app, compare_arguments);
  VerifyArguments verify_arguments;
  const CLI::App* verify_command = add_verify_command(app, verify_arguments);
  ViewArguments view_arguments;
  const CLI::App* view_command = add_view_command(app, view_arguments);
  RobotsArguments robots_arguments;
  const CLI::App* robots_command = add_robots_command(app, robots_arguments);

  app.add_subcommand("help", "The help of a command: retarget help edit path");

  add_help(app);
  CLI::App* generate = add_generate_command(app);
  refuse_empty_values(app);
  if (const auto ended = parse_words(app, argc, argv)) return *ended;
  turn_write_signals_into_errors();
  if (generate->parsed()) return print_generated(app, *generate);
  if (batch_command->parsed()) {
    Console console(batch_arguments.run.common.quiet);
    return batch(batch_arguments, console);
  }
  if (inspect_command->parsed()) {
    Console console(inspect_arguments.run.common.quiet);
    return inspect(inspect_arguments, console);
  }
  if (edit_command->parsed()) {
    Console console(edit_arguments.common.quiet);
    return edit(edit_arguments, console);
  }
  if (evaluate_command->parsed()) {
    Console console(evaluate_arguments.run.common.quiet);
    return evaluate(evaluate_arguments, console);
  }
  if (convert_command->parsed()) {
    Console console(convert_arguments.common.quiet);
    return convert(convert_arguments, console);
  }
  if (compare_command->parsed()) {
    Console console(compare_arguments.common.quiet);
    return compare(compare_arguments, console);
  }
  if (verify_command->parsed()) {
    Console console(verify_arguments.common.quiet);
    return verify(verify_arguments, console);
  }
  if (view_command->parsed()) {
    Console console(view_arguments.run.common.quiet);
    return view(view_arguments, console);
  }
  if (robots_command->parsed()) {
    Console console(robots_arguments.common.quiet);
    return robots(robots_arguments, console);
  }
  Console console(run_arguments.common.quiet);
  return run(run_arguments, console);
}

}  // namespace
}  // namespace retarget::cli

int main(int argc, char** argv) {
  // the library returns its errors; what is thrown nevertheless is memory that ran out
  try {
    return retarget::cli::main_with(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fputs("error: there is not enough memory\n", stderr);
    return retarget::cli::kRunFailed;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return retarget::cli::kRunFailed;
  }
}
