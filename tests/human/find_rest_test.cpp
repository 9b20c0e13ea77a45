// Comparison of rest poses with the evidence of the whole movement.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "formats/bvh/read_bvh.h"
#include "human/doubts.h"
#include "human/hand_made_maps.h"
#include "human/rest_twins.h"
#include "human/skeleton/calibrate.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"
#include "support/shared_data.h"
#include "support/value_of.h"
#include "support/with_joints.h"

namespace retarget {
namespace {

const std::vector<Bone> kLegBones = {Bone::kLeftUpLeg, Bone::kRightUpLeg, Bone::kLeftLeg,
                                     Bone::kRightLeg};
const std::vector<Bone> kFootBones = {Bone::kLeftFootMod, Bone::kRightFootMod};
const std::vector<Bone> kBodyBones = {Bone::kHips,        Bone::kSpine2,       Bone::kLeftUpLeg,
                                      Bone::kRightUpLeg,  Bone::kLeftLeg,      Bone::kRightLeg,
                                      Bone::kLeftFootMod, Bone::kRightFootMod, Bone::kLeftArm,
                                      Bone::kRightArm,    Bone::kLeftForeArm,  Bone::kRightForeArm};

Clip window_of(const std::string& name, int begin, int end) {
  return cut(recorded_clip(name), begin, end);
}

Calibration rest_found(const Clip& clip) {
  CalibrationOptions options;
  options.up = Eigen::Vector3d::UnitY();
  return value_of(calibrate(clip, lafan1_map(clip.skeleton(), "test"), options));
}

Clip with_axes_of_no_meaning(const Clip& clip) {
  std::srand(7);
  std::vector<Eigen::Quaterniond> turns;
  for (int i = 0; i < clip.skeleton().joint_count(); ++i) {
    turns.push_back(Eigen::Quaterniond::UnitRandom());
  }
  return with_other_axes(clip, turns);
}

// No frame is upright, and no foot stands: the lower trunk and the knees show the body structure.
TEST(RestEvidence, LearnsLyingBodiesFromTheirStructure) {
  for (const auto& [begin, end] : {std::pair(0, 30), std::pair(0, 60), std::pair(120, 150)}) {
    SCOPED_TRACE(begin);
    const Clip clip = window_of("get_up", begin, end);
    const Calibration found = rest_found(with_axes_of_no_meaning(clip));
    EXPECT_EQ(found.rest_pose, "learned");
    const HumanClip human = to_human(with_axes_of_no_meaning(clip), found);
    const HumanClip expected = lafan1_human(clip);
    EXPECT_LT(mean_turn(human, expected, kBodyBones), 9.0);
    EXPECT_LT(mean_turn(human, expected, {Bone::kHips}), 20.0);
    EXPECT_LT(mean_turn(human, expected, kFootBones), 15.0);
  }
}

TEST(RestEvidence, UsesASeatedZeroPoseThatFitsTheMovement) {
  ZeroShape seated;
  seated.thigh = seated.knee = 85.0;
  seated.arms_down = 70.0;
  seated.elbow = 40.0;
  const Clip clip = window_of("get_up", 0, 260);
  const Clip twin = with_zero_shape(clip, seated);
  const Calibration found = rest_found(twin);
  EXPECT_EQ(found.rest_pose, "zero pose");
  EXPECT_LT(mean_turn(to_human(twin, found), lafan1_human(clip), kBodyBones), 1.0);
  // The best candidate and its advantage.
  EXPECT_THAT(found.description,
              testing::ContainsRegex("T-pose from zero pose \\([0-9]+ degrees off a T-pose; "
                                     "expected error [0-9.]+ degrees; next best: axes learned "
                                     "from the movement, [0-9.]+ degrees\\)"));
}

// The movement decides whether the feet of a zero pose are level or square to the shins, and
// replaces feet that do not stand.
TEST(RestEvidence, FeetStandOnTheFloor) {
  std::vector<ZeroShape> shapes(4);
  shapes[0].astride = shapes[1].astride = 15.0;
  shapes[1].square_soles = true;
  shapes[2].thigh = 15.0;
  shapes[2].knee = 30.0;
  shapes[3].toes_down = 50.0;
  for (const char* name : {"walk", "wave", "turn_in_place"}) {
    const Clip clip = window_of(name, 0, 120);
    const HumanClip expected = lafan1_human(clip);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(i));
      const Clip twin = with_zero_shape(clip, shapes[i]);
      const Calibration found = rest_found(twin);
      EXPECT_EQ(found.rest_pose, "zero pose");
      EXPECT_LT(mean_turn(to_human(twin, found), expected, kFootBones), 8.0);
    }
  }
}

// The positions of the joints in a T-pose, in position channels, below OFFSETs of another pose.
TEST(RestEvidence, UsesConstantPositionsInsteadOfOffsets) {
  const Clip clip = with_zero_shape(window_of("wave", 0, 120), {});
  const Clip placed = with_position_channels(clip);
  std::vector<Joint> joints = placed.skeleton().joints();
  for (Joint& joint : joints) {
    if (joint.parent >= 0) joint.offset.setZero();
  }
  const Clip twin = with_joints(placed, joints);
  const Calibration found = rest_found(twin);
  EXPECT_EQ(found.rest_pose, "zero pose");
  EXPECT_LT(mean_turn(to_human(twin, found), to_human(clip, rest_found(clip)), kBodyBones), 1e-3);
}

// An exporter has turned the whole zero pose, and the motion with it.
TEST(RestEvidence, UsesAZeroPoseThatIsTurnedAsAWhole) {
  const Clip clip = with_zero_shape(window_of("wave", 0, 120), {});
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(0.25 * M_PI, Eigen::Vector3d(1.0, 0.0, 0.3).normalized()));
  std::vector<Eigen::Quaterniond> turns(static_cast<std::size_t>(clip.skeleton().joint_count()),
                                        turn);
  const Clip twin = with_other_axes(clip, turns);
  const Calibration found = rest_found(twin);
  EXPECT_EQ(found.rest_pose, "zero pose");
  EXPECT_LT(mean_turn(to_human(twin, found), to_human(clip, rest_found(clip)), kBodyBones), 3.0);
}

TEST(RestEvidence, RejectsAZeroPoseThatContradictsTheMovement) {
  ZeroShape crouch;
  crouch.lean = 30.0;
  crouch.thigh = 60.0;
  crouch.knee = 90.0;
  crouch.arms_down = 80.0;
  crouch.arms_ahead = 50.0;
  const Clip clip = window_of("squat", 0, 90);
  const Calibration found = rest_found(with_zero_shape(clip, crouch));
  EXPECT_EQ(found.rest_pose, "learned");
  EXPECT_FALSE(has_doubt(found, OPTION("rest")));
  EXPECT_THAT(found.description,
              testing::ContainsRegex("learned from the movement \\(expected error [0-9.]+ "
                                     "degrees; next best: [a-z0-9 ]+, [0-9.]+ degrees\\)"));
}

// A still body with straight limbs that leans forward, and a meaningless zero pose.
TEST(RestEvidence, WarnsAboutClipsWithLittleEvidence) {
  ZeroShape leaning;
  leaning.lean = 40.0;
  leaning.arms_down = 80.0;
  const Clip built = with_zero_shape(window_of("walk", 0, 1), leaning);
  const Clip clip(built.shared_skeleton(), built.rate(), 30);
  const Calibration found = rest_found(with_axes_of_no_meaning(clip));
  EXPECT_TRUE(has_doubt(found, OPTION("rest"))) << found.description;
}

TEST(RestEvidence, CleanStandingClipsCauseNoWarning) {
  for (const char* name : {"squat", "turn_in_place", "walk", "wave"}) {
    const Clip clip = window_of(name, 0, 60);
    EXPECT_TRUE(rest_found(clip).doubts.empty()) << name;
    EXPECT_TRUE(rest_found(with_zero_shape(clip, {})).doubts.empty()) << name;
  }
}

// Without hands, and with end sites at the elbows.
Clip with_forearms_without_length(const Clip& clip) {
  std::vector<Joint> joints;
  std::vector<std::size_t> kept;
  for (int i = 0; i < clip.skeleton().joint_count(); ++i) {
    Joint joint = clip.skeleton().joint(i);
    if (joint.name.ends_with("Hand")) continue;
    if (joint.name.ends_with("ForeArm")) joint.end_sites = {Eigen::Vector3d::Zero()};
    if (joint.parent >= 0) {
      const auto parent = std::ranges::find(kept, static_cast<std::size_t>(joint.parent));
      joint.parent = static_cast<int>(parent - kept.begin());
    }
    kept.push_back(static_cast<std::size_t>(i));
    joints.push_back(std::move(joint));
  }
  Clip twin(std::make_shared<const Skeleton>(joints), clip.rate(), clip.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (std::size_t i = 0; i < kept.size(); ++i) {
      twin.rotations(frame)[i] = clip.rotations(frame)[kept[i]];
    }
    twin.translations(frame)[0] = clip.translations(frame)[0];
  }
  return twin;
}

// Arms without evidence must not make a zero pose seem to fit whose bones are all along x.
TEST(RestEvidence, ArmsWithoutLengthAreNoEvidenceForAPose) {
  const Clip clip = window_of("walk", 0, 120);
  const Clip twin = with_forearms_without_length(clip);
  const Calibration found = rest_found(twin);
  EXPECT_EQ(found.rest_pose, "learned") << found.description;
  EXPECT_TRUE(has_doubt(found, "no length is known for LeftForeArm, RightForeArm"));
  const HumanClip human = to_human(twin, found), expected = lafan1_human(clip);
  EXPECT_LT(mean_turn(human, expected, kLegBones), 5.0);
  for (const Bone bone :
       {Bone::kLeftArm, Bone::kRightArm, Bone::kLeftForeArm, Bone::kRightForeArm}) {
    const Eigen::Vector3d way = human.frame(60)[bone].rotation * Eigen::Vector3d::UnitX();
    const Eigen::Vector3d true_way = expected.frame(60)[bone].rotation * Eigen::Vector3d::UnitX();
    EXPECT_GT(way.dot(true_way), 0.99) << bone_name(bone);
  }
  const auto place = [&](Bone bone) { return human.frame(60)[bone].translation; };
  EXPECT_GT((place(Bone::kLeftHand) - place(Bone::kLeftForeArm)).norm(), 0.15);
}

TEST(RestEvidence, ForearmsWithALengthAreNoDoubt) {
  for (const Warning& doubt : rest_found(window_of("walk", 0, 120)).doubts) {
    EXPECT_EQ(doubt.message.find("no length is known"), std::string::npos) << doubt.message;
  }
}

// Rotations made for another skeleton: legs have the right directions but bend about another axis
// than the zero pose implies.
TEST(RestEvidence, LearnsKneesThatBendAboutAnotherAxis) {
  for (const char* name : {"get_up", "squat", "walk"}) {
    const Clip clip = window_of(name, 0, 90);
    const Clip twin = with_zero_shape(clip, {}, 50.0);
    const Calibration found = rest_found(twin);
    EXPECT_EQ(found.rest_pose, "zero pose");
    EXPECT_LT(mean_turn(to_human(twin, found), lafan1_human(clip), kLegBones), 5.0) << name;
  }
}

// Crawling people never stand; learned axes were 30 degrees off.
TEST(RestEvidence, LearnsCrawlingPeople) {
  if (!shared_folder()) GTEST_SKIP() << kNoSharedFolder;
  const auto file = *shared_folder() / "data" / "lafan1" / "ground1_subject1.bvh";
  const Clip clip = load_bvh(file.string()).value().clip;
  double sum = 0.0;
  int count = 0;
  for (int begin = 400; begin + 90 <= clip.frame_count(); begin += 400) {
    const Clip window = cut(clip, begin, begin + 90);
    const Calibration found = rest_found(window);
    sum += mean_turn(to_human(window, found), lafan1_human(window), kBodyBones);
    ++count;
  }
  EXPECT_LT(sum / count, 10.0);
}

}  // namespace
}  // namespace retarget
