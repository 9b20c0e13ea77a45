
#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "edit/ground_pose.h"
#include "edit/plant_feet.h"
#include "edit_sample.h"
#include "retarget/edit.h"
#include "support/shared_data.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using namespace edit_test;

// Both clips have a root above the hips, which each clip may move differently.
TEST(Concatenation, JointsAboveTheHipsMayDiffer) {
  const EditSample& plain = data_sample("walk");
  std::vector<Joint> joints = plain.clip.skeleton().joints();
  Joint root = joints[0];
  root.name = "Reference";
  root.offset.setZero();
  for (Joint& joint : joints) ++joint.parent;
  joints.insert(joints.begin(), root);
  const auto skeleton = std::make_shared<const Skeleton>(joints);
  // The same motion, of which the root takes this share.
  const auto with_root = [&](const Clip& clip, const Pose& world_from_root) {
    Clip result(skeleton, clip.rate(), clip.frame_count());
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      std::ranges::copy(clip.rotations(frame), result.rotations(frame).begin() + 1);
      std::ranges::copy(clip.translations(frame), result.translations(frame).begin() + 1);
      const Pose hips =
          world_from_root.inverse() * Pose{clip.rotations(frame)[0], clip.translations(frame)[0]};
      result.rotations(frame)[0] = world_from_root.rotation;
      result.translations(frame)[0] = world_from_root.translation;
      result.rotations(frame)[1] = hips.rotation;
      result.translations(frame)[1] = hips.translation;
    }
    return result;
  };
  const Pose turned{Eigen::Quaterniond(Eigen::AngleAxisd(2.5, Eigen::Vector3d::UnitY())),
                    {120.0, 0.0, -300.0}};
  const Clip a = cut(plain.clip, 0, 160), b = cut(data_sample("wave").clip, 0, 120);
  const EditSample rooted(with_root(plain.clip, {}));
  for (const SeamBlend blend : {SeamBlend::kCrossfade, SeamBlend::kInertial}) {
    ConcatenateOptions options;
    options.blend = blend;
    const auto wanted = concatenate(a, b, plain.calibration, options, "a", "b");
    const auto joined =
        concatenate(with_root(a, {}), with_root(b, turned), rooted.calibration, options, "a", "b");
    ASSERT_TRUE(wanted && joined);
    EXPECT_EQ(joined->seam.a_frame, wanted->seam.a_frame);
    const HumanClip is = rooted.human_of(joined->clip), as = plain.human_of(wanted->clip);
    ASSERT_EQ(is.frame_count, as.frame_count);
    for (int frame = 0; frame < is.frame_count; ++frame) {
      for (const Bone bone : kMappedBones) {
        ASSERT_LT((is.frame(frame)[bone].translation - as.frame(frame)[bone].translation).norm(),
                  1e-6)
            << frame;
      }
    }
  }
}

TEST(Concatenation, KeepsMostOfBothClips) {
  // A clip matches itself best where no frames remain.
  const EditSample& walk = data_sample("walk");
  ConcatenateOptions options;
  options.seam.search_all = true;
  options.seam.cost_of_second = 0.001;
  const auto twice =
      value_of(concatenate(walk.clip, walk.clip, walk.calibration, options, "a", "b"));
  EXPECT_GT(twice.clip.frame_count(), 400);
}

TEST(Concatenation, FrameCountIsCorrect) {
  const EditSample &walk = data_sample("walk"), &wave = data_sample("wave");
  const auto joined =
      value_of(concatenate(walk.clip, wave.clip, walk.calibration, {}, "walk", "wave"));
  const Seam& seam = joined.seam;
  EXPECT_EQ(joined.clip.frame_count(), seam.a_frame + wave.clip.frame_count() - seam.b_frame);
  EXPECT_TRUE(joined.check.faults.empty());
  EXPECT_TRUE(seam.same_support);
  // Before and after the seam, the clips are unchanged.
  EXPECT_LT(largest_distance(cut(joined.clip, 0, seam.a_frame - 15),
                             cut(walk.clip, 0, seam.a_frame - 15), 0.01),
            1e-12);
  EXPECT_LT(largest_distance(through_bvh(joined.clip), joined.clip, 0.01), 1e-7);
  EXPECT_LT(joined.check.slip, 0.05);
  EXPECT_TRUE(format_pgm(joined.map).starts_with("P5\n61 61\n255\n"));
}

TEST(Concatenation, InertialSeamsAreSmooth) {
  const EditSample &walk = data_sample("walk"), &turn = data_sample("turn_in_place");
  ConcatenateOptions options;
  options.blend = SeamBlend::kInertial;
  const auto joined =
      value_of(concatenate(cut(walk.clip, 0, 160), turn.clip, walk.calibration, options, "a", "b"));
  // m per frame^2; a jump of a few centimetres would double it
  const auto largest_bend = [](const HumanClip& human, int begin, int end) {
    double largest = 0.0;
    for (int frame = begin; frame < end; ++frame) {
      for (const Bone bone : kMappedBones) {
        const auto at = [&](int f) { return human.frame(f)[bone].translation; };
        largest = std::max(largest, (at(frame + 1) - 2.0 * at(frame) + at(frame - 1)).norm());
      }
    }
    return largest;
  };
  const int seam = joined.seam.a_frame;
  EXPECT_LT(largest_bend(walk.human_of(joined.clip), seam - 2, seam + 12),
            1.2 * largest_bend(walk.human(), 1, 300));
}

TEST(Concatenation, ReportsMisfits) {
  // From walking to lying on the floor.
  const EditSample &walk = data_sample("walk"), &up = data_sample("get_up");
  ConcatenateOptions options;
  options.seam.band = options.widest_band = 0.5;
  const auto joined =
      value_of(concatenate(walk.clip, up.clip, walk.calibration, options, "walk.bvh", "up.bvh"));
  EXPECT_EQ(joined.band, 0.5);
  ASSERT_FALSE(joined.check.faults.empty());
  EXPECT_THAT(joined.check.faults[0], testing::HasSubstr("cm apart"));
  EXPECT_TRUE(format_bvh(joined.clip));
}

// A beginning without a good seam is skipped: the search range grows until a seam is good.
TEST(Concatenation, WidensTheSearchForAGoodSeam) {
  const EditSample &walk = data_sample("walk"), &up = data_sample("get_up");
  const ConcatenateOptions options;
  const auto joined =
      value_of(concatenate(walk.clip, up.clip, walk.calibration, options, "walk.bvh", "up.bvh"));
  EXPECT_THAT(joined.check.faults, testing::IsEmpty());
  EXPECT_GT(joined.band, 2.0);
  EXPECT_GT(joined.seam.b_frame, 60);
}

// The end of getting up does not fit its beginning. The same frame of both clips fits, but leaves
// one clip.
TEST(Concatenation, DoesNotDropAWholeClip) {
  const EditSample& up = data_sample("get_up");
  const auto twice = value_of(concatenate(up.clip, up.clip, up.calibration, {}, "a", "b"));
  EXPECT_GE(twice.clip.frame_count(), up.clip.frame_count() + up.clip.frame_count() / 10);
  ASSERT_FALSE(twice.doubts.empty());
  EXPECT_THAT(twice.doubts.front().message, testing::HasSubstr("of the 286 frames of the"));
}

// A short clip joins a long one at the end of the long one's T-pose, which is longer than the short
// clip.
TEST(Concatenation, DropsALongLeadInBehindAShortClip) {
  const EditSample &walk = data_sample("walk"), &turn = data_sample("turn_in_place");
  constexpr int kLeadIn = 150;
  Clip late = turn.clip;
  late.resize(kLeadIn + turn.clip.frame_count());
  Clip t_pose = turn.clip;
  for (Eigen::Quaterniond& rotation : t_pose.rotations(0)) rotation.setIdentity();
  for (int frame = 0; frame < kLeadIn; ++frame) copy_frame(t_pose, 0, late, frame);
  for (int frame = 0; frame < turn.clip.frame_count(); ++frame) {
    copy_frame(turn.clip, frame, late, kLeadIn + frame);
  }
  const auto joined =
      value_of(concatenate(cut(walk.clip, 0, 60), late, walk.calibration, {}, "walk", "turn"));
  EXPECT_THAT(joined.check.faults, testing::IsEmpty());
  EXPECT_GE(joined.seam.b_frame, kLeadIn);
}

Clip raised(const EditSample& sample, Clip clip, double height) {
  BodyMover::of(clip, sample.calibration)
      .value()
      .move_all(clip, {Eigen::Quaterniond::Identity(), {0.0, 0.0, height}});
  return clip;
}

// An edited clip counts as the same motion.
TEST(Concatenation, AClipIsNotJoinedToItsCopyAtTheSameMoment) {
  const EditSample& up = data_sample("get_up");
  const int frames = up.clip.frame_count();
  for (const auto& [a, b] : {std::pair(up.clip, cut(up.clip, 30, frames)),
                             std::pair(cut(up.clip, 30, frames), cut(up.clip, 0, frames - 30))}) {
    ConcatenateOptions options;
    options.seam.search_all = true;
    options.seam.max_seams = 1;
    const auto joined =
        value_of(concatenate(a, raised(up, b, 0.01), up.calibration, options, "a", "b"));
    const int shorter = std::min(a.frame_count(), b.frame_count());
    EXPECT_GE(joined.clip.frame_count(), std::max(a.frame_count(), b.frame_count()) + shorter / 10);
  }
}

TEST(Concatenation, DropsSharedFramesWithoutADoubt) {
  const EditSample& walk = data_sample("walk");
  const auto joined = value_of(
      concatenate(cut(walk.clip, 0, 200), cut(walk.clip, 50, 300), walk.calibration, {}, "a", "b"));
  EXPECT_EQ(joined.clip.frame_count(), 300);
  EXPECT_THAT(joined.doubts, testing::IsEmpty());
}

TEST(Concatenation, AlignsFloors) {
  const EditSample& sample = data_sample("walk");
  const Clip a = cut(sample.clip, 0, 160);
  const Clip b = raised(sample, cut(sample.clip, 150, 301), 0.9);
  for (const SeamBlend blend : {SeamBlend::kCrossfade, SeamBlend::kInertial}) {
    ConcatenateOptions options;
    options.blend = blend;
    const auto joined = value_of(concatenate(a, b, sample.calibration, options, "a", "b"));
    EXPECT_NEAR(joined.lift, -0.9, 0.002);
    EXPECT_LT(largest_distance(joined.clip, sample.clip, 0.01), 0.005);
  }
}

// A rising clip is not lowered again at the cut.
TEST(Concatenation, CutStairClipIsRejoinedUnchanged) {
  const EditSample& sample = data_sample("walk");
  Clip climbing = sample.clip;
  const auto mover = BodyMover::of(climbing, sample.calibration).value();
  for (int frame = 160; frame < climbing.frame_count(); ++frame) {
    const double height = std::min(0.5, 0.01 * (frame - 160));
    mover.move(climbing, frame, {Eigen::Quaterniond::Identity(), {0.0, 0.0, height}});
  }
  const auto joined = value_of(concatenate(cut(climbing, 0, 160), cut(climbing, 150, 301),
                                           sample.calibration, {}, "a", "b"));
  EXPECT_EQ(joined.lift, 0.0);
  EXPECT_LT(largest_distance(joined.clip, climbing, 0.01), 1e-6);
}

// Nearly equal floors and differently standing feet: height and tilt blend smoothly.
TEST(Concatenation, FootPlantedInBothClipsDoesNotJump) {
  const EditSample& sample = data_sample("walk");
  const Clip a = cut(sample.clip, 0, 160);
  const Clip b = raised(sample, cut(sample.clip, 150, 301), 0.015);
  const auto legs = find_legs(sample.clip.skeleton(), sample.calibration);
  for (const SeamBlend blend : {SeamBlend::kCrossfade, SeamBlend::kInertial}) {
    ConcatenateOptions options;
    options.blend = blend;
    const auto joined = value_of(concatenate(a, b, sample.calibration, options, "a", "b"));
    EXPECT_EQ(joined.lift, 0.0);
    EXPECT_LT(joined.check.jump, 0.1);
    // Within one frame, 1.5 cm would be 0.45 m/s.
    for (int foot = 0; foot < 2; ++foot) {
      const auto ankles = ankle_poses(joined.clip, sample.calibration, *legs[foot]);
      const auto own = ankle_poses(sample.clip, sample.calibration, *legs[foot]);
      for (std::size_t i = 145; i < 165; ++i) {
        const double rise = ankles[i + 1].translation.z() - ankles[i].translation.z();
        const double own_rise = own[i + 1].translation.z() - own[i].translation.z();
        EXPECT_LT(std::abs(rise - own_rise), 0.004) << i;
      }
    }
    // A foot that does jump is detected.
    options.fade = options.seam.window = 0.01;
    options.seam.max_seams = 1;
    const auto jumping =
        value_of(concatenate(a, raised(sample, b, 0.004), sample.calibration, options, "a", "b"));
    EXPECT_THAT(jumping.check.faults, testing::Contains(testing::HasSubstr("jumps")));
  }
}

// An arm changes position between two frames: no faster than arms swing, but instantly.
TEST(Concatenation, ReportsJolts) {
  const EditSample& sample = data_sample("walk");
  Clip b = cut(sample.clip, 150, 301);
  const int arm = sample.map.joint(Bone::kLeftArm);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.12, Eigen::Vector3d::UnitZ()));
  for (int frame = 0; frame < b.frame_count(); ++frame) {
    b.rotations(frame)[arm] = b.rotations(frame)[arm] * turn;
  }
  ConcatenateOptions options;
  options.seam.max_seams = 1;
  options.seam.band = options.widest_band = 0.3;
  const Clip a = cut(sample.clip, 0, 160);
  const auto smooth = value_of(concatenate(a, b, sample.calibration, options, "a", "b"));
  EXPECT_THAT(smooth.check.faults, testing::IsEmpty());
  options.fade = options.seam.window = 0.01;
  const auto jolted = value_of(concatenate(a, b, sample.calibration, options, "a", "b"));
  EXPECT_LT(jolted.check.largest_speed, 3.0 * jolted.check.usual_speed);
  EXPECT_GT(jolted.check.largest_acceleration, 3.0 * jolted.check.usual_acceleration);
  EXPECT_THAT(jolted.check.faults, testing::ElementsAre(testing::HasSubstr("accelerates")));
}

TEST(Concatenation, HandlesShortClips) {
  const EditSample& walk = data_sample("walk");
  const Clip none = cut(walk.clip, 0, 0), one = cut(walk.clip, 0, 1);
  EXPECT_FALSE(concatenate(none, walk.clip, walk.calibration, {}, "a", "b"));
  EXPECT_FALSE(concatenate(walk.clip, none, walk.calibration, {}, "a", "b"));
  const auto single = value_of(concatenate(one, one, walk.calibration, {}, "a", "b"));
  EXPECT_EQ(single.clip.frame_count(), 1);
  const auto begun = value_of(concatenate(one, walk.clip, walk.calibration, {}, "a", "b"));
  EXPECT_LT(largest_distance(begun.clip, walk.clip, 0.01), 1e-6);
  Clip faster = walk.clip;
  faster.set_rate({60, 1});
  EXPECT_FALSE(concatenate(walk.clip, faster, walk.calibration, {}, "a", "b"));
  ConcatenateOptions all;
  all.seam.search_all = true;
  EXPECT_TRUE(concatenate(walk.clip, walk.clip, walk.calibration, all, "a", "b"));
}

// The walk's skeleton with rotated joint axes and other channels.
TransferTarget turned_axes() {
  const EditSample& walk = data_sample("walk");
  const Eigen::Quaterniond axes(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  std::vector<Joint> joints = walk.clip.skeleton().joints();
  for (Joint& joint : joints) {
    joint.offset = axes * joint.offset;
    for (Eigen::Vector3d& end : joint.end_sites) end = axes * end;
    if (joint.parent < 0) continue;
    joint.channels = {Channel::kXRotation, Channel::kZRotation, Channel::kYRotation};
  }
  TransferTarget target{std::make_shared<const Skeleton>(joints), walk.map, walk.calibration};
  for (BoneSource& bone : target.calibration.bones) {
    if (bone.rotation_joint >= 0) bone.joint_from_bone = axes;
  }
  return target;
}

// Editing and transfer commute for equal proportions.
TEST(EditsAndTransfer, Commute) {
  const EditSample& walk = data_sample("walk");
  const TransferTarget other = turned_axes();
  const auto transferred = [&](const Clip& clip) {
    return transfer(clip, walk.calibration, other);
  };
  const GroundPath circle =
      circle_path(fit_path(walk.clip, walk.calibration)->path.at(0.0), 3.0, 7.0);
  const Clip& waving = data_sample("wave").clip;
  using EditOf = std::function<Clip(const Clip&, const Calibration&)>;
  const std::vector<std::pair<const char*, EditOf>> edits = {
      {"mirror", [](const Clip& clip,
                    const Calibration& calibration) { return mirror(clip, calibration).value(); }},
      {"path",
       [&](const Clip& clip, const Calibration& calibration) {
         return follow_path(clip, calibration, circle, {}).value().clip;
       }},
      {"concatenate",
       [&](const Clip& clip, const Calibration& calibration) {
         const bool own = clip.skeleton().joint(1).channels[0] == Channel::kZRotation;
         const Clip next = own ? waving : transferred(waving);
         return concatenate(clip, next, calibration, {}, "a", "b").value().clip;
       }},
  };
  for (const auto& [name, edit] : edits) {
    const Clip one = transferred(edit(walk.clip, walk.calibration));
    const Clip two = edit(transferred(walk.clip), other.calibration);
    EXPECT_LT(largest_distance(one, two, other.calibration.metres_per_unit), 1e-6) << name;
  }
}

// Recorded motions: a walk continues with pushes and with a dance.
TEST(Concatenation, RecordedClipsPassTheSeamChecks) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  const auto load = [&](const std::string& name) {
    return load_bvh((*shared / "data/lafan1" / (name + ".bvh")).string()).value().clip;
  };
  const EditSample walk(cut(load("walk4_subject1"), 0, 600));
  for (const char* name : {"push1_subject2", "dance1_subject2"}) {
    const EditSample next(cut(load(name), 0, 400));
    const Clip same_body = transfer(next.clip, next.calibration, walk.as_target());
    // Both begin with seconds of a T-pose, which does not continue any walk.
    const auto joined =
        value_of(concatenate(walk.clip, same_body, walk.calibration, {}, "walk4", name));
    EXPECT_TRUE(joined.check.faults.empty());
    EXPECT_LT(joined.check.largest_speed, 3.0 * joined.check.usual_speed);
    EXPECT_LT(joined.check.slip, 0.1);
    EXPECT_LT(joined.check.jump, 0.5);
    EXPECT_GT(joined.band, 2.0);
  }
}

}  // namespace
}  // namespace retarget
