#pragma once

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "human/skeleton/recognise.h"
#include "human/skeleton/skeleton_profile.h"
#include "retarget/clip.h"
#include "retarget/human_skeleton.h"
#include "support/with_joints.h"

namespace retarget {

/// A skeleton from lines `name x y z`, indented by two blanks per parent; names may contain blanks.
/// The line `end x y z` is an end site.
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
  const int joint = map.joint(bone_from_name(bone).value());
  return joint < 0 ? std::string() : skeleton.joint(joint).name;
}

inline const std::vector<SkeletonProfile>& shipped_profiles() {
  static const std::vector<SkeletonProfile> kProfiles =
      load_skeleton_profiles(std::filesystem::path(RETARGET_SOURCE_DIR) / "configs" / "skeletons")
          .value();
  return kProfiles;
}

/// A body in a T-pose, y up, z forward, its left at +x; centimetres.
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

/// LAFAN1's own tree and axes.
inline constexpr const char* kLafan1 = R"(
Hips 10 90 10
  LeftUpLeg 0.1 1.9 10.5
    LeftLeg 43.5 0 0
      LeftFoot 42.4 0 0
        LeftToe 17.3 0 0
  RightUpLeg 0.1 1.9 -10.5
    RightLeg 43.5 0 0
      RightFoot 42.4 0 0
        RightToe 17.3 0 0
  Spine 6.9 -2.6 0
    Spine1 12.6 0 0
      Spine2 12.3 0 0
        Neck 25.8 0 0
          Head 11.8 0 0
        LeftShoulder 19.7 -1.5 6
          LeftArm 11.3 0 0
            LeftForeArm 33 0 0
              LeftHand 25.2 0 0
        RightShoulder 19.7 -1.5 -6
          RightArm 11.3 0 0
            RightForeArm 33 0 0
              RightHand 25.2 0 0
)";

/// The skeleton with other names, joint by joint in order.
inline Skeleton with_names(const Skeleton& skeleton, const std::vector<std::string>& names) {
  std::vector<Joint> joints = skeleton.joints();
  for (std::size_t i = 0; i < joints.size(); ++i) joints[i].name = names[i];
  return Skeleton(std::move(joints));
}

/// Meaningless names: j0, j1 and so on.
inline std::vector<std::string> meaningless_names(const Skeleton& skeleton) {
  std::vector<std::string> names;
  for (int i = 0; i < skeleton.joint_count(); ++i) names.push_back("j" + std::to_string(i));
  return names;
}

/// The motion on a skeleton with meaningless names.
inline Clip without_names(const Clip& clip) {
  const Skeleton unnamed = with_names(clip.skeleton(), meaningless_names(clip.skeleton()));
  return with_joints(clip, unnamed.joints());
}

/// recognise_skeleton with the shipped profiles.
inline Result<BoneMap> recognise(const Skeleton& skeleton, bool partial = false) {
  return recognise_skeleton(skeleton, shipped_profiles(), {.partial = partial});
}

}  // namespace retarget
