#include <fmt/format.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "app/options/checked_text.h"
#include "app/options/option_uses.h"
#include "base/option_name.h"
#include "human/skeleton/posed_body.h"
#include "retarget/option_table.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr double kMaxTime = 1e9;  // Seconds.

// Name and length in metres.
constexpr std::array<std::pair<std::string_view, double>, 6> kUnits = {
    {{"m", 1.0}, {"dm", 0.1}, {"cm", 0.01}, {"mm", 0.001}, {"inch", 0.0254}, {"cmu", 0.056444}}};

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

}  // namespace

Result<std::optional<double>> unit_from_text(const std::string& text) {
  if (text.empty()) return std::optional<double>();
  for (const auto& [name, metres] : kUnits) {
    if (text == name) return std::optional(metres);
  }
  if (const auto metres = number_in(text, 1e-6, 1e6)) return metres;
  return usage_failure(fmt::format(
      "expected m, dm, cm, mm, inch, cmu, or metres from 0.000001 to 1000000, found \"{}\"", text));
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
