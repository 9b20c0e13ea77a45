// Options about files of robot motions, and the commands for them.

#include "declare.h"
#include "declare_shared.h"
#include "retarget/motion_io.h"

namespace retarget::cli {
namespace {

constexpr const char* kFound = "Motion files (all of it is found and printed; this overrides)";

}  // namespace

void add_output_options(CLI::App& app, OutputOptions& options) {
  app.add_option("-o,--output", options.output, "File to write; - writes standard output")
      ->type_name("FILE")
      ->group(kOutput);
  app.add_option("--format", options.formats,
                 "csv (default), csv-soma, npz-mjlab, npz-beyondmimic,\npkl-gmr, pkl-pbhc; several "
                 "go to files named after -o, each\nwith an ending of its own")
      ->type_name("FORMAT,...")
      ->delimiter(',')
      ->take_all()
      ->allow_extra_args(false)
      ->check(silent(CLI::IsMember(format_names())))
      ->group(kOutput);
  app.add_option("--precision", options.precision, "CSV: digits after the decimal point, 0 to 17")
      ->type_name("N")
      ->check(silent(CLI::Range(0, 17)))
      ->capture_default_str()
      ->group(kOutput);
  app.add_option("--csv-delimiter", options.delimiter, "CSV: between columns")
      ->type_name("comma|space|tab")
      ->check(silent(CLI::IsMember({"comma", "space", "tab"})))
      ->capture_default_str()
      ->group(kOutput);
  app.add_flag("--csv-header", options.header, "CSV: a first line that names the columns")
      ->group(kOutput);
  app.add_flag("--csv-frame-column", options.frame_column,
               "CSV: a first column that counts frames from 0")
      ->group(kOutput);
  app.add_option("--csv-quat", options.quaternion, "CSV: order of the root quaternion")
      ->type_name("xyzw|wxyz")
      ->check(silent(CLI::IsMember({"xyzw", "wxyz"})))
      ->capture_default_str()
      ->group(kOutput);
  app.add_flag("--csv-degrees", options.degrees, "CSV: joints in degrees (default: radians)")
      ->group(kOutput);
  app.add_flag("--csv-centimetres", options.centimetres,
               "CSV: root position in centimetres (default: metres)")
      ->group(kOutput);
  app.add_option("--npz-fps", options.npz_fps, "NPZ: frames per second")
      ->type_name("N")
      ->check(number_from(1.0, 1000.0))
      ->capture_default_str()
      ->group(kOutput);
  app.add_option("--npz-velocity", options.npz_velocity,
                 "NPZ: linear velocities of the links' origins or of their\ncentres of mass "
                 "(default: link for npz-mjlab, mass for\nnpz-beyondmimic, as in their simulators)")
      ->type_name("link|mass")
      ->check(silent(CLI::IsMember({"link", "mass"})))
      ->group(kOutput);
  app.add_option("--motion-name", options.motion_name,
                 "pkl-pbhc: name of the motion (default: the file's)")
      ->type_name("NAME")
      ->group(kOutput);
  app.add_flag("--normalize-start", options.normalize_start,
               "Move and turn the motion so that it starts at x = y = 0,\nfacing +x")
      ->group(kOutput);
}

void add_robot_choice(CLI::App& app, RunOptions& run) {
  app.add_option("--robot", run.robot, "Robot by name, or a robot folder")
      ->type_name("NAME")
      ->group(kRobot);
  app.add_option("--robot-xml", run.robot_xml, "Any other robot: its MJCF model")
      ->type_name("FILE")
      ->group(kRobot);
  app.add_option("--robot-profile", run.robot_profile, "Joint order and soles of --robot-xml, JSON")
      ->type_name("FILE")
      ->group(kRobot);
  app.add_option("--dof", run.dof, "Variant of the robot whose other joints are held")
      ->type_name("NAME")
      ->group(kRobot);
}

void add_reading_options(CLI::App& app, ReadingOptions& options) {
  add_reading_rate(app, options);
  add_reading_layout(app, options);
}

void add_reading_rate(CLI::App& app, ReadingOptions& options) {
  app.add_option(
         "--source-fps", options.source_fps,
         "Frames per second of the file (default: what it says;\nof a CSV 30, of SOMA's 120)")
      ->type_name("N")
      ->check(number_from(kSlowestRate, kFastestRate))
      ->group(kFound);
}

void add_reading_layout(CLI::App& app, ReadingOptions& options) {
  app.add_option("--from", options.from, "NPZ: whose order of joints it has")
      ->type_name("npz-mjlab|npz-beyondmimic")
      ->check(silent(CLI::IsMember({"npz-mjlab", "npz-beyondmimic"})))
      ->group(kFound);
  app.add_option("--source-quat", options.quaternion, "Order of the root quaternion in the file")
      ->type_name("xyzw|wxyz")
      ->check(silent(CLI::IsMember({"xyzw", "wxyz"})))
      ->group(kFound);
  app.add_option("--source-angles", options.angles, "Unit of the joints in a CSV or pickle")
      ->type_name("rad|deg")
      ->check(silent(CLI::IsMember({"rad", "deg"})))
      ->group(kFound);
  app.add_option("--source-unit", options.unit, "Unit of the root position in a CSV or pickle")
      ->type_name("m|cm|mm")
      ->check(silent(CLI::IsMember({"m", "cm", "mm"})))
      ->group(kFound);
  app.add_option("--source-dof", options.dof, "Variant of the robot whose joints the file has")
      ->type_name("NAME")
      ->group(kFound);
  app.add_option("--motion", options.motion, "One of several motions in a PBHC pickle")
      ->type_name("NAME")
      ->group(kFound);
  app.add_flag("--ignore-header", options.ignore_header,
               "Take the columns of a CSV by their number, whatever its\nheader says")
      ->group(kFound);
}

CLI::App* add_convert_command(CLI::App& app, ConvertOptions& options) {
  CLI::App* command =
      app.add_subcommand("convert", "A robot's motion from one file format to others");
  command->add_option("input", options.input, "CSV, NPZ or pickle; - reads standard input")
      ->required()
      ->type_name("IN");
  command->add_option("out", options.run.output, "File to write, as -o")->type_name("OUT");
  add_memory_option(*command, options.run.source);
  add_reading_options(*command, options.reading);
  add_robot_choice(*command, options.run);
  options.run.fps = "source";
  command->add_option("--fps", options.run.fps, "Output rate in frames per second, or `source`")
      ->type_name("N|source")
      ->capture_default_str()
      ->group(kTime);
  command->add_option("--interpolation", options.run.interpolation, "Between frames")
      ->type_name("linear|cubic")
      ->check(silent(CLI::IsMember({"linear", "cubic"})))
      ->capture_default_str()
      ->group(kTime);
  command
      ->add_flag("--no-antialias", options.run.no_antialias,
                 "Do not low-pass a motion that goes to a lower rate")
      ->group(kTime);
  add_output_options(*command, options.run);
  add_common_options(*command, options.run.common);
  return command;
}

CLI::App* add_compare_command(CLI::App& app, CompareOptions& options) {
  CLI::App* command = app.add_subcommand(
      "compare", "Whether two motions agree, column by column; exit code 1 if not");
  command->add_option("a", options.a, "CSV, NPZ or pickle")->required()->type_name("A");
  command->add_option("b", options.b, "The other")->required()->type_name("B");
  command
      ->add_option("--tolerance", options.tolerance,
                   "Largest difference that counts as none, in the files' units")
      ->type_name("X")
      ->check(number_from(0.0, 1e6))
      ->capture_default_str()
      ->group(kGeneral);
  add_memory_option(*command, options.run.source);
  add_robot_choice(*command, options.run);
  add_reading_options(*command, options.reading);
  add_common_options(*command, options.run.common);
  return command;
}

}  // namespace retarget::cli
