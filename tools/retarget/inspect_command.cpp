// `retarget inspect`: joints, rate, duration and extents of a motion file.

#include <algorithm>
#include <array>
#include <charconv>
#include <nlohmann/json.hpp>

#include "base/data_folder.h"
#include "base/file.h"
#include "base/printable.h"
#include "commands.h"
#include "human_source.h"
#include "motion/forward_kinematics.h"
#include "motion/skeleton_points.h"
#include "wrapped_text.h"
#include "written_files.h"

namespace retarget::cli {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

std::string channel_list(const Joint& joint) {
  std::string text;
  for (const Channel channel : joint.channels) {
    if (!text.empty()) text += ' ';
    text += channel_name(channel);
  }
  return text;
}

Json joint_json(const Skeleton& skeleton, const Joint& joint) {
  Json json;
  json["name"] = joint.name;
  json["parent"] = joint.parent < 0 ? Json() : Json(skeleton.joint(joint.parent).name);
  json["parent_index"] = joint.parent < 0 ? Json() : Json(joint.parent);
  json["offset"] = to_json(joint.offset);
  json["channels"] = Json::array();
  for (const Channel channel : joint.channels) json["channels"].push_back(channel_name(channel));
  json["end_sites"] = Json::array();
  for (const Eigen::Vector3d& end : joint.end_sites) json["end_sites"].push_back(to_json(end));
  return json;
}

// what was understood of the human, or why nothing was
void add_human(Json& json, const Clip& clip, const Result<HumanSource>& human) {
  if (!human) {
    for (const char* key :
         {"dialect", "confidence", "mapping", "unit", "up", "forward", "height_m", "rest_pose"}) {
      json[key] = nullptr;
    }
    json["not_understood"] = spell_options(full_message(human.error()), option_as_flag);
    return;
  }
  const auto& [map, calibration] = *human;
  json["dialect"] = map.dialect;
  json["confidence"] = map.confidence;
  for (const Bone bone : kMappedBones) {
    const int joint = map.joint_of_bone[bone];
    json["mapping"][std::string(bone_name(bone))] =
        joint < 0 ? Json() : Json(clip.skeleton().joint(joint).name);
  }
  json["unit"] = calibration.unit;
  json["metres_per_unit"] = calibration.mapping.metres_per_unit;
  json["up"] = to_text(calibration.up);
  json["forward"] = to_text(calibration.forward);
  json["height_m"] = calibration.mapping.height;
  json["rest_pose"] = calibration.rest_pose;
  json["rest_pose_degrees_off"] = calibration.rest_deviation;
  json["notes"] = map.notes;
  json["doubts"] = Json::array();
  for (const Warning& doubt : calibration.mapping.doubts) {
    json["doubts"].push_back(spell_options(doubt.message, option_as_flag));
  }
}

std::string report_json(const SourceMotion& file, const Result<HumanSource>& human,
                        const std::string& name) {
  const Clip& clip = file.clip;
  const Eigen::AlignedBox3d box = extents(clip);
  Json json;
  json["file"] = name;
  json["fps"] = clip.rate().fps();
  json["frames"] = clip.frame_count();
  json["duration_s"] = clip.duration();
  json["channels"] = clip.skeleton().channel_count();
  json["joints"] = Json::array();
  for (const Joint& joint : clip.skeleton().joints()) {
    json["joints"].push_back(joint_json(clip.skeleton(), joint));
  }
  json["extents"] = {{"min", to_json(box.min())}, {"max", to_json(box.max())}};
  json["warnings"] = Json::array();
  for (const Warning& warning : file.warnings) {
    json["warnings"].push_back({{"line", warning.line},
                                {"column", warning.column},
                                {"message", spell_options(warning.message, option_as_flag)}});
  }
  add_human(json, clip, human);
  // names are the file's bytes; what is no UTF-8 must not end the program
  return printable_json(json.dump(2, ' ', false, Json::error_handler_t::replace)) + "\n";
}

std::string vector_text(const Eigen::Vector3d& v) {
  return number_text(v.x(), 4) + " " + number_text(v.y(), 4) + " " + number_text(v.z(), 4);
}

std::string human_text(const Clip& clip, const Result<HumanSource>& human) {
  constexpr std::size_t kTextColumn = 12;
  const auto line = [](const std::string& label, const std::string& text) {
    std::string start = "  " + label;
    start.resize(kTextColumn, ' ');
    return start + wrapped_text(text, kTextColumn, kTextColumn + 2) + "\n";
  };
  if (!human)
    return line("human",
                "not understood: " + spell_options(full_message(human.error()), option_as_flag)) +
           "\n";
  const auto& [map, calibration] = *human;
  std::string text = line("human", calibration.mapping.description + "; " + map.dialect +
                                       ", confidence " + number_text(map.confidence, 2));
  for (const std::string& note : map.notes) text += line("", note);
  for (const Warning& doubt : calibration.mapping.doubts) {
    text += line("", "doubtful: " + spell_options(doubt.message, option_as_flag));
  }
  text += "\n";
  for (const Bone bone : kMappedBones) {
    const int joint = map.joint_of_bone[bone];
    std::string name(bone_name(bone));
    name.resize(14, ' ');
    text += "  " + name + (joint < 0 ? "-" : clip.skeleton().joint(joint).name) + "\n";
  }
  return text + "\n";
}

std::string report_text(const SourceMotion& file, const Result<HumanSource>& human,
                        const std::string& name) {
  const Clip& clip = file.clip;
  const Skeleton& skeleton = clip.skeleton();
  const Eigen::AlignedBox3d box = extents(clip);
  std::string text = name + "\n";
  text += "  frames    " + std::to_string(clip.frame_count()) + "\n";
  text += "  rate      " + to_text(clip.rate()) + " fps\n";
  text += "  duration  " + number_text(clip.duration(), 3) + " s\n";
  text += "  joints    " + std::to_string(skeleton.joint_count()) + ", " +
          count_text(skeleton.channel_count(), "channel") + "\n";
  text += "  extents   " + vector_text(box.min()) + "  to  " + vector_text(box.max()) +
          "  (file units and axes)\n";
  text += human_text(clip, human);
  std::vector<int> depth(skeleton.joint_count(), 0);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const Joint& joint = skeleton.joint(j);
    if (joint.parent >= 0) depth[j] = depth[joint.parent] + 1;
    // very deep trees would indent beyond any screen
    const int shown_depth = std::min(depth[j], 40);
    text += std::string(2 + 2 * static_cast<std::size_t>(shown_depth), ' ') + joint.name +
            "  offset " + vector_text(joint.offset);
    if (!joint.channels.empty()) text += "  " + channel_list(joint);
    if (!joint.end_sites.empty()) text += "  +" + count_text(joint.end_sites.size(), "end site");
    text += "\n";
  }
  return text;
}

void append_number(std::string& text, double value) {
  std::array<char, 40> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text.append(digits.data(), end);
}

// names with a comma, a quote or a line end are quoted as RFC 4180 asks
std::string csv_field(const std::string& field) {
  if (field.find_first_of(",\"\r\n") == std::string::npos) return field;
  std::string quoted = "\"";
  for (const char c : field) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

// shortest numbers that read back to the same doubles
std::string positions_csv(const Clip& clip) {
  const std::vector<SkeletonPoint> points = skeleton_points(clip.skeleton());
  std::string text = "frame,time";
  for (const SkeletonPoint& point : points) {
    for (const char* column : {".x", ".y", ".z", ".qx", ".qy", ".qz", ".qw"}) {
      text += "," + csv_field(point.name + column);
    }
  }
  text += "\n";
  std::vector<Pose> world_from_joint(clip.skeleton().joint_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, world_from_joint);
    text += std::to_string(frame) + ",";
    append_number(text, clip.rate().time_of(frame));
    for (const SkeletonPoint& point : points) {
      const Pose pose = world_from_point(point, world_from_joint);
      const Eigen::Vector4d xyzw = pose.rotation.coeffs();
      for (const double value : {pose.translation.x(), pose.translation.y(), pose.translation.z(),
                                 xyzw[0], xyzw[1], xyzw[2], xyzw[3]}) {
        text += ',';
        append_number(text, value);
      }
    }
    text += '\n';
  }
  return text;
}

Result<HumanSource> understand(SourceMotion motion, const InspectOptions& options) {
  const auto& chosen = options.common.data_dir;
  const auto data =
      find_data_folder(chosen.empty() ? std::nullopt : std::optional<std::string>(chosen));
  if (!data) return failure(data.error());
  return find_human(motion, options.source, options.human, *data / "configs" / "skeletons");
}

}  // namespace

ExitCode inspect(const InspectOptions& options, Console& console) {
  if (options.json && options.positions == "-") {
    return console.fail(usage_failure("--json and --positions - both want standard output",
                                      "give --positions a file name")
                            .value());
  }
  RunOptions read;
  read.common = options.common;
  read.source = options.source;
  read.human = options.human;
  const auto spared = check_written({options.positions, options.human.write_map}, files_of(read));
  if (!spared) return console.fail(spared.error());
  const auto file = read_source(options.source, options.skeleton_only, console);
  if (!file) return console.fail(file.error());
  const auto human = understand(*file, options);
  // what the user asked for must be possible; what was only looked at need not be a human
  if (!human && human.error().kind != ErrorKind::kInput) return console.fail(human.error());

  if (!options.positions.empty()) {
    const auto written = write_file(options.positions, positions_csv(file->clip));
    if (!written) return console.fail(written.error());
    if (options.positions == "-") return kDone;
  }
  const std::string name = source_name(options.source);
  const auto printed = write_file("-", options.json ? report_json(*file, human, name)
                                                    : printable(report_text(*file, human, name)));
  if (!printed) return console.fail(printed.error());
  return kDone;
}

}  // namespace retarget::cli
