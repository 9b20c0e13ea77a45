#pragma once

#include <string>
#include <utility>

#include "retarget/retargeting_config.h"

namespace retarget {

/// Resolves a retargeting configuration for a robot that it fits.
inline ResolvedConfig resolved(const RetargetingConfig& config, const Robot& robot) {
  return resolve_config(config, robot).value();
}

/// A retargeting configuration for bodies with the names pelvis, torso, l_thigh, l_shin, l_foot,
/// l_arm, l_elbow, l_hand, and the same with r_.
inline RetargetingConfig limbed_config() {
  RetargetingConfig config;
  config.file = "ik.json";
  config.robot_root = "pelvis";
  config.human_root = "Hips";
  const auto follow = [&](const std::string& body, const std::string& bone) {
    IkMatch row;
    row.body = body;
    row.bone = bone;
    row.position_weight = row.rotation_weight = 1.0;
    config.match_tables[0].rows.push_back(row);
    config.scales.emplace_back(bone, 1.0);
  };
  follow("pelvis", "Hips");
  follow("torso", "Spine2");
  for (const auto& [letter, side] : {std::pair("l_", "Left"), std::pair("r_", "Right")}) {
    const std::string l = letter, s = side;
    follow(l + "thigh", s + "UpLeg");
    follow(l + "shin", s + "Leg");
    follow(l + "foot", s + "FootMod");
    follow(l + "arm", s + "Arm");
    follow(l + "elbow", s + "ForeArm");
    follow(l + "hand", s + "Hand");
  }
  return config;
}

}  // namespace retarget
