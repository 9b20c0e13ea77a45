// The command line: reads the options, calls a command.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "commands.h"
#include "declare.h"
#include "declare_shared.h"
#include "interrupt.h"
#include "retarget/base/suggest.h"
#include "retarget/version.h"

namespace retarget::cli {
namespace {

constexpr const char* kFooter = R"(
Exit codes: 0 done, 1 the run failed, 2 wrong usage, 3 bad input file,
4 bad configuration, model or unknown robot, 130 interrupted.

Examples:
  retarget --bvh walk.bvh --robot unitree_g1 -o walk.csv
  retarget --bvh walk.bvh --robot unitree_g1 --fps source --precision 9 -o -
  retarget batch clips/ -o out/ --robot unitree_g1
  retarget inspect walk.bvh
  retarget evaluate walk.csv --robot unitree_g1 --bvh walk.bvh)";

// names what the command line holds beyond its options, with the option that may be meant
Failure unknown_words(const CLI::App& app) {
  std::vector<std::string> known;
  // the command that was given: `retarget edit path` has its own options alone
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  for (const CLI::Option* option : command->get_options()) known.push_back(option->get_name());
  for (const std::string& word : app.remaining(true)) {
    if (word.starts_with('-')) {
      return usage_failure("unknown option " + word + did_you_mean(word, known),
                           "retarget --help lists the options");
    }
  }
  const std::vector<std::string> words = app.remaining(true);
  return usage_failure("unexpected " + list_names(words), "a motion file goes with --bvh FILE");
}

int main_with(int argc, char** argv) {
  CLI::App app("Human motion capture to joint trajectories of humanoid robots.", "retarget");
  app.footer(kFooter);
  app.get_formatter()->column_width(32);
  app.get_help_ptr()->group(kGeneral);
  app.set_version_flag("--version", [] { return version_text(); })->group(kGeneral);

  RunOptions run_options;
  add_run_options(app, run_options);
  BatchOptions batch_options;
  const CLI::App* batch_command = add_batch_command(app, batch_options);
  InspectOptions inspect_options;
  const CLI::App* inspect_command = add_inspect_command(app, inspect_options);
  EditOptions edit_options;
  const CLI::App* edit_command = add_edit_command(app, edit_options);
  EvaluateOptions evaluate_options;
  const CLI::App* evaluate_command = add_evaluate_command(app, evaluate_options);
  ConvertOptions convert_options;
  const CLI::App* convert_command = add_convert_command(app, convert_options);
  CompareOptions compare_options;
  const CLI::App* compare_command = add_compare_command(app, compare_options);
  VerifyOptions verify_options;
  const CLI::App* verify_command = add_verify_command(app, verify_options);
  RobotsOptions robots_options;
  const CLI::App* robots_command = add_robots_command(app, robots_options);

  refuse_empty_values(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    // help and version, on standard output
    return app.exit(success) == 0 ? kDone : kRunFailed;
  } catch (const CLI::ExtrasError&) {
    return Console(false).fail(unknown_words(app).value());
  } catch (const CLI::ParseError& error) {
    return Console(false).fail(
        usage_failure(error.what(), "retarget --help lists the options").value());
  }
  turn_write_signals_into_errors();
  if (batch_command->parsed()) {
    Console console(batch_options.run.common.quiet);
    return batch(batch_options, console);
  }
  if (inspect_command->parsed()) {
    Console console(inspect_options.common.quiet);
    return inspect(inspect_options, console);
  }
  if (edit_command->parsed()) {
    Console console(edit_options.common.quiet);
    return edit(edit_options, console);
  }
  if (evaluate_command->parsed()) {
    Console console(evaluate_options.run.common.quiet);
    return evaluate(evaluate_options, console);
  }
  if (convert_command->parsed()) {
    Console console(convert_options.run.common.quiet);
    return convert(convert_options, console);
  }
  if (compare_command->parsed()) {
    Console console(compare_options.run.common.quiet);
    return compare(compare_options, console);
  }
  if (verify_command->parsed()) {
    Console console(verify_options.common.quiet);
    return verify(verify_options, console);
  }
  if (robots_command->parsed()) {
    Console console(robots_options.common.quiet);
    return robots(robots_options, console);
  }
  Console console(run_options.common.quiet);
  return run(run_options, console);
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
