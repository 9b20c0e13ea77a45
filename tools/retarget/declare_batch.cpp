#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <system_error>

#include "declare.h"
#include "declare_shared.h"

namespace retarget::cli {
namespace {

constexpr const char* kBatch = "Batch";

// options of a run that name what a batch has many of
constexpr std::array kOfOneClip = {"--bvh",    "--smpl",   "--write-map", "--robot",
                                   "--output", "--report", "--memory",    "--verbose"};

// options that decide which clips are done where and when, not what becomes of one
constexpr std::array<std::string_view, 16> kOfTheBatchAlone = {
    "clip-timeout", "inputs", "list", "base",  "exclude", "robot", "output",   "jobs",
    "memory",       "resume", "redo", "shard", "merge",   "quiet", "data-dir", "help"};

void add_inputs(CLI::App& command, BatchOptions& options) {
  command
      .add_option("inputs", options.inputs,
                  "Files, folders (searched with all below), patterns, or\n@LIST for a file of "
                  "names; with --merge, further manifests")
      ->type_name("IN...");
  command
      .add_option("--list", options.lists,
                  "File of names of files and folders, one a line;\n- reads standard input")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->group(kInput);
  command
      .add_option("--base", options.base,
                  "Files that are named one by one keep their tree below\nthis folder "
                  "(default: their names alone)")
      ->type_name("DIR")
      ->group(kInput);
  command
      .add_option("--exclude", options.exclude,
                  "Leave out files whose name, or path below its folder,\nmatches; repeatable")
      ->type_name("PATTERN")
      ->allow_extra_args(false)
      ->group(kInput);
}

void add_course(CLI::App& command, BatchOptions& options) {
  command
      .add_option("-j,--jobs", options.jobs, "Clips at a time (default: one for each processor)")
      ->type_name("N")
      ->check(silent(CLI::Range(1, 4096)))
      ->group(kBatch);
  command
      .add_option("--memory", options.run.source.memory_gb,
                  "Begin no clip that would need more than this together\nwith those that run, GB, "
                  "and let none take more (default:\nthree quarters of what there is)")
      ->type_name("GB")
      ->check(number_from(0.001, 1e6))
      ->group(kBatch);
  command
      .add_option("--clip-timeout", options.clip_timeout_s,
                  "A clip that takes longer has failed, and the others go\non (default: none does)")
      ->type_name("SECONDS")
      ->check(number_from(0.001, 1e9))
      ->group(kBatch);
  command
      .add_flag("--resume", options.resume,
                "Go on with a batch: skip clips that are done and have\nnot changed")
      ->group(kBatch);
  command.add_flag("--redo", options.redo, "Forget an earlier batch in the folder, do all again")
      ->group(kBatch);
  command
      .add_option("--shard", options.shard,
                  "Do one of N parts of about the same length, I from 1\nto N, with a manifest of "
                  "its own")
      ->type_name("I/N")
      ->group(kBatch);
  command
      .add_flag("--merge", options.merge,
                "Join the manifests of all parts in the output folder,\nand write the summary")
      ->group(kBatch);
  command
      .add_flag("--no-quality", options.no_quality,
                "Do not measure the motions: faster, but the summary\nknows failures alone")
      ->group(kBatch);
}

// options whose text is a number
constexpr std::array<std::string_view, 9> kOfNumbers = {
    "end", "fps", "height", "npz-fps", "precision", "source-fps", "start", "tpose-frame", "window"};

// the same text for the same value: 30 for 30.0, false for a flag that was not given
std::string canonical(const CLI::Option& option, const std::string& value) {
  const bool is_flag = option.get_items_expected_max() == 0;
  if (is_flag && value.empty()) return "false";
  const std::string& name = option.get_single_name();
  if (std::ranges::find(kOfNumbers, name) == kOfNumbers.end()) return value;
  double number = 0.0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (error != std::errc() || end != value.data() + value.size()) return value;
  std::array<char, 32> text;
  const auto written = std::to_chars(text.data(), text.data() + text.size(), number);
  return {text.data(), written.ptr};
}

// takes down what was given, and the defaults of the rest
void note_deciding_options(const CLI::App& command, BatchOptions& options) {
  options.deciding.clear();
  for (const CLI::Option* option : command.get_options()) {
    const std::string& name = option->get_single_name();
    if (std::ranges::find(kOfTheBatchAlone, name) != kOfTheBatchAlone.end()) continue;
    std::vector<std::string> values = option->results();
    if (option->count() == 0) values = {option->get_default_str()};
    for (std::string& value : values) value = canonical(*option, value);
    options.deciding.emplace_back(name, std::move(values));
  }
  std::ranges::sort(options.deciding);
}

}  // namespace

CLI::App* add_batch_command(CLI::App& app, BatchOptions& options) {
  CLI::App* command = app.add_subcommand(
      "batch", "Retarget folders of clips, all processors, resumable (docs/batch.md)");
  add_run_options(*command, options.run);
  for (const char* name : kOfOneClip) command->remove_option(command->get_option(name));
  add_inputs(*command, options);
  command
      ->add_option("--robot", options.robots,
                   "Robots by name or folder; each of several gets a\nfolder of its own")
      ->type_name("NAME,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group(kRobot);
  command->add_option("-o,--output", options.output, "Folder to write; made where it is not there")
      ->type_name("DIR")
      ->required()
      ->group(kOutput);
  add_course(*command, options);
  command->parse_complete_callback(
      [command, &options] { note_deciding_options(*command, options); });
  return command;
}

}  // namespace retarget::cli
