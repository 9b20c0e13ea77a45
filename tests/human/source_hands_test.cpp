// Fingers are found with any names, even meaningless ones, and their lines are equal for both hands
// and any wrist rotation.

#include "human/skeleton/source_hands.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "support/finger_clip.h"

namespace retarget {
namespace {

std::string of(const std::array<const char*, 5>& names, Finger finger) {
  return names[static_cast<std::size_t>(finger)];
}

struct NamingCase {
  const char* kind;
  FingerNaming name;
};

const std::vector<NamingCase>& hand_namings() {
  static const std::vector<NamingCase> kCases = {
      {"mixamo", mixamo_name},
      {"smplx",
       [](int side, Finger f, int bone) {
         return (side == 0 ? "left_" : "right_") +
                of({"thumb", "index", "middle", "ring", "pinky"}, f) + std::to_string(bone);
       }},
      {"unreal",
       [](int side, Finger f, int bone) {
         return of({"thumb", "index", "middle", "ring", "pinky"}, f) + "_0" + std::to_string(bone) +
                (side == 0 ? "_l" : "_r");
       }},
      {"vrm",
       [](int side, Finger f, int bone) {
         constexpr std::array kBones = {"Proximal", "Intermediate", "Distal"};
         return (side == 0 ? "left" : "right") +
                of({"Thumb", "Index", "Middle", "Ring", "Little"}, f) +
                kBones[static_cast<std::size_t>(bone - 1)];
       }},
      {"unity",
       [](int side, Finger f, int bone) {
         constexpr std::array kBones = {" Proximal", " Intermediate", " Distal"};
         return (side == 0 ? "Left " : "Right ") +
                of({"Thumb", "Index", "Middle", "Ring", "Little"}, f) +
                kBones[static_cast<std::size_t>(bone - 1)];
       }},
      {"biped",
       [](int side, Finger f, int bone) {
         const std::string more = bone == 1 ? "" : std::to_string(bone - 1);
         return std::string("Bip01 ") + (side == 0 ? "L" : "R") + " Finger" +
                std::to_string(static_cast<int>(f)) + more;
       }},
      {"move",
       [](int side, Finger f, int bone) {
         constexpr std::array kBones = {"Proximal", "Medial", "Distal"};
         return std::string(side == 0 ? "Left" : "Right") + "Finger" +
                std::to_string(static_cast<int>(f) + 1) +
                kBones[static_cast<std::size_t>(bone - 1)];
       }},
      {"daz",
       [](int side, Finger f, int bone) {
         return (side == 0 ? "l" : "r") + of({"Thumb", "Index", "Mid", "Ring", "Pinky"}, f) +
                std::to_string(bone);
       }},
      {"mmd",
       [](int side, Finger f, int bone) {
         return (side == 0 ? "左" : "右") + of({"親指", "人指", "中指", "薬指", "小指"}, f) +
                std::to_string(bone);
       }},
      {"nameless", [](int side, Finger f, int bone) {
         return "b" + std::to_string(side * 50 + static_cast<int>(f) * 7 + bone);
       }}};
  return kCases;
}

TEST(SourceHandsTest, FingersAreFoundByAnyNames) {
  for (const auto& [kind, name] : hand_namings()) {
    const FingerClip source(1, name);
    const SourceHands hands = source.hands();
    for (std::size_t side = 0; side < 2; ++side) {
      ASSERT_TRUE(hands[side]) << kind;
      ASSERT_EQ(hands[side]->fingers.size(), kFingerCount) << kind;
      for (const Finger finger : kFingers) {
        const SourceFinger& found = hands[side]->fingers[static_cast<std::size_t>(finger)];
        EXPECT_EQ(found.finger, finger) << kind;
        ASSERT_EQ(found.joints.size(), 3U) << kind;
        EXPECT_EQ(source.clip().skeleton().joint(found.joints[0]).name,
                  name(static_cast<int>(side), finger, 1));
      }
    }
  }
}

TEST(SourceHandsTest, FindsNoHandsWithoutFingers) {
  const Skeleton bare({{"Hips", -1, {0, 0, 0}, {}, {}},
                       {"LeftHand", 0, {60, 0, 0}, {}, {}},
                       {"LeftFingerBase", 1, {8, 0, 0}, {}, {}},
                       {"LeftHandIndex1", 2, {3, 0, 0}, {}, {}},
                       {"LThumb", 1, {3, 0, 3}, {}, {}}});
  BoneMap map;
  map.joint_of_bone[Bone::kLeftHand] = 1;
  const SourceHands hands = find_source_hands(bare, map);
  EXPECT_FALSE(hands[0]) << "a mitten and a thumb of one bone each";
  EXPECT_FALSE(hands[1]);
}

TEST(SourceHandsTest, ExcludesMetacarpalsFromFingers) {
  const FingerClip plain(1);
  std::vector<Joint> joints = plain.clip().skeleton().joints();
  // A joint near the wrist in front of each finger except the thumb.
  std::vector<Joint> longer;
  std::vector<int> place;
  for (const Joint& joint : joints) {
    Joint moved = joint;
    if (joint.parent >= 0) moved.parent = place[static_cast<std::size_t>(joint.parent)];
    const bool knuckle = joint.name.ends_with("1") && joint.name.find("Thumb") == std::string::npos;
    if (knuckle) {
      const Joint metacarpal{joint.name.substr(0, joint.name.size() - 1) + "0",
                             moved.parent,
                             0.3 * joint.offset,
                             {},
                             {}};
      moved.parent = static_cast<int>(longer.size());
      moved.offset = 0.7 * joint.offset;
      longer.push_back(metacarpal);
    }
    place.push_back(static_cast<int>(longer.size()));
    longer.push_back(moved);
  }
  const Skeleton skeleton(longer);
  BoneMap map;
  map.joint_of_bone[Bone::kLeftHand] = *skeleton.find("LeftHand");
  const SourceHands hands = find_source_hands(skeleton, map);
  ASSERT_TRUE(hands[0]);
  for (const SourceFinger& finger : hands[0]->fingers) {
    EXPECT_TRUE(skeleton.joint(finger.joints.front()).name.ends_with("1"));
    EXPECT_EQ(finger.joints.size(), 3U);
  }
}

TEST(SourceHandsTest, LinesAreTheSameForBothHandsAndAnyWrist) {
  FingerClip source(1);
  for (std::size_t side = 0; side < 2; ++side) {
    source.bend(0, side, Finger::kIndex, {0.5, 0.3, 0.2});
  }
  Clip clip = source.clip();
  clip.rotations(0)[1] = Eigen::Quaterniond(0.4, 0.3, -0.5, 0.7).normalized();
  const SourceHands hands = source.hands();
  std::array<HandShape, 2> shapes;
  for (std::size_t side = 0; side < 2; ++side) {
    ASSERT_TRUE(HandPoser(clip, *hands[side]).shape(0, shapes[side]));
  }
  for (const Finger finger : kFingers) {
    const FingerLine& left = shapes[0].line(finger);
    const FingerLine& right = shapes[1].line(finger);
    ASSERT_EQ(left.point_count, 4);
    for (int i = 0; i < 4; ++i) EXPECT_LT((left.points[i] - right.points[i]).norm(), 1e-9);
  }
  const FingerLine& index = shapes[0].line(Finger::kIndex);
  EXPECT_NEAR(index.length, 8.3, 1e-9);
  EXPECT_GT(index.tip().z(), index.points[0].z()) << "bent out of the palm";
  EXPECT_GT(index.tip().x(), index.points[0].x());
  EXPECT_GT(shapes[0].line(Finger::kThumb).tip().y(), index.points[0].y()) << "on the thumb's side";
  EXPECT_LT((index.at(0.0) - index.points[0]).norm(), 1e-12);
  EXPECT_LT((index.at(1.0) - index.tip()).norm(), 1e-12);
  EXPECT_LT((index.at(4.0 / 8.3) - index.points[1]).norm(), 1e-9);
}

TEST(SourceHandsTest, EstimatesMissingTipsAsNineTenthsOfTheLastBone) {
  const FingerClip source(1, mixamo_name, false);
  const SourceHands hands = source.hands();
  ASSERT_TRUE(hands[0]);
  EXPECT_LT((hands[0]->fingers[1].end - Eigen::Vector3d(0.9 * 2.3, 0, 0)).norm(), 1e-12);
}

TEST(SourceHandsTest, StillFingersDoNotCountAsMoving) {
  FingerClip source(3);
  const auto moves = [&](std::size_t side) {
    return fingers_move(source.clip(), *source.hands()[side], {0, 3});
  };
  EXPECT_FALSE(moves(0));
  source.bend(2, 0, Finger::kRing, {0.2, 0.0, 0.0});
  EXPECT_TRUE(moves(0));
  EXPECT_FALSE(moves(1));
  EXPECT_FALSE(fingers_move(source.clip(), *source.hands()[0], {0, 2}));
}

TEST(SourceHandsTest, ClosedHandsDifferFromDefaultPoses) {
  FingerClip source(1);
  const auto closed = [&] { return fingers_are_closed(source.clip(), *source.hands()[0], 0); };
  const auto posed = [&] { return fingers_leave_rest(source.clip(), *source.hands()[0], 0); };
  EXPECT_FALSE(closed());
  EXPECT_FALSE(posed());
  // The largest bends of SMPL's mean hand.
  for (const Finger finger : kFingers) source.bend(0, 0, finger, {0.80, 0.75, 0.42});
  EXPECT_FALSE(closed());
  EXPECT_TRUE(posed());
  // A last joint that only a fault of the file can bend so far.
  source.bend(0, 0, Finger::kIndex, {0.3, 0.3, 2.8});
  EXPECT_FALSE(closed());
  source.bend(0, 0, Finger::kRing, {1.0, 1.1, 0.6});
  EXPECT_TRUE(closed());
  EXPECT_FALSE(fingers_are_closed(source.clip(), *source.hands()[1], 0));
}

}  // namespace
}  // namespace retarget
