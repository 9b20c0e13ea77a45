#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "edit/transfer.h"
#include "human/skeleton/calibrate.h"
#include "human/skeleton/posed_body.h"
#include "human/skeleton/skeleton_profile.h"
#include "human/twins.h"
#include "retarget/load.h"
#include "retarget/plan.h"
#include "support/shared_data.h"

namespace retarget {

/// A skeleton for posture tests, with the statements of its file.
struct PostureTarget {
  std::string name;
  TransferTarget target;
  ClipOrigin origin;  ///< Of the file.
};

/// A file of a standing human as a target; nothing without a human.
inline std::optional<PostureTarget> posture_target(const std::filesystem::path& file) {
  auto clip = load_clip(file.string(), SourceOptions{}, DataFolder{RETARGET_SOURCE_DIR});
  if (!clip) return std::nullopt;
  const auto human = find_human(*clip, HumanOptions{}, RETARGET_SOURCE_DIR);
  if (!human) return std::nullopt;
  return PostureTarget{file.filename().string(),
                       {clip->shared_skeleton(), human->map, human->calibration},
                       clip->origin()};
}

/// LAFAN1's body in a T-pose with the names of a kind, rotated so that the zero pose stands along
/// an axis. @param standing  a clip of LAFAN1's names and axes
inline PostureTarget posture_target(const SkeletonProfile& profile, const Clip& standing,
                                    const SignedAxis& up) {
  const Clip t_pose = with_t_pose_as_zero(standing);
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitY(), up.direction());
  const Skeleton& body = t_pose.skeleton();
  const double metres_per_unit = profile.facts.metres_per_unit.value_or(0.01);
  std::vector<Joint> joints;
  std::vector<int> new_index(static_cast<std::size_t>(body.joint_count()), -1);
  BoneMap map;
  map.profile = profile.name;
  for (int i = 0; i < body.joint_count(); ++i) {
    Joint joint = body.joint(i);
    const Bone bone = bone_from_name(joint.name).value();
    int parent = joint.parent;
    while (parent >= 0 && new_index[static_cast<std::size_t>(parent)] < 0) {
      joint.offset += body.joint(parent).offset;
      parent = body.joint(parent).parent;
    }
    if (profile.names[bone].empty()) continue;
    joint.name = profile.names[bone][0];
    joint.parent = parent < 0 ? -1 : new_index[static_cast<std::size_t>(parent)];
    joint.offset = 0.01 / metres_per_unit * (turn * joint.offset);
    for (Eigen::Vector3d& end : joint.end_sites) end = 0.01 / metres_per_unit * (turn * end);
    map.joint_of_bone[bone] = new_index[static_cast<std::size_t>(i)] =
        static_cast<int>(joints.size());
    joints.push_back(std::move(joint));
  }
  for (const std::string& name : profile.required) {
    if (std::ranges::find(joints, name, &Joint::name) != joints.end()) continue;
    Joint further;
    further.name = name;
    further.parent = 0;
    joints.push_back(std::move(further));
  }
  auto skeleton = std::make_shared<const Skeleton>(std::move(joints));
  CalibrationOptions options;
  options.up = up.direction();
  options.metres_per_unit = metres_per_unit;
  Calibration calibration = calibrate(Clip(skeleton, FrameRate{}, 1), map, options).value();
  return {profile.name + " " + to_text(up), {skeleton, std::move(map), std::move(calibration)}, {}};
}

}  // namespace retarget
