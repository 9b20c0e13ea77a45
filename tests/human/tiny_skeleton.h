#pragma once

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "retarget/human/bone_map.h"
#include "retarget/human/dialect.h"
#include "retarget/motion/skeleton.h"

namespace retarget {

/// A skeleton from lines `name x y z`, indented by two blanks for each joint above; the name may
/// hold blanks. The line `end x y z` is an end site.
inline Skeleton tiny_skeleton(const std::string& text) {
  std::vector<Joint> joints;
  std::vector<int> above;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t indent = line.find_first_not_of(' ');
    if (indent == std::string::npos) continue;
    std::vector<std::string> words;
    std::istringstream stream(line);
    for (std::string word; stream >> word;) words.push_back(word);
    const std::size_t name_count = words.size() - 3;
    std::string name = words[0];
    for (std::size_t i = 1; i < name_count; ++i) name += " " + words[i];
    const Eigen::Vector3d offset(std::stod(words[name_count]), std::stod(words[name_count + 1]),
                                 std::stod(words[name_count + 2]));
    above.resize(indent / 2);
    if (name == "end") {
      joints[above.back()].end_sites.push_back(offset);
      continue;
    }
    Joint joint;
    joint.name = name;
    joint.parent = above.empty() ? -1 : above.back();
    joint.offset = offset;
    above.push_back(static_cast<int>(joints.size()));
    joints.push_back(std::move(joint));
  }
  return Skeleton(std::move(joints));
}

/// `text` with every occurrence of `from` replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

/// The name of the joint of a bone; empty: none.
inline std::string joint_name(const BoneMap& map, const Skeleton& skeleton, const char* bone) {
  return map.joint(bone) < 0 ? std::string() : skeleton.joint(map.joint(bone)).name;
}

inline const std::vector<Dialect>& shipped_dialects() {
  static const std::vector<Dialect> kDialects =
      load_dialects(std::filesystem::path(RETARGET_SOURCE_DIR) / "configs" / "skeletons").value();
  return kDialects;
}

/// A body that stands in a T-pose, y up, z forward, its left at +x; centimetres.
inline constexpr const char* kBody = R"(
Hips 0 90 0
  LeftUpLeg 10 -2 0
    LeftLeg 0 -42 0.5
      LeftFoot 0 -41 -0.5
        LeftToeBase 0 -6 13
          end 0 0 7
  RightUpLeg -10 -2 0
    RightLeg 0 -42 0.5
      RightFoot 0 -41 -0.5
        RightToeBase 0 -6 13
          end 0 0 7
  Spine 0 8 0
    Spine1 0 12 0
      Spine2 0 13 0
        Neck 0 24 0
          Head 0 11 0
            end 0 18 0
        LeftShoulder 5 18 0
          LeftArm 12 0 0
            LeftForeArm 29 0 0
              LeftHand 25 0 0
                end 15 0 0
        RightShoulder -5 18 0
          RightArm -12 0 0
            RightForeArm -29 0 0
              RightHand -25 0 0
                end -15 0 0
)";

}  // namespace retarget
