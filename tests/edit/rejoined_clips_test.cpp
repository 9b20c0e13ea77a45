// Clips that were cut in two, or share frames, are joined without a change.

#include <gmock/gmock.h>

#include <string>

#include "edit/ground_pose.h"
#include "edit_sample.h"
#include "retarget/edit.h"
#include "support/shared_data.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using namespace edit_test;

struct CutCase {
  const char* name;
  int begin_of_b, end_of_a;
};

// A clip is cut in two: with a common window, and with one common frame (end times are inclusive).
TEST(Concatenation, FindsTheCutOfAClip) {
  for (const CutCase& cut_case :
       {CutCase{"walk", 130, 140}, CutCase{"walk", 150, 151}, CutCase{"get_up", 100, 110},
        CutCase{"get_up", 120, 121}, CutCase{"squat", 60, 61}}) {
    const EditSample& sample = data_sample(cut_case.name);
    // Only a part, to save time.
    const Clip whole = cut(sample.clip, 0, std::min(sample.clip.frame_count(), 200));
    const Clip a = cut(whole, 0, cut_case.end_of_a);
    Clip b = cut(whole, cut_case.begin_of_b, whole.frame_count());
    // Another pose on the ground, so that the search has to find the alignment.
    const GroundPose away{{3.0, -4.0}, 1.3};
    BodyMover::of(b, sample.calibration).value().move_all(b, away.in_space());
    for (const SeamBlend blend : {SeamBlend::kCrossfade, SeamBlend::kInertial}) {
      ConcatenateOptions options;
      options.blend = blend;
      const auto joined = value_of(concatenate(a, b, sample.calibration, options, "a", "b"));
      EXPECT_EQ(joined.seam.a_frame, cut_case.begin_of_b) << cut_case.name;
      EXPECT_EQ(joined.seam.b_frame, 0) << cut_case.name;
      EXPECT_LT(joined.seam.distance, 0.01);
      EXPECT_LT(largest_distance(joined.clip, whole, 0.01), 1e-6) << cut_case.name;
    }
  }
}

// Excerpts may share more frames than the search range has; `search` limits it.
TEST(Concatenation, FindsLongOverlaps) {
  const EditSample& walk = data_sample("walk");
  const Clip a = cut(walk.clip, 0, 200);
  Clip b = cut(walk.clip, 100, 301);
  const GroundPose away{{3.0, -4.0}, 1.3};
  BodyMover::of(b, walk.calibration).value().move_all(b, away.in_space());
  const auto joined = value_of(concatenate(a, b, walk.calibration, {}, "a", "b"));
  EXPECT_EQ(joined.seam.a_frame, 100);
  EXPECT_EQ(joined.seam.b_frame, 0);
  EXPECT_LT(largest_distance(joined.clip, walk.clip, 0.01), 1e-6);
  ConcatenateOptions options;
  ASSERT_TRUE(options.search("1"));
  EXPECT_GE(concatenate(a, b, walk.calibration, options, "a", "b")->seam.a_frame, 169);
}

// Repetitions of a cycle are not excerpts of one clip: no more than one cycle is shared.
TEST(Concatenation, KeepsTheCyclesOfALoop) {
  const EditSample& walk = data_sample("walk");
  LoopOptions loop;
  loop.shortest = 0.9;
  loop.times = 5;
  const auto cycles = value_of(make_loop(cut(walk.clip, 100, 200), walk.calibration, loop));
  ASSERT_LT(cycles.cycle, 61);
  const auto joined =
      value_of(concatenate(cycles.clip, cycles.clip, walk.calibration, {}, "a", "b"));
  EXPECT_GE(joined.clip.frame_count(), 8 * cycles.cycle);
}

// Parts cut with `:150` and `150:` share no frame.
TEST(Concatenation, JoinsPartsWithoutSharedFrames) {
  for (const char* name : {"walk", "get_up", "squat"}) {
    const EditSample& sample = data_sample(name);
    const Clip& whole = sample.clip;
    const auto joined = value_of(concatenate(cut(whole, 0, 90), cut(whole, 90, whole.frame_count()),
                                             sample.calibration, {}, "a", "b"));
    EXPECT_EQ(joined.seam.overlap, 0);
    EXPECT_TRUE(joined.check.faults.empty());
    EXPECT_LT(largest_distance(joined.clip, whole, 0.01), 1e-12) << name;
  }
  // A clip with missing frames cannot continue the first one.
  const EditSample& walk = data_sample("walk");
  const auto later =
      concatenate(cut(walk.clip, 0, 150), cut(walk.clip, 153, 301), walk.calibration, {}, "a", "b");
  EXPECT_GT(later->seam.overlap, 0);
}

// A hand that jerks in the recording must not affect the choice of the seam.
TEST(Concatenation, IgnoresJoltsOfTheRecordingItself) {
  const EditSample& walk = data_sample("walk");
  Clip whole = walk.clip;
  const int arm = walk.map.joint(Bone::kLeftForeArm);
  constexpr int kJolt = 151;
  whole.rotations(kJolt)[arm] =
      whole.rotations(kJolt)[arm] * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ());
  const auto joined = value_of(concatenate(cut(whole, 0, kJolt - 1), cut(whole, kJolt - 1, 301),
                                           walk.calibration, {}, "a", "b"));
  EXPECT_EQ(joined.seam.overlap, 0);
  EXPECT_THAT(joined.check.faults, testing::IsEmpty());
  EXPECT_NE(joined.check.jolted_bone, "LeftHand");
  EXPECT_LT(largest_distance(joined.clip, whole, 0.01), 1e-12);
}

// Cuts at any position of recorded clips, with and without common frames.
TEST(Concatenation, FindsTheCutOfRecordedClips) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  for (const char* name : {"walk4_subject1", "dance1_subject2", "ground1_subject1"}) {
    const auto file = *shared / "data/lafan1" / (std::string(name) + ".bvh");
    const EditSample sample(load_bvh(file.string()).value().clip);
    constexpr int kLength = 60;
    for (int at = 400; at + kLength < sample.clip.frame_count(); at += 397) {
      const Clip whole = cut(sample.clip, at - kLength, at + kLength);
      for (const int common : {0, 1, 4, 10}) {
        const auto joined =
            value_of(concatenate(cut(whole, 0, kLength + common), cut(whole, kLength, 2 * kLength),
                                 sample.calibration, {}, "a", "b"));
        EXPECT_EQ(joined.seam.a_frame, kLength) << name << " " << at << " " << common;
        if (joined.clip.frame_count() != whole.frame_count()) continue;
        EXPECT_LT(largest_distance(joined.clip, whole, 0.01), 1e-6) << name << " " << at;
      }
    }
  }
}

}  // namespace
}  // namespace retarget
