// Formats the contents of a motion file as text and JSON, and lists joint poses and sole contacts.

#include <algorithm>
#include <string>
#include <vector>

#include "base/json.h"
#include "judge/quality/body_tracks.h"
#include "retarget/clip.h"
#include "retarget/contact_plan.h"
#include "retarget/inspect.h"
#include "retarget/pose.h"
#include "retarget/skeleton_points.h"
#include "retarget/text.h"

namespace retarget {
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

// Adds the recognised human, or the reason why none was recognised.
void add_human(Json& json, const Inspection& found) {
  if (found.map == nullptr) {
    for (const char* key :
         {"dialect", "confidence", "mapping", "unit", "up", "forward", "height_m", "rest_pose"}) {
      json[key] = nullptr;
    }
    json["not_understood"] = spell_options(full_message(*found.reason), found.spelling);
    return;
  }
  const BoneMap& map = *found.map;
  const Calibration& calibration = *found.calibration;
  json["dialect"] = map.profile;
  json["confidence"] = map.confidence;
  for (const Bone bone : kMappedBones) {
    const int joint = map.joint(bone);
    json["mapping"][std::string(bone_name(bone))] =
        joint < 0 ? Json() : Json(found.clip.skeleton().joint(joint).name);
  }
  json["unit"] = calibration.unit;
  json["metres_per_unit"] = calibration.metres_per_unit;
  json["up"] = to_text(calibration.up);
  json["forward"] = to_text(calibration.forward);
  json["height_m"] = calibration.height;
  json["rest_pose"] = calibration.rest_pose;
  json["rest_pose_degrees_off"] = calibration.rest_deviation;
  json["notes"] = map.notes;
  json["doubts"] = Json::array();
  for (const Warning& doubt : calibration.doubts) {
    json["doubts"].push_back(spell_options(doubt.message, found.spelling));
  }
}

std::string vector_text(const Eigen::Vector3d& v) {
  return number_text(v.x(), 4) + " " + number_text(v.y(), 4) + " " + number_text(v.z(), 4);
}

// Describes the choice among several motions in a file, and lists the file's takes.
std::string scene_text(const Inspection& found) {
  constexpr std::size_t kTextColumn = 12;
  const ClipOrigin& origin = found.clip.origin();
  if (origin.choices.empty()) return {};
  const std::string choices = spell_options(origin.choices, found.spelling);
  std::string text = "  source    " + wrapped_text(choices, kTextColumn, kTextColumn + 2) + "\n";
  for (std::size_t i = 0; origin.takes.size() > 1 && i < origin.takes.size(); ++i) {
    text += (i == 0 ? "  takes     " : std::string(kTextColumn, ' ')) + std::to_string(i + 1) +
            ": " + origin.takes[i] + "\n";
  }
  return text;
}

std::string human_text(const Inspection& found) {
  constexpr std::size_t kTextColumn = 12;
  const auto line = [](const std::string& label, const std::string& text) {
    std::string start = "  " + label;
    start.resize(kTextColumn, ' ');
    return start + wrapped_text(text, kTextColumn, kTextColumn + 2) + "\n";
  };
  if (found.map == nullptr) {
    const std::string reason = spell_options(full_message(*found.reason), found.spelling);
    return line("human", "not understood: " + reason) + "\n";
  }
  const BoneMap& map = *found.map;
  const Calibration& calibration = *found.calibration;
  std::string text =
      line("human", calibration.description + "; confidence " + number_text(map.confidence, 2));
  for (const std::string& note : map.notes) text += line("", note);
  for (const Warning& doubt : calibration.doubts) {
    text += line("", "uncertain: " + spell_options(doubt.message, found.spelling));
  }
  text += "\n";
  for (const Bone bone : kMappedBones) {
    const int joint = map.joint(bone);
    std::string name(bone_name(bone));
    name.resize(14, ' ');
    text += "  " + name + (joint < 0 ? "-" : found.clip.skeleton().joint(joint).name) + "\n";
  }
  return text + "\n";
}

}  // namespace

std::string inspection_json(const Inspection& found) {
  const Clip& clip = found.clip;
  const Eigen::AlignedBox3d box = extents(clip);
  Json json;
  json["file"] = found.file;
  json["fps"] = clip.rate().fps();
  json["frames"] = clip.frame_count();
  json["duration_s"] = clip.duration();
  json["channels"] = clip.skeleton().channel_count();
  json["joints"] = Json::array();
  for (const Joint& joint : clip.skeleton().joints()) {
    json["joints"].push_back(joint_json(clip.skeleton(), joint));
  }
  json["extents"] = {{"min", to_json(box.min())}, {"max", to_json(box.max())}};
  if (!clip.origin().choices.empty()) {
    json["choices"] = spell_options(clip.origin().choices, found.spelling);
    json["takes"] = clip.origin().takes;
  }
  json["warnings"] = Json::array();
  for (const Warning& warning : found.warnings) {
    json["warnings"].push_back({{"line", warning.line},
                                {"column", warning.column},
                                {"message", spell_options(warning.message, found.spelling)}});
  }
  add_human(json, found);
  return printable_dump(json);
}

std::string inspection_text(const Inspection& found) {
  const Clip& clip = found.clip;
  const Skeleton& skeleton = clip.skeleton();
  const Eigen::AlignedBox3d box = extents(clip);
  std::string text = found.file + "\n";
  text += "  frames    " + std::to_string(clip.frame_count()) + "\n";
  text += "  rate      " + to_text(clip.rate()) + " fps\n";
  text += "  duration  " + number_text(clip.duration(), 3) + " s\n";
  text += "  joints    " + std::to_string(skeleton.joint_count()) + ", " +
          count_text(skeleton.channel_count(), "channel") + "\n";
  text += "  extents   " + vector_text(box.min()) + "  to  " + vector_text(box.max()) +
          "  (file units and axes)\n";
  text += scene_text(found);
  text += human_text(found);
  std::vector<int> depth(skeleton.joint_count(), 0);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const Joint& joint = skeleton.joint(j);
    if (joint.parent >= 0) depth[j] = depth[joint.parent] + 1;
    // Limits the indentation of very deep trees.
    const int shown_depth = std::min(depth[j], 40);
    text += std::string(2 + 2 * static_cast<std::size_t>(shown_depth), ' ') + joint.name +
            "  offset " + vector_text(joint.offset);
    if (!joint.channels.empty()) text += "  " + channel_list(joint);
    if (!joint.end_sites.empty()) text += "  +" + count_text(joint.end_sites.size(), "end site");
    text += "\n";
  }
  return text;
}

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
    text += number_text(clip.rate().time_of(frame));
    for (const SkeletonPoint& point : points) {
      const Pose pose = world_from_point(point, world_from_joint);
      const Eigen::Vector4d xyzw = pose.rotation.coeffs();
      for (const double value : {pose.translation.x(), pose.translation.y(), pose.translation.z(),
                                 xyzw[0], xyzw[1], xyzw[2], xyzw[3]}) {
        text += ',' + number_text(value);
      }
    }
    text += '\n';
  }
  return text;
}

std::vector<SoleContacts> sole_contacts(const RobotClip& clip) {
  std::vector<SoleContacts> contacts;
  for (const SoleTrack& track : track_soles(clip)) {
    SoleContacts& found = contacts.emplace_back(SoleContacts{track.sole, {}});
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      if (!track.stands(frame, clip.rate().fps())) continue;
      if (found.phases.empty() || found.phases.back().end != frame) {
        found.phases.push_back({frame, frame, 0.0});
      }
      ++found.phases.back().end;
    }
  }
  return contacts;
}

}  // namespace retarget
