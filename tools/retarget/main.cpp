// The command line: declares the options, checks them against each other, calls a command.

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "commands.h"
#include "interrupt.h"
#include "retarget/base/suggest.h"
#include "retarget/version.h"

namespace retarget::cli {
namespace {

constexpr const char* kInput = "Input";
constexpr const char* kHuman = "Human (all of it is found and printed; this overrides)";
constexpr const char* kRobot = "Robot and method";
constexpr const char* kTime = "Time";
constexpr const char* kOutput = "Output";
constexpr const char* kGeneral = "General";

// what --source-fps and --start may say; wider than any motion, narrower than any slip
constexpr double kSlowestRate = 0.001;
constexpr double kFastestRate = 1e6;
constexpr double kLongestTime = 1e9;

constexpr const char* kFooter = R"(
Exit codes: 0 done, 1 the run failed, 2 wrong usage, 3 bad input file,
4 bad configuration, model or unknown robot, 130 interrupted.

Examples:
  retarget --bvh walk.bvh --robot unitree_g1 -o walk.csv
  retarget --bvh walk.bvh --robot unitree_g1 --fps source --precision 9 -o -
  retarget inspect walk.bvh
  retarget evaluate walk.csv --robot unitree_g1 --bvh walk.bvh)";

// the option's own words say what it takes; CLI11's would stand beside them
CLI::Validator silent(CLI::Validator validator) {
  return validator.description("");
}

// a finite number in a range, with words of its own where it is not
CLI::Validator number_from(double least, double most) {
  const auto check = [least, most](const std::string& text) -> std::string {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = error == std::errc() && end == text.data() + text.size();
    if (whole && value >= least && value <= most) return {};
    return "expected a number from " + number_text(least, 3) + " to " + number_text(most, 0) +
           ", found \"" + text + "\"";
  };
  return CLI::Validator(check, "");
}

void add_common_options(CLI::App& app, CommonOptions& options) {
  app.add_flag("-q,--quiet", options.quiet, "Print errors only")->group(kGeneral);
  app.add_option("--data-dir", options.data_dir,
                 "Folder that holds robots/ and configs/\n"
                 "(default: $RETARGET_DATA_DIR, else found beside the program)")
      ->type_name("DIR")
      ->group(kGeneral);
}

void add_source_options(CLI::App& app, SourceOptions& options) {
  app.add_flag("--lenient", options.lenient,
               "Keep the complete frames of a damaged file, say what was\ndropped")
      ->group(kInput);
  app.add_option("--root", options.root, "Which tree to read, when a file holds several ROOTs")
      ->type_name("NAME")
      ->group(kInput);
  app.add_option("--source-fps", options.source_fps,
                 "Frames per second of the source, whatever its header says")
      ->type_name("N")
      ->check(number_from(kSlowestRate, kFastestRate))
      ->group(kInput);
}

void add_human_options(CLI::App& app, HumanOptions& options) {
  app.add_option("--map", options.map,
                 "Which joint is which bone: a mapping file in place of\nrecognition")
      ->type_name("FILE")
      ->group(kHuman);
  app.add_option("--write-map", options.write_map, "Write the mapping that was used, to be edited")
      ->type_name("FILE")
      ->group(kHuman);
  app.add_flag("--partial", options.partial, "Accept a body without arms or without legs")
      ->group(kHuman);
  app.add_option(
         "--rest", options.rest,
         "The pose that is a T-pose, or is brought to one: the zero\npose, the first frame, "
         "the best frame, or none (learned\nfrom the movement)")
      ->type_name("auto|zero|first|best|learned")
      ->check(silent(CLI::IsMember({"auto", "zero", "first", "best", "learned"})))
      ->capture_default_str()
      ->group(kHuman);
  app.add_option("--tpose-frame", options.tpose_frame, "Frame of the source that is the T-pose")
      ->type_name("N")
      ->check(silent(CLI::NonNegativeNumber))
      ->group(kHuman);
  app.add_option("--tpose-file", options.tpose_file,
                 "BVH of the same skeleton whose first frame is the T-pose")
      ->type_name("FILE")
      ->group(kHuman);
  app.add_option("--unit", options.unit, "Unit of length: m, dm, cm, mm, inch, cmu, or metres")
      ->type_name("UNIT")
      ->group(kHuman);
  app.add_option("--up", options.up, "Up axis of the source: y, z, -y, ...")
      ->type_name("AXIS")
      ->group(kHuman);
  app.add_option("--forward", options.forward, "Where the source's rest pose faces")
      ->type_name("AXIS")
      ->group(kHuman);
  app.add_option("--height", options.height,
                 "Height of the body, metres (default: estimated; 1.75 for\nLAFAN1)")
      ->type_name("M")
      ->check(number_from(0.1, 10.0))
      ->group(kHuman);
}

void add_motion_options(CLI::App& app, RunOptions& run) {
  SourceOptions& options = run.source;
  app.add_option("--bvh", options.file, "Motion to retarget; - reads standard input")
      ->type_name("FILE")
      ->group(kInput);
  app.add_option("--smpl", run.smpl_file, "SMPL or SMPL-X motion to retarget, NPZ as in AMASS")
      ->type_name("FILE")
      ->group(kInput);
  app.add_option("--smpl-model", options.smpl_model,
                 "Your SMPL-X or SMPL+H body model (NPZ) for bone lengths\n(default: a generic "
                 "body of the same height)")
      ->type_name("FILE")
      ->group(kInput);
}

void add_run_options(CLI::App& app, RunOptions& options) {
  add_motion_options(app, options);
  add_source_options(app, options.source);
  app.add_option("--start", options.start_s, "Begin at this time of the source, seconds")
      ->type_name("S")
      ->check(number_from(0.0, kLongestTime))
      ->group(kInput);
  app.add_option("--end", options.end_s, "End at this time of the source, seconds, inclusive")
      ->type_name("S")
      ->check(number_from(0.0, kLongestTime))
      ->group(kInput);
  app.add_option("--frames", options.frames,
                 "Source frames from A up to, not including, B; either may be left out")
      ->type_name("A:B")
      ->group(kInput);

  add_human_options(app, options.human);

  app.add_option("--robot", options.robot, "Robot by name, or a robot folder")
      ->type_name("NAME")
      ->group(kRobot);
  app.add_option("--robot-xml", options.robot_xml,
                 "Any other robot: its MJCF model; meshes are not needed")
      ->type_name("FILE")
      ->group(kRobot);
  app.add_option("--robot-profile", options.robot_profile,
                 "Output joint order, limit sets and soles of --robot-xml, JSON")
      ->type_name("FILE")
      ->group(kRobot);
  app.add_option("--dof", options.dof,
                 "Variant of the robot whose other joints are held and not\nwritten: 29, 27, 23 "
                 "or 23-pbhc for the G1 (default: all)")
      ->type_name("NAME")
      ->group(kRobot);
  app.add_option("--ik-config", options.ik_config,
                 "Mapping from human bones to robot bodies, JSON\n"
                 "(default: the robot's own)")
      ->type_name("FILE")
      ->group(kRobot);
  app.add_option("--limits", options.limits,
                 "Joint limits: a set of the robot (official, gmr), or\n"
                 "a JSON or MJCF file (default: gmr with --method gmr)")
      ->type_name("SET|FILE")
      ->group(kRobot);
  app.add_option("--method", options.method,
                 "fit: a motion that the robot can follow, the whole clip at\nonce; gmr: the "
                 "published two-pass inverse kinematics, frame\nby frame")
      ->type_name("fit|gmr")
      ->check(silent(CLI::IsMember({"fit", "gmr"})))
      ->capture_default_str()
      ->group(kRobot);
  app.add_option("--fit-config", options.fit_config, "Weights and other options of the fit, JSON")
      ->type_name("FILE")
      ->group(kRobot);
  app.add_option("--without", options.without,
                 "Terms that the fit leaves out: floor, self-collision,\ncontact, ...")
      ->type_name("TERM,...")
      ->delimiter(',')
      ->group(kRobot);

  app.add_option("--scale", options.scale,
                 "How the body's size scales the motion: table as published\n(default of LAFAN1); "
                 "limbs gives legs, trunk and arms the\nrobot's lengths (default of all others); "
                 "height brings every\nbody to one size first (default with --height)")
      ->type_name("auto|table|height|limbs")
      ->check(silent(CLI::IsMember({"auto", "table", "height", "limbs"})))
      ->capture_default_str()
      ->group(kRobot);
  app.add_option("--engine", options.engine,
                 "Implementation of the inverse kinematics; both take the\nsame steps")
      ->type_name("fast|reference")
      ->check(silent(CLI::IsMember({"fast", "reference"})))
      ->capture_default_str()
      ->group(kRobot);

  app.add_option("--fps", options.fps, "Output rate in frames per second, or `source`")
      ->type_name("N|source")
      ->capture_default_str()
      ->group(kTime);
  app.add_option("--interpolation", options.interpolation, "Between source frames")
      ->type_name("linear|cubic")
      ->check(silent(CLI::IsMember({"linear", "cubic"})))
      ->capture_default_str()
      ->group(kTime);
  app.add_flag("--no-antialias", options.no_antialias,
               "Do not low-pass a source that is faster than the output")
      ->group(kTime);

  app.add_option("-o,--output", options.output, "CSV to write; - writes standard output")
      ->type_name("FILE")
      ->group(kOutput);
  app.add_option("--precision", options.precision, "Digits after the decimal point, 0 to 17")
      ->type_name("N")
      ->check(silent(CLI::Range(0, 17)))
      ->capture_default_str()
      ->group(kOutput);
  app.add_option("--csv-delimiter", options.delimiter, "Between columns")
      ->type_name("comma|space|tab")
      ->check(silent(CLI::IsMember({"comma", "space", "tab"})))
      ->capture_default_str()
      ->group(kOutput);
  app.add_flag("--csv-header", options.header, "Write a first line that names the columns")
      ->group(kOutput);
  app.add_option("--csv-quat", options.quaternion, "Order of the root quaternion")
      ->type_name("xyzw|wxyz")
      ->check(silent(CLI::IsMember({"xyzw", "wxyz"})))
      ->capture_default_str()
      ->group(kOutput);
  app.add_flag("--normalize-start", options.normalize_start,
               "Move and turn the motion so that it starts at x = y = 0,\nfacing +x")
      ->group(kOutput);
  app.add_option("--report", options.report,
                 "Write how good the motion is, JSON as of retarget evaluate")
      ->type_name("FILE")
      ->group(kOutput);
  add_common_options(app, options.common);
}

CLI::App* add_inspect_command(CLI::App& app, InspectOptions& options) {
  CLI::App* command = app.add_subcommand("inspect", "Show what a motion file holds");
  command->add_option("file", options.source.file, "BVH or SMPL NPZ; - reads standard input")
      ->required()
      ->type_name("FILE");
  add_source_options(*command, options.source);
  command
      ->add_flag("--skeleton", options.skeleton_only,
                 "The skeleton is enough: accept a file without MOTION")
      ->group(kInput);
  add_human_options(*command, options.human);
  command->add_flag("--json", options.json, "Print JSON on standard output")->group(kOutput);
  command
      ->add_option("--positions", options.positions,
                   "Write world positions and quaternions (xyzw) of all joints and end sites, "
                   "in the file's units and axes, as CSV; - writes standard output")
      ->type_name("FILE")
      ->group(kOutput);
  add_common_options(*command, options.common);
  return command;
}

// one kind of edit: `retarget edit NAME IN ... -o OUT`
void add_edit(CLI::App& edits, EditOptions& options, Edit edit, const char* name,
              const char* description, const char* like_option) {
  CLI::App* command = edits.add_subcommand(name, description);
  command->parse_complete_callback([&options, edit] { options.edit = edit; });
  command->add_option("file", options.source.file, "Motion to edit, BVH; - reads standard input")
      ->required()
      ->type_name("FILE");
  if (like_option[0] != '\0') {
    command->add_option(like_option, options.like, "BVH of the skeleton that is wanted")
        ->required()
        ->type_name("FILE")
        ->group(kInput);
  }
  add_source_options(*command, options.source);
  if (edit != Edit::kRest) add_human_options(*command, options.human);
  command->add_option("-o,--output", options.output, "BVH to write; - writes standard output")
      ->required()
      ->type_name("FILE")
      ->group(kOutput);
  add_common_options(*command, options.common);
}

CLI::App* add_edit_command(CLI::App& app, EditOptions& options) {
  CLI::App* command = app.add_subcommand("edit", "Change a motion: BVH in, BVH out");
  command->require_subcommand(1);
  add_edit(*command, options, Edit::kRest, "rest",
           "The same movement on a skeleton of the same joints with another rest pose", "--like");
  add_edit(*command, options, Edit::kTransfer, "transfer",
           "Another skeleton, moved through the T-pose", "--to");
  add_edit(*command, options, Edit::kLafan1, "lafan", "A clip in the shape of LAFAN1", "");
  return command;
}

CLI::App* add_evaluate_command(CLI::App& app, EvaluateOptions& options) {
  CLI::App* command = app.add_subcommand(
      "evaluate", "Measure robot motions; exit code 1 when a gate is missed (docs/quality.md)");
  RunOptions& run = options.run;
  command->add_option("motions", options.motions, "Robot CSVs; - reads standard input")
      ->required()
      ->type_name("CSV...");
  add_motion_options(*command, run);
  command->get_option("--bvh")->description("The movement that the motions came from");
  command->get_option("--smpl")->description("The same as SMPL or SMPL-X motion, NPZ");
  add_source_options(*command, run.source);
  command->add_option("--start", run.start_s, "Where in the source the motions begin, seconds")
      ->type_name("S")
      ->check(number_from(0.0, kLongestTime))
      ->group(kInput);
  command
      ->add_option("--csv-quat", run.quaternion,
                   "Order of the root quaternion where no header tells")
      ->type_name("xyzw|wxyz")
      ->check(silent(CLI::IsMember({"xyzw", "wxyz"})))
      ->capture_default_str()
      ->group(kInput);
  add_human_options(*command, run.human);
  command->add_option("--robot", run.robot, "Robot by name, or a robot folder")
      ->type_name("NAME")
      ->group(kRobot);
  command->add_option("--robot-xml", run.robot_xml, "Any other robot: its MJCF model")
      ->type_name("FILE")
      ->group(kRobot);
  command->add_option("--robot-profile", run.robot_profile, "Profile of --robot-xml, JSON")
      ->type_name("FILE")
      ->group(kRobot);
  command
      ->add_option("--ik-config", run.ik_config,
                   "Mapping whose targets are tracked (default: the robot's\nown)")
      ->type_name("FILE")
      ->group(kRobot);
  command
      ->add_option("--limits", run.limits,
                   "Joint limits: a set of the robot, or a JSON or MJCF file\n"
                   "(default: the robot's own)")
      ->type_name("SET|FILE")
      ->group(kRobot);
  command
      ->add_option("--scale", run.scale, "How the body's size scales the targets that are tracked")
      ->type_name("auto|table|height|limbs")
      ->check(silent(CLI::IsMember({"auto", "table", "height", "limbs"})))
      ->capture_default_str()
      ->group(kRobot);
  command
      ->add_option("--fps", run.fps,
                   "Rate of the motions in frames per second, or `source`;\nthe source is "
                   "resampled to it")
      ->type_name("N|source")
      ->capture_default_str()
      ->group(kTime);
  command
      ->add_option("--json", options.json,
                   "Write the report as JSON; - writes standard output, in\nplace of the table")
      ->type_name("FILE")
      ->group(kOutput);
  command
      ->add_option("--gate", options.gates,
                   "What to ask for beyond configs/quality/default.json, or\ninstead: a file like "
                   "it, METRIC=MOST, METRIC=none, or none\nfor no gates at all; repeatable")
      ->type_name("FILE|METRIC=N")
      ->take_all()
      ->allow_extra_args(false)
      ->group(kOutput);
  add_common_options(*command, run.common);
  return command;
}

// `retarget robots WORD`
CLI::App* add_robots_action(CLI::App& robots, RobotsOptions& options, RobotsAction action,
                            const char* name, const char* description) {
  CLI::App* command = robots.add_subcommand(name, description);
  command->parse_complete_callback([&options, action] { options.action = action; });
  if (action == RobotsAction::kList || action == RobotsAction::kShow) {
    command->add_flag("--json", options.json, "Print JSON")->group(kOutput);
  }
  add_common_options(*command, options.common);
  return command;
}

CLI::App* add_robots_command(CLI::App& app, RobotsOptions& options) {
  CLI::App* command = app.add_subcommand("robots", "List, show, check and add robots");
  command->require_subcommand(1);
  add_robots_action(*command, options, RobotsAction::kList, "list", "The robots that are there");
  CLI::App* show = add_robots_action(*command, options, RobotsAction::kShow, "show",
                                     "A robot's joints, limits, mapping and size");
  show->add_option("robot", options.robot, "Name or folder")->required()->type_name("ROBOT");
  CLI::App* check = add_robots_action(*command, options, RobotsAction::kCheck, "check",
                                      "Every fault and oddity of a robot; exit code 4 on faults");
  check->add_option("robot", options.robot, "Name, folder or model file")
      ->required()
      ->type_name("ROBOT");
  CLI::App* add = add_robots_action(*command, options, RobotsAction::kAdd, "add",
                                    "Make a robot's folder from a model");
  add->add_option("name", options.robot, "The new robot's name")->required()->type_name("NAME");
  add->add_option("--model", options.model, "MJCF, or URDF; meshes are not needed")
      ->required()
      ->type_name("FILE")
      ->group(kInput);
  add->add_option("-o,--output", options.output, "Folder to put the robot's folder into")
      ->type_name("DIR")
      ->capture_default_str()
      ->group(kOutput);
  add->add_flag("--force", options.force, "Replace a folder that is there")->group(kOutput);
  return command;
}

// names what the command line holds beyond its options, with the option that may be meant
Failure unknown_words(const CLI::App& app) {
  std::vector<std::string> known;
  for (const CLI::App* part : app.get_subcommands()) {
    for (const CLI::Option* option : part->get_options()) known.push_back(option->get_name());
  }
  for (const CLI::Option* option : app.get_options()) known.push_back(option->get_name());
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
  InspectOptions inspect_options;
  const CLI::App* inspect_command = add_inspect_command(app, inspect_options);
  EditOptions edit_options;
  const CLI::App* edit_command = add_edit_command(app, edit_options);
  EvaluateOptions evaluate_options;
  const CLI::App* evaluate_command = add_evaluate_command(app, evaluate_options);
  RobotsOptions robots_options;
  const CLI::App* robots_command = add_robots_command(app, robots_options);

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
  if (robots_command->parsed()) {
    Console console(robots_options.common.quiet);
    return robots(robots_options, console);
  }
  Console console(run_options.common.quiet);
  if (!run_options.smpl_file.empty()) {
    if (!run_options.source.file.empty()) {
      return console.fail(
          usage_failure("--bvh and --smpl both name a motion", "give one of them").value());
    }
    run_options.source.file = run_options.smpl_file;
    run_options.source.smpl = true;
  }
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
