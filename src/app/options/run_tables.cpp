#include <fmt/format.h>
#include <array>
#include <cmath>
#include <utility>

#include "app/options/checked_text.h"
#include "app/options/scene_options.h"
#include "base/option_name.h"
#include "human/skeleton/posed_body.h"
#include "retarget/option_table.h"
#include "retarget/reference.h"
#include "retarget/text.h"
#include "retarget/time_scale.h"

namespace retarget {
namespace {

// Wide enough for any motion, narrow enough to catch typing errors.
constexpr double kMinRate = 0.001, kMaxRate = 1e6, kMaxTime = 1e9;
// Legs do not reach much farther than the human's.
constexpr double kMinTravel = 0.5, kMaxTravel = 1.2;

// Name and length in metres.
constexpr std::array<std::pair<std::string_view, double>, 6> kUnits = {
    {{"m", 1.0}, {"dm", 0.1}, {"cm", 0.01}, {"mm", 0.001}, {"inch", 0.0254}, {"cmu", 0.056444}}};

// Further uses of an option. To judge or show a motion, its source must be read and interpreted as
// in the run that made it.
constexpr OptionUse kJudged = OptionUse::kMeasure | OptionUse::kShow | OptionUse::kShowBatch;
constexpr OptionUse kReading = kJudged | OptionUse::kInspect | OptionUse::kEdit;
constexpr OptionUse kHuman = kJudged | OptionUse::kInspect | OptionUse::kEdit | OptionUse::kLive;
constexpr OptionUse kRobot =
    OptionUse::kMeasure | OptionUse::kShow | OptionUse::kConvert | OptionUse::kLive;

std::optional<double> number_in(std::string_view text, double min, double max) {
  const auto number = parse_number<double>(text);
  return number && *number >= min && *number <= max ? number : std::nullopt;
}

std::string axis_text(const std::optional<SignedAxis>& axis) {
  if (!axis) return {};
  return std::string(axis->negative ? "-" : "") + "xyz"[axis->axis];
}

std::optional<SignedAxis> read_axis(const std::string& text) {
  const bool is_signed = !text.empty() && (text.front() == '-' || text.front() == '+');
  const std::string letter = is_signed ? text.substr(1) : text;
  if (letter != "x" && letter != "y" && letter != "z") return std::nullopt;
  return SignedAxis{letter.front() - 'x', text.front() == '-'};
}

Result<std::optional<SignedAxis>> axis_from_text(const std::string& text) {
  if (text.empty()) return std::optional<SignedAxis>();
  if (const auto axis = read_axis(text)) return axis;
  return usage_failure(fmt::format("expected x, y, z, -x, -y or -z, found \"{}\"", text));
}

std::string direction_text(const std::optional<Eigen::Vector3d>& direction) {
  if (!direction) return {};
  const SignedAxis nearest = nearest_axis(*direction);
  if (nearest.direction() == *direction) return axis_text(nearest);
  return fmt::format("{},{},{}", direction->x(), direction->y(), direction->z());
}

Result<std::optional<Eigen::Vector3d>> direction_from_text(const std::string& text) {
  if (text.empty()) return std::optional<Eigen::Vector3d>();
  if (const auto axis = read_axis(text)) return std::optional(axis->direction());
  if (const auto numbers = numbers_from_text(text, ','); numbers && numbers->size() == 3) {
    constexpr double kUnit = 1e-12;  // Keeps written directions bitwise.
    const Eigen::Vector3d direction((*numbers)[0], (*numbers)[1], (*numbers)[2]);
    const double length = direction.norm();
    if (std::abs(length - 1.0) < kUnit) return std::optional(direction);
    if (length > 0.0 && std::isfinite(length)) {
      return std::optional<Eigen::Vector3d>(direction / length);
    }
  }
  return usage_failure(fmt::format(
      "expected x, y, z, -x, -y, -z or a vector such as 0.1,0.99,0, found \"{}\"", text));
}

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

Result<std::optional<double>> unit_from_text(const std::string& text) {
  if (text.empty()) return std::optional<double>();
  for (const auto& [name, metres] : kUnits) {
    if (text == name) return std::optional(metres);
  }
  if (const auto metres = number_in(text, 1e-6, 1e6)) return metres;
  return usage_failure(fmt::format(
      "expected m, dm, cm, mm, inch, cmu, or metres from 0.000001 to 1000000, found \"{}\"", text));
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

Option memory_row(double& memory_gb) {
  return option("memory", memory_gb, kInputGroup, "GB",
                "Reject motions that need more memory than this, GB (default: three quarters of "
                "the available memory)",
                {.min = 0.001,
                 .max = 1e6,
                 .decides = false,
                 .uses = OptionUse::kMeasure | OptionUse::kInspect | OptionUse::kEdit});
}

Option output_row(std::string& output) {
  return option("output", output, kOutputGroup, "FILE", "File to write; - writes standard output",
                {.basic = true, .letter = "o", .uses = OptionUse::kShow});
}

OptionTable motion_file_table(MotionFileOptions& options, bool decides) {
  constexpr const char* group = kMotionFileGroup;
  const OptionInfo info{.decides = decides, .uses = OptionUse::kShowBatch | OptionUse::kInspect};
  OptionTable table = {
      option("from", options.from, group, "",
             "Format of the file. NPZ: selects the joint order, which is otherwise detected; other "
             "formats: skips the comparison of stored body positions with forward kinematics",
             info),
      option("source-quat", options.quaternion, group, "",
             "Order of the root quaternion in the file", info),
      option("source-angles", options.angles, group, "", "Unit of the joints in a CSV or pickle",
             info),
      option("source-unit", options.unit, group, "", "Unit of the root position in a CSV or pickle",
             info),
      option("source-dof", options.dof, group, "NAME",
             "Robot variant whose joints the file contains", info),
      option("ignore-header", options.ignore_header, group, "",
             "Read the columns of a CSV by position and ignore its header", info)};
  table[0].choices = {"npz-mjlab", "npz-beyondmimic", "npz-holosoma",
                      "pkl-gmr",   "protomotions",    "csv-sonic"};
  table[2].choices = {"rad", "deg"};
  table[3].choices = {"m", "cm", "mm"};
  // An empty value leaves the unit to the file.
  table[2].is_optional = table[3].is_optional = true;
  return table;
}

OptionTable source_table(SourceOptions& options) {
  OptionTable table = {
      option("smpl-model", options.smpl_model, kInputGroup, "FILE",
             "Your SMPL-X or SMPL+H body model (NPZ) for bone lengths (default: a generic body "
             "of the same height)",
             {.file = OptionFile::kContent, .uses = kReading}),
      option("lenient", options.lenient, kInputGroup, "",
             "Keep the complete frames of a damaged file and report the dropped ones",
             {.uses = kReading}),
      option("root", options.root, kInputGroup, "NAME",
             "Skeleton to read if the file contains several ROOTs or skeletons: its name, or its "
             "number from 1 if names are equal (FBX, glTF); the subject of an MVNX file",
             {.uses = kReading}),
      option("take", options.take, kInputGroup, "NAME|N",
             "Motion to read if the file contains several: its name, or its number from 1 (FBX, "
             "glTF, SMPL, positions; default: the longest one that moves the body)",
             {.uses = kReading}),
      option("joint-names", options.joint_names, kInputGroup, "FILE",
             "Joint names, one per line or as a JSON list, for a file of joint positions whose "
             "joint order is unknown",
             {.file = OptionFile::kContent, .uses = kReading}),
      option("source-fps", options.source_fps, kInputGroup, "N",
             "Frames per second of the source; overrides its header",
             {.min = kMinRate, .max = kMaxRate, .uses = kReading}),
      option("from-robot", options.from_robot, kInputGroup, "NAME",
             "Robot of the source motion: CSV, NPZ, pickle, ... (docs/robot_to_robot.md)",
             {.basic = true, .uses = kJudged | OptionUse::kInspect | OptionUse::kEdit})};
  append(table, motion_file_table(options.robot_file, true));
  table.push_back(memory_row(options.memory_gb));
  return table;
}

OptionTable human_table(HumanOptions& options) {
  return {
      option("map", options.map, kHumanGroup, "FILE",
             "Bone map (the joint of every bone) to use instead of automatic recognition",
             {.file = OptionFile::kContent, .uses = kHuman}),
      option("partial", options.partial, kHumanGroup, "",
             "Accept a body without arms or without legs", {.uses = kHuman}),
      option("rest", options.rest, kHumanGroup, "",
             "Pose to use as T-pose, corrected if necessary: the zero pose, the first frame, the "
             "best frame; learned: no pose, the movement determines the bone axes",
             {.uses = kHuman}),
      option("tpose-frame", options.tpose_frame, kHumanGroup, "N",
             "Source frame that shows the T-pose",
             {.min = 0.0, .uses = kJudged | OptionUse::kInspect | OptionUse::kEdit}),
      option("tpose-file", options.tpose_file, kHumanGroup, "FILE",
             "BVH of the same skeleton whose first frame shows the T-pose",
             {.file = OptionFile::kContent, .uses = kHuman}),
      checked_text<unit_from_text>("unit", options.unit, kHumanGroup, "UNIT",
                                   "Length unit: m, dm, cm, mm, inch, cmu, or metres",
                                   {.uses = kHuman}),
      text_option("up", options.up, kHumanGroup, "AXIS",
                  "Up axis of the source: y, z, -y, ..., or a vector X,Y,Z, which levels the clip",
                  direction_text, direction_from_text, {.uses = kHuman}),
      text_option("forward", options.forward, kHumanGroup, "AXIS",
                  "Facing direction of the source's rest pose", axis_text, axis_from_text,
                  {.uses = kHuman}),
      option(
          "height", options.height, kHumanGroup, "M",
          "Body height, metres; determines an unknown unit (default: estimated; 1.75 for LAFAN1)",
          {.min = 0.1, .max = 10.0, .uses = kHuman}),
      option("clean", options.clean, kHumanGroup, "",
             "Noise of video estimates and IMU suits: auto removes measured noise and reports it, "
             "except with " OPTION("method") " gmr; clean clips remain unchanged",
             {.uses = kJudged})};
}

OptionTable part_table(PartOptions& options) {
  return {option("start", options.start_s, kInputGroup, "S",
                 "Start at this time of the source, seconds",
                 {.min = 0.0, .max = kMaxTime, .uses = kJudged | OptionUse::kEdit}),
          option("end", options.end_s, kInputGroup, "S",
                 "End at this time of the source, seconds, inclusive",
                 {.min = 0.0, .max = kMaxTime, .uses = kJudged | OptionUse::kEdit}),
          option("frames", options.frames, kInputGroup, "A:B",
                 "Source frames A to B, excluding B; either may be omitted",
                 {.uses = kJudged | OptionUse::kEdit}),
          option("lead-in", options.lead_in, kInputGroup, "",
                 "Leading frames before a jump (a T-pose, all zeros), unless " OPTION(
                     "start") " or " OPTION("frames") " is given: auto drops them except "
                                                      "with " OPTION("method") " gmr",
                 {.uses = kJudged})};
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

OptionTable reading_table(ReadingOptions& options) {
  OptionTable table = {option("source-fps", options.source_fps, kMotionFileGroup, "N",
                              "Frames per second of the file (default: the file's own; CSV 30, "
                              "SOMA 120)",
                              {.min = 0.001, .max = 1e6, .decides = false})};
  append(table, motion_file_table(options, false));
  // Insert before the last option, which concerns columns.
  table.insert(table.end() - 1,
               option("motion", options.motion, kMotionFileGroup, "NAME",
                      "Motion to read from a PBHC pickle with several", {.decides = false}));
  return table;
}

ReadMotionOptions read_motion_options(const MotionFileOptions& options, double source_fps,
                                      const std::string& motion) {
  ReadMotionOptions read;
  read.format = options.from;
  if (source_fps > 0.0) read.rate = frame_rate_from_fps(source_fps);
  read.quaternion = options.quaternion;
  if (!options.angles.empty()) read.degrees = options.angles == "deg";
  if (options.unit == "m") read.metres_per_unit = 1.0;
  if (options.unit == "cm") read.metres_per_unit = 0.01;
  if (options.unit == "mm") read.metres_per_unit = 0.001;
  read.variant = options.dof;
  read.motion = motion;
  read.ignore_header = options.ignore_header;
  return read;
}

ReadMotionOptions read_motion_options(const ReadingOptions& options, std::size_t max_bytes) {
  ReadMotionOptions read = read_motion_options(options, options.source_fps, options.motion);
  read.max_bytes = max_bytes;
  return read;
}

}  // namespace retarget
