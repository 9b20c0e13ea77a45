// Skeleton names of FBX, glTF and VRM files, on a body in a T-pose (Y up, centimetres).

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "human/skeleton/recognise.h"
#include "human/skeleton/skeleton_profile.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::AnyOf;
using ::testing::Eq;

struct Part {
  Bone bone;
  Bone parent;
  Eigen::Vector3d place;
};

// A person of 1.75 m; x to the left.
const std::vector<Part>& body() {
  using enum Bone;
  static const std::vector<Part> parts = [] {
    std::vector<Part> all = {{kHips, kHips, {0, 95, 0}},      {kSpine, kHips, {0, 105, -1}},
                             {kSpine1, kSpine, {0, 117, -1}}, {kSpine2, kSpine1, {0, 130, -1}},
                             {kNeck, kSpine2, {0, 148, 0}},   {kHead, kNeck, {0, 157, 2}}};
    const auto side = [&all](double x, Bone shoulder, Bone arm, Bone forearm, Bone hand, Bone thigh,
                             Bone shin, Bone foot, Bone toe) {
      all.insert(all.end(), {{shoulder, kSpine2, {3 * x, 143, 0}},
                             {arm, shoulder, {18 * x, 143, 0}},
                             {forearm, arm, {45 * x, 143, 0}},
                             {hand, forearm, {70 * x, 143, 0}},
                             {thigh, kHips, {9 * x, 92, 0}},
                             {shin, thigh, {9 * x, 50, 0.5}},
                             {foot, shin, {9 * x, 9, -1}},
                             {toe, foot, {9 * x, 2, 12}}});
    };
    side(1, kLeftShoulder, kLeftArm, kLeftForeArm, kLeftHand, kLeftUpLeg, kLeftLeg, kLeftFoot,
         kLeftToe);
    side(-1, kRightShoulder, kRightArm, kRightForeArm, kRightHand, kRightUpLeg, kRightLeg,
         kRightFoot, kRightToe);
    return all;
  }();
  return parts;
}

// Names of the left side in the order of body(); a blank stands for the side, which is omitted
// elsewhere.
struct Naming {
  const char* kind;
  std::vector<std::string> trunk;  // hips to head
  std::vector<std::string> limbs;  // shoulder to toe, with `*` for the side
  const char* left;
  const char* right;
  const char* profile;
  const char* twin = "";  // a profile with the same names
};

void PrintTo(const Naming& naming, std::ostream* out) {
  *out << naming.kind;
}

std::string with_side(std::string name, const std::string& side) {
  const std::size_t at = name.find('*');
  return at == std::string::npos ? name : name.replace(at, 1, side);
}

std::string name_of(const Naming& naming, std::size_t part) {
  if (part < 6) return naming.trunk[part];
  const bool is_left = part < 14;
  return with_side(naming.limbs[(part - 6) % 8], is_left ? naming.left : naming.right);
}

Skeleton skeleton_of(const Naming& naming) {
  std::vector<Joint> joints;
  std::map<Bone, int> places;
  const auto& parts = body();
  // Depth first, as in a file.
  std::map<Bone, Eigen::Vector3d> stands;
  const auto add = [&](auto&& self, std::size_t part) -> void {
    Joint joint;
    joint.name = name_of(naming, part);
    if (part > 0) {
      joint.parent = places.at(parts[part].parent);
      joint.offset = parts[part].place - stands.at(parts[part].parent);
    }
    // A part without a name is omitted: its children become children of its parent.
    if (joint.name.empty()) {
      places[parts[part].bone] = joint.parent;
      stands[parts[part].bone] = stands.at(parts[part].parent);
      for (std::size_t child = 1; child < parts.size(); ++child) {
        if (parts[child].parent == parts[part].bone) self(self, child);
      }
      return;
    }
    stands[parts[part].bone] = parts[part].place;
    places[parts[part].bone] = static_cast<int>(joints.size());
    joints.push_back(joint);
    for (std::size_t child = 1; child < parts.size(); ++child) {
      if (parts[child].parent == parts[part].bone) self(self, child);
    }
  };
  add(add, 0);
  return Skeleton(std::move(joints));
}

class NamesOfScenesTest : public testing::TestWithParam<Naming> {};

TEST_P(NamesOfScenesTest, SkeletonIsRecognised) {
  const auto profiles =
      value_of(load_skeleton_profiles(std::string(RETARGET_SOURCE_DIR) + "/configs/skeletons"));
  const Skeleton skeleton = skeleton_of(GetParam());
  const auto map = value_of(recognise_skeleton(skeleton, profiles));
  EXPECT_THAT(map.profile, AnyOf(Eq(GetParam().profile), Eq("names"), Eq(GetParam().twin)));
  for (std::size_t part = 0; part < body().size(); ++part) {
    if (name_of(GetParam(), part).empty()) continue;
    const int joint = map.joint(body()[part].bone);
    ASSERT_GE(joint, 0) << bone_name(body()[part].bone);
    EXPECT_EQ(skeleton.joint(joint).name, name_of(GetParam(), part));
  }
}

std::vector<Naming> namings() {
  std::vector<Naming> all;
  for (const std::string prefix : {"mixamorig:", "mixamorig1:", "mixamorig9:", "mixamorig_", ""}) {
    Naming mixamo{"mixamo", {}, {}, "Left", "Right", "mixamo"};
    for (const char* name : {"Hips", "Spine", "Spine1", "Spine2", "Neck", "Head"})
      mixamo.trunk.push_back(prefix + name);
    for (const char* name :
         {"Shoulder", "Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot", "ToeBase"})
      mixamo.limbs.push_back(prefix + "*" + name);
    if (prefix.empty()) mixamo.twin = "nokov";
    all.push_back(mixamo);
  }
  all.push_back({"ue_mannequin",
                 {"pelvis", "spine_01", "spine_02", "spine_03", "neck_01", "head"},
                 {"clavicle_*", "upperarm_*", "lowerarm_*", "hand_*", "thigh_*", "calf_*", "foot_*",
                  "ball_*"},
                 "l",
                 "r",
                 "ue_mannequin"});
  all.push_back({"metahuman",
                 {"pelvis", "spine_01", "spine_03", "spine_05", "neck_01", "head"},
                 {"clavicle_*", "upperarm_*", "lowerarm_*", "hand_*", "thigh_*", "calf_*", "foot_*",
                  "ball_*"},
                 "l",
                 "r",
                 "ue_mannequin"});
  all.push_back(
      {"vrm",
       {"hips", "spine", "chest", "upperChest", "neck", "head"},
       {"*Shoulder", "*UpperArm", "*LowerArm", "*Hand", "*UpperLeg", "*LowerLeg", "*Foot", "*Toes"},
       "left",
       "right",
       "vrm"});
  all.push_back(
      {"vrm without an upper chest",
       {"hips", "spine", "", "chest", "neck", "head"},
       {"*Shoulder", "*UpperArm", "*LowerArm", "*Hand", "*UpperLeg", "*LowerLeg", "*Foot", "*Toes"},
       "left",
       "right",
       "vrm_short_spine"});
  all.push_back({"bandai",
                 {"Hips", "Spine", "", "Chest", "Neck", "Head"},
                 {"Shoulder_*", "UpperArm_*", "LowerArm_*", "Hand_*", "UpperLeg_*", "LowerLeg_*",
                  "Foot_*", "Toes_*"},
                 "L",
                 "R",
                 "bandai"});
  all.push_back({"rokoko",
                 {"Hips", "Spine1", "Spine2", "Spine3", "Neck", "Head"},
                 {"*Shoulder", "*Arm", "*ForeArm", "*Hand", "*Thigh", "*Shin", "*Foot", "*Toe"},
                 "Left",
                 "Right",
                 "rokoko_newton"});
  all.push_back({"character_creator",
                 {"CC_Base_Hip", "CC_Base_Waist", "CC_Base_Spine01", "CC_Base_Spine02",
                  "CC_Base_NeckTwist01", "CC_Base_Head"},
                 {"CC_Base_*_Clavicle", "CC_Base_*_Upperarm", "CC_Base_*_Forearm", "CC_Base_*_Hand",
                  "CC_Base_*_Thigh", "CC_Base_*_Calf", "CC_Base_*_Foot", "CC_Base_*_ToeBase"},
                 "L",
                 "R",
                 "character_creator"});
  all.push_back({"biped",
                 {"Bip001 Pelvis", "Bip001 Spine", "Bip001 Spine1", "Bip001 Spine2", "Bip001 Neck",
                  "Bip001 Head"},
                 {"Bip001 * Clavicle", "Bip001 * UpperArm", "Bip001 * Forearm", "Bip001 * Hand",
                  "Bip001 * Thigh", "Bip001 * Calf", "Bip001 * Foot", "Bip001 * Toe0"},
                 "L",
                 "R",
                 "biped"});
  all.push_back(
      {"xsens_mvn",
       {"Pelvis", "L5", "L3", "T8", "Neck", "Head"},
       {"*Shoulder", "*UpperArm", "*ForeArm", "*Hand", "*UpperLeg", "*LowerLeg", "*Foot", "*Toe"},
       "Left",
       "Right",
       "xsens_mvn"});
  return all;
}

INSTANTIATE_TEST_SUITE_P(Kinds, NamesOfScenesTest, testing::ValuesIn(namings()));

}  // namespace
}  // namespace retarget
