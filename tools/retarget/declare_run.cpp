#include "declare.h"
#include "declare_shared.h"

namespace retarget::cli {

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
  add_lead_in_option(app, options);

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
                 "Mapping from human bones to robot bodies: that of the\npublished method, the one "
                 "derived from the robot's model, or\na JSON file (default: derived; with "
                 "--method gmr published\nfor LAFAN1 where there is one)")
      ->type_name("published|derived|FILE")
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
  app.add_option("--window", options.fit_window_s,
                 "Seconds that the fit solves together: memory, and how far\nit looks ahead "
                 "(default: 20)")
      ->type_name("SECONDS")
      ->check(number_from(0.1, 1e6))
      ->group(kRobot);
  app.add_option("--without", options.without,
                 "Terms that the fit leaves out: floor, self-collision,\ncontact, ...")
      ->type_name("TERM,...")
      ->delimiter(',')
      ->group(kRobot);

  app.add_option(
         "--scale", options.scale,
         "How the body's size scales the motion: limbs gives legs,\ntrunk and arms the robot's "
         "lengths; table as published (default\nof LAFAN1 with --method gmr, --ik-config "
         "published or FILE);\nheight brings every body to one size first\n"
         "(default with --height)")
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

  add_output_options(app, options);
  app.add_flag("--sidecar", options.sidecar,
               "Write FILE.json beside each output: hashes, options, what was\nfound, quality; "
               "retarget verify checks it")
      ->group(kOutput);
  app.add_option("--report", options.report,
                 "Write how good the motion is, JSON as of retarget evaluate")
      ->type_name("FILE")
      ->group(kOutput);
  add_common_options(app, options.common);
  app.add_flag(
         "-v,--verbose", options.verbose,
         "Say as well what each term of the fit costs, before and after, and its worst frames")
      ->group(kGeneral);
}

void add_run_words(CLI::App& app, RunOptions& options) {
  app.add_option("motion", options.words[0], "Motion to retarget, BVH or SMPL NPZ by its content")
      ->type_name("[MOTION]");
  app.add_option("robot-name", options.words[1], "The robot, as --robot")->type_name("[ROBOT]");
}

}  // namespace retarget::cli
