#pragma once

#include <string>
#include <utility>

#include "retarget/ik_config.h"

namespace retarget {

/// A mapping for a robot that it fits.
inline ResolvedMapping resolved(const IkTables& tables, const Robot& robot) {
  return resolve_mapping(tables, robot).value();
}

/// A mapping of bodies that are called pelvis, torso, l_thigh, l_shin, l_foot, l_arm, l_elbow,
/// l_hand and r_ likewise.
inline IkTables limbed_tables() {
  IkTables tables;
  tables.file = "ik.json";
  tables.robot_root = "pelvis";
  tables.human_root = "Hips";
  const auto follow = [&](const std::string& body, const std::string& bone) {
    IkRow row;
    row.body = body;
    row.bone = bone;
    row.position_weight = row.rotation_weight = 1.0;
    tables.tables[0].rows.push_back(row);
    tables.scales.emplace_back(bone, 1.0);
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
  return tables;
}

}  // namespace retarget
