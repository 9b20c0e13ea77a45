#include "declare.h"
#include "declare_shared.h"

namespace retarget::cli {

CLI::App* add_view_command(CLI::App& app, ViewOptions& options) {
  CLI::App* command = app.add_subcommand("view", "Draw a robot motion as a strip of poses, SVG");
  command->add_option("motion", options.motion, "CSV, NPZ or pickle; - reads standard input")
      ->required()
      ->type_name("MOTION");
  command->add_option("--strip", options.strip, "How many poses, from the first frame to the last")
      ->type_name("N")
      ->check(silent(CLI::Range(1, 100)))
      ->capture_default_str()
      ->group(kOutput);
  command->add_option("-o,--output", options.run.output, "SVG to write; - writes standard output")
      ->required()
      ->type_name("FILE")
      ->group(kOutput);
  add_motion_options(*command, options.run);
  command->get_option("--bvh")->description(
      "The movement that the motion came from, drawn above it");
  command->get_option("--smpl")->description("The same as SMPL or SMPL-X motion, NPZ");
  command
      ->add_option("--start", options.run.start_s, "Where in the source the motion begins, seconds")
      ->type_name("S")
      ->check(number_from(0.0, kLongestTime))
      ->group(kInput);
  add_lead_in_option(*command, options.run);
  add_human_options(*command, options.run.human);
  add_robot_choice(*command, options.run);
  add_reading_options(*command, options.reading);
  add_common_options(*command, options.run.common);
  return command;
}

}  // namespace retarget::cli
