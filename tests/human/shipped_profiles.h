#pragma once

#include <string>
#include <vector>

#include "human/hand_made_maps.h"

namespace retarget {

/// A real file with the manually determined joints of the bones.
struct ProfileFile {
  std::string file;
  std::vector<std::string> names;
  std::string unit;
};

inline std::vector<ProfileFile> profile_files() {
  using Names = std::vector<std::string>;
  const Names plain_arm = {"#Shoulder", "#Arm", "#ForeArm", "#Hand"};
  const Names collar_arm = {"#Collar", "#Shoulder", "#Elbow", "#Wrist"};
  const Names up_leg = {"#UpLeg", "#Leg", "#Foot", "#ToeBase"};
  const Names hip_leg = {"#Hip", "#Knee", "#Ankle", "#Toe"};
  const auto sided = [](const Names& leg, const Names& trunk, const Names& arm) {
    return two_sided(leg, trunk, arm, "Left", "Right");
  };
  const Names games =
      two_sided({"#Hip", "#Knee", "#Ankle", "#ToeJoint"},
                {"RootJoint", "pelvis_lowerback", "-", "lowerback_torso", "torso_head", "-"},
                {"#Torso_Clavicle", "#Shoulder", "#Elbow", "#Wrist"}, "l", "r");
  const Names soma = sided({"#Leg", "#Shin", "#Foot", "#ToeBase"},
                           {"Hips", "Spine1", "Spine2", "Chest", "Neck1", "Head"}, plain_arm);
  return {
      {"cmu_3dsmax_jumping_jacks.bvh",
       sided(hip_leg, {"Hips", "-", "Chest", "Chest2", "Neck", "Head"}, collar_arm), "CMU unit"},
      {"cmu_daz_03_03.bvh",
       two_sided({"#Thigh", "#Shin", "#Foot", "-"},
                 {"hip", "abdomen", "-", "chest", "neck", "head"},
                 {"#Collar", "#Shldr", "#ForeArm", "#Hand"}, "l", "r"),
       "cm"},
      {"cmu_motionbuilder_12_01_walk.bvh",
       sided(up_leg, {"Hips", "LowerBack", "Spine", "Spine1", "Neck1", "Head"}, plain_arm),
       "CMU unit"},
      {"fair_vicon_zup_inch_jumping.bvh",
       sided(up_leg, {"Hips", "Spine", "Spine1", "Spine3", "Neck", "Head"}, plain_arm), "inch"},
      {"games105_run_forward.bvh", games, "m"},
      {"games105_walk60.bvh", games, "m"},
      {"geno_stance.bvh",
       sided(up_leg, {"Hips", "Spine", "Spine1", "Spine3", "Neck", "Head"}, plain_arm), "cm"},
      {"makehuman_walk1.bvh",
       two_sided({"UpLeg_#", "LoLeg_#", "Foot_#", "Toe_#"},
                 {"Root", "Spine1", "Spine2", "Spine3", "Neck", "Head"},
                 {"Clavicle_#", "UpArm_#", "LoArm_#", "Hand_#"}, "L", "R"),
       "dm"},
      {"move_avatar_walking.bvh",
       sided({"#Thigh", "#Shin", "#Foot", "#Toe"},
             {"Hips", "Spine1", "Spine2", "Spine4", "Neck", "Head"}, plain_arm),
       "cm"},
      {"rokoko_dance_100fps.bvh",
       sided(up_leg, {"Hips", "Spine", "Spine1", "Spine2", "Neck", "Head"}, plain_arm), "cm"},
      {"soma_dance_120fps.bvh", soma, "cm"},
      {"soma_walk_forward_120fps.bvh", soma, "cm"},
      {"soma_zero_frame0.bvh", soma, "cm"},
      {"vicon_mixed_orders_zup_inch_1.bvh",
       sided(up_leg, {"Hips", "Spine", "Spine1", "Spine3", "Neck", "Head"}, plain_arm), "inch"},
      {"xsens_boxing_120fps.bvh",
       sided(hip_leg, {"Hips", "Chest", "Chest2", "Chest4", "Neck", "Head"}, collar_arm), "cm"},
  };
}

}  // namespace retarget
