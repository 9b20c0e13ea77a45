#include <fmt/format.h>

#include "app/options/checked_text.h"
#include "app/options/option_uses.h"
#include "app/options/scene_options.h"
#include "base/option_name.h"
#include "retarget/option_table.h"
#include "retarget/reference.h"
#include "retarget/text.h"
#include "retarget/time_scale.h"

namespace retarget {
namespace {

// Legs do not reach much farther than the human's.
constexpr double kMinTravel = 0.5, kMaxTravel = 1.2;

std::string rate_text(const std::optional<double>& fps) {
  return fps ? fmt::format("{}", *fps) : "source";
}

}  // namespace

Result<std::optional<double>> rate_from_text(const std::string& text) {
  if (text == "source") return std::optional<double>();
  if (const auto fps = number_in(text, kMinRate, kMaxRate)) return fps;
  return usage_failure(
      fmt::format("expected a number from 0.001 to 1000000 or `source`, found \"{}\"", text));
}

Result<std::optional<double>> travel_from_text(const std::string& text) {
  if (text == "auto") return std::optional<double>();
  if (const auto factor = number_in(text, kMinTravel, kMaxTravel)) return factor;
  return usage_failure(fmt::format("expected a number from {} to {} or `auto`, found \"{}\"",
                                   kMinTravel, kMaxTravel, text));
}

Result<std::optional<double>> time_scale_from_text(const std::string& text) {
  if (text == "auto") return std::optional<double>();
  if (const auto factor = number_in(text, kLeastTimeScale, 1.0)) return factor;
  return usage_failure(
      fmt::format("expected a number from {} to 1 or `auto`, found \"{}\"", kLeastTimeScale, text));
}

Option output_row(std::string& output) {
  return option("output", output, kOutputGroup, "FILE", "File to write; - writes standard output",
                {.basic = true, .letter = "o", .uses = OptionUse::kShow});
}

OptionTable robot_table(RobotChoice& options) {
  return {option("robot", options.name, kRobotGroup, "NAME", "Robot name or robot folder",
                 {.basic = true, .uses = kRobot}),
          option("robot-xml", options.model, kRobotGroup, "FILE",
                 "Any other robot: its MJCF model; meshes are not needed",
                 {.file = OptionFile::kContent, .uses = kRobot}),
          option("robot-profile", options.profile, kRobotGroup, "FILE",
                 "Output joint order, limit sets and soles of " OPTION("robot-xml") ", JSON",
                 {.file = OptionFile::kContent, .uses = kRobot}),
          option("dof", options.variant, kRobotGroup, "NAME",
                 "Variant of the robot with fewer joints: 29, 27, 23 or 23-pbhc for the G1 "
                 "(default: all joints)",
                 {.uses = kRobot}),
          option("base", options.base, kRobotGroup, "",
                 "fixed: the base does not move (a stand, a wheeled platform); only the limbs "
                 "attached to it follow the human; feet and floor are ignored (default: from the "
                 "robot's profile)",
                 {.uses = kRobot | OptionUse::kShowBatch}),
          option("follow", options.follow, kRobotGroup, "",
                 "arms: only the arms follow the human's arms, relative to the chest; base, legs, "
                 "trunk and head keep the standing pose, for another controller",
                 {.uses = OptionUse::kLive})};
}

namespace {

// Options that choose several others, and the path over the ground.
OptionTable purpose_table(SolveOptions& options) {
  return {
      option("for", options.purpose, kRobotGroup, "",
             "Preset: tracking, for training a policy that tracks the motion: " OPTION(
                 "travel") " auto, smoother joints and root (docs/fit.md); explicit options take "
                           "precedence",
             {.uses = OptionUse::kShowBatch, .recorded_if_given = true}),
      checked_text<travel_from_text>(
          "travel", options.travel, kRobotGroup, "S|auto",
          "Factor for the path of hips and planted feet over the ground, 0.5 to 1.2; "
          "heights, turns and times do not change. auto: 1 for a slow walk, 0.85 for a run, by the "
          "Froude number of the robot's legs (default: 1)",
          {.uses = kJudged, .recorded_if_given = true}),
      checked_text<time_scale_from_text>(
          "time-scale", options.time_scale, kTimeGroup, "S|auto",
          "Speed of the motion relative to the source, 0.25 to 1. auto: slow down only "
          "where joints exceed their speed limits or, unless the fit is " OPTION(
              "without") " dynamics, their torque limits (docs/references.md; default: 1)",
          {.uses = kJudged, .recorded_if_given = true})};
}

}  // namespace

OptionTable solve_table(SolveOptions& options) {
  OptionTable table = {
      option("limits", options.limits, kRobotGroup, "SET|FILE",
             "Joint limits: a set of the robot (official, gmr), or a JSON or MJCF file (default: "
             "gmr with " OPTION("method") " gmr)",
             {.file = OptionFile::kOrName, .uses = kJudged | OptionUse::kLive}),
      option("ik-config", options.ik_config, kRobotGroup, "published|derived|FILE",
             "Retargeting configuration (which robot body follows which bone): the published "
             "method's, the one derived from the robot's model, or a JSON file (default: "
             "derived; with " OPTION("method") " gmr published for LAFAN1 if available)",
             {.file = OptionFile::kOrName, .uses = kJudged | OptionUse::kLive}),
      option("method", options.method, kRobotGroup, "",
             "fit: optimise the whole clip for feasibility; gmr: the published two-pass inverse "
             "kinematics, frame by frame",
             {.basic = true, .uses = OptionUse::kShowBatch | OptionUse::kLive}),
      option("fit-config", options.fit_config, kRobotGroup, "FILE",
             "Weights and other options of the fit, JSON",
             {.file = OptionFile::kContent, .uses = OptionUse::kLive}),
      option("window", options.fit_window_s, kRobotGroup, "SECONDS",
             "Length of the windows into which the fit cuts a clip, seconds; determines memory and "
             "look-ahead (default: 20)",
             {.min = 0.1, .max = 1e6}),
      option("with", options.with, kRobotGroup, "TERM,...",
             "Terms of the fit that are off by default: dynamics in a scene or for a robot motion "
             "(docs/dynamics.md)"),
      option("without", options.without, kRobotGroup, "TERM,...",
             "Terms to omit from the fit: dynamics, floor, self-collision, contact, ...",
             {.uses = OptionUse::kLive}),
      option("contact-edits", options.contact_edits, kRobotGroup, "FILE",
             "Contacts to add, remove or shift after detection, JSON (docs/fit.md)",
             {.file = OptionFile::kContent,
              .uses = OptionUse::kMeasure | OptionUse::kShow | OptionUse::kOneClip,
              .recorded_if_given = true}),
      option("engine", options.engine, kRobotGroup, "",
             "Inverse kinematics engine; both produce the same iterates",
             {.uses = OptionUse::kLive}),
      option("hands", options.hands, kRobotGroup, "",
             "Fingers of robots with hands: auto imitates human fingers that move or close, and "
             "relaxes others; follow imitates every pose except the rest pose; relaxed keeps "
             "them half open; off includes them in the body solver, as auto does with " OPTION(
                 "method") " gmr",
             {.uses = OptionUse::kLive}),
      option("scale", options.scale, kRobotGroup, "",
             "Scaling of the motion: limbs scales legs, trunk and arms to the robot's lengths; "
             "table uses the published factors (default for LAFAN1 with " OPTION(
                 "method") " gmr, " OPTION("ik-config") " published or FILE); height first scales "
                                                        "every human to one size (default "
                                                        "with " OPTION("height") ")",
             {.none = "auto", .uses = kJudged | OptionUse::kLive})};
  append(table, scene_table(options));
  append(table, purpose_table(options));
  return table;
}

OptionTable time_table(TimeOptions& options) {
  return {text_option("fps", options.fps, kTimeGroup, "N|source",
                      "Output rate in frames per second, or `source`", rate_text, rate_from_text,
                      {.basic = true, .uses = OptionUse::kMeasure}),
          option("interpolation", options.interpolation, kTimeGroup, "",
                 "Interpolation method between source frames", {.uses = OptionUse::kShowBatch}),
          option("no-antialias", options.no_antialias, kTimeGroup, "",
                 "Do not low-pass filter a source whose rate is higher than the output's",
                 {.uses = OptionUse::kShowBatch})};
}

OptionTable save_table(SaveOptions& options) {
  return {
      option(
          "format", options.formats, kOutputGroup, "FORMAT,...",
          "csv (default), csv-soma, npz-mjlab, npz-beyondmimic, npz-holosoma, pkl-gmr, pkl-pbhc, "
          "pkl-motion-lib, pkl-mimickit, protomotions, csv-sonic (a folder), glb "
          "(default if the output ends in .glb); several formats are written to files named after "
          "the output",
          {.basic = true, .uses = OptionUse::kTrack}),
      option("precision", options.precision, kOutputGroup, "N",
             "CSV: digits after the decimal point, 0 to 17", {.min = 0.0, .max = 17.0}),
      option("csv-delimiter", options.delimiter, kOutputGroup, "", "CSV: column separator"),
      option("csv-header", options.header, kOutputGroup, "",
             "CSV: header line with the column names"),
      option("csv-quat", options.quaternion, kOutputGroup, "", "CSV: order of the root quaternion"),
      option("csv-frame-column", options.frame_column, kOutputGroup, "",
             "CSV: leading column with frame numbers from 0"),
      option("csv-degrees", options.degrees, kOutputGroup, "",
             "CSV: joints in degrees (default: radians)"),
      option("csv-centimetres", options.centimetres, kOutputGroup, "",
             "CSV: root position in centimetres (default: metres)"),
      option("normalize-start", options.normalize_start, kOutputGroup, "",
             "Move and turn the motion so that it starts at x = y = 0, facing +x",
             {.uses = OptionUse::kShowBatch}),
      option("npz-fps", options.npz_fps, kOutputGroup, "N",
             "NPZ and csv-sonic: frames per second; the fit uses this rate",
             {.min = 1.0, .max = 1000.0, .uses = OptionUse::kTrack}),
      option("npz-velocity", options.npz_velocity, kOutputGroup, "",
             "NPZ: linear velocities at link origins or centres of mass (default: link for "
             "npz-mjlab, mass for the other formats, as in their simulators)",
             {.uses = OptionUse::kTrack}),
      option("motion-name", options.motion_name, kOutputGroup, "NAME",
             "pkl-pbhc and pkl-motion-lib: name of the motion (default: the file's)"),
      option("contacts", options.contacts, kOutputGroup, "FILE",
             "Also write contacts of heels and toes, and with " OPTION(
                 "scene") " those of other parts: CSV with a header and one row per frame"),
      option("scene-out", options.scene_out, kOutputGroup, "FILE",
             "Also write the scene scaled to the robot: .xml is the robot with its scene as MJCF, "
             ".json the scene alone, .obj its static bodies",
             {.uses = OptionUse::kOneClip}),
      option("reference-rate", options.reference_rate, kOutputGroup, "N",
             "Also write a reference for controllers with N samples per second, 10 to 1000: "
             "positions, velocities, accelerations, contacts, forces and torques "
             "(docs/references.md)",
             {.min = kMinReferenceRate,
              .max = kMaxReferenceRate,
              .decides = false,
              .uses = OptionUse::kOneClip}),
      option("reference", options.reference, kOutputGroup, "FILE",
             "Name of the reference, .npz or .csv (default: the output's name with "
             ".reference.npz; 200 samples per second unless " OPTION("reference-rate") " is given)",
             {.decides = false, .uses = OptionUse::kOneClip})};
}

OptionTable run_table(Run& run) {
  Options& options = run.options;
  OptionTable table = {
      option("motion", run.motion, kInputGroup, "FILE", "Motion to retarget"),
      // The reader is chosen by file content; this row only records the use of the SMPL option.
      option("smpl", options.source.smpl, kInputGroup, "", "Read the motion as SMPL")};
  append(table, source_table(options.source));
  append(table, human_table(options.human));
  append(table, part_table(options.part));
  append(table, robot_table(run.robot));
  append(table, solve_table(options.solve));
  append(table, time_table(options.time));
  table.push_back(output_row(run.output));
  append(table, save_table(options.save));
  return table;
}

}  // namespace retarget
