// Decisions and reports of edits, apart from the motion.

#include <gmock/gmock.h>

#include "base/option_name.h"
#include "edit_sample.h"
#include "retarget/edit.h"

namespace retarget {
namespace {

using namespace edit_test;
using testing::HasSubstr;

Subject subject_of(const EditSample& sample) {
  return {sample.clip, sample.map, sample.calibration};
}

TEST(Parts, AreGivenByTimesOrFrames) {
  const Clip& walk = data_sample("walk").clip;
  EXPECT_EQ(trim(walk, {}).value().frame_count(), walk.frame_count());
  EXPECT_EQ(trim(walk, {.start_s = 2.0, .end_s = 4.0}).value().frame_count(), 61);
  EXPECT_EQ(trim(walk, {.frames = "10:40"}).value().frame_count(), 30);
  EXPECT_EQ(trim(walk, {.start_s = 2.0, .frames = "10:40"}).error().kind, ErrorKind::kUsage);
  EXPECT_EQ(trim(walk, {.start_s = 1000.0}).error().kind, ErrorKind::kUsage);
}

TEST(Parts, DropLeadInFrames) {
  const Clip& walk = data_sample("walk").clip;
  EXPECT_TRUE(cut_lead_in(walk).notes.empty());
  // The T-pose with zero rotations, then the walk.
  Clip led(walk.shared_skeleton(), walk.rate(), 2);
  led.resize(2 + walk.frame_count());
  for (int frame = 0; frame < walk.frame_count(); ++frame) copy_frame(walk, frame, led, frame + 2);
  const Edited begun = cut_lead_in(led);
  EXPECT_EQ(begun.clip.frame_count(), walk.frame_count());
  ASSERT_EQ(begun.notes.size(), 1u);
  EXPECT_THAT(begun.notes[0].text, HasSubstr(OPTION("start") " 0 keeps them"));
  EXPECT_THAT(cut_lead_in(led, false).notes[0].text, Not(HasSubstr(OPTION("start"))));
}

TEST(Places, ParseFromText) {
  EXPECT_EQ(way_from_text("-1.5,0.25").value(), Eigen::Vector2d(-1.5, 0.25));
  for (const char* wrong : {"", "1", "1,", "1,2,3", "1e300,0", "a,b"}) {
    EXPECT_EQ(way_from_text(wrong).error().kind, ErrorKind::kUsage) << wrong;
  }
}

TEST(Seams, AreSearchedAsRequested) {
  ConcatenateOptions options;
  ASSERT_TRUE(options.search(""));
  EXPECT_EQ(options.seam.band, 2.0);
  ASSERT_TRUE(options.search("0.5"));
  EXPECT_EQ(options.seam.band, 0.5);
  EXPECT_EQ(options.widest_band, 0.5);
  ASSERT_TRUE(options.search("all"));
  EXPECT_TRUE(options.seam.search_all);
  EXPECT_FALSE(options.search("never"));
  EXPECT_FALSE(options.search("-1"));
}

TEST(Seams, ReportTheReasonIfTheyAreBad) {
  const EditSample &walk = data_sample("walk"), &up = data_sample("get_up");
  const Loop loop = make_loop(up.clip, up.calibration, {}).value();
  ASSERT_TRUE(loop.misfit);
  EXPECT_EQ(loop.misfit->kind, ErrorKind::kRun);
  EXPECT_THAT(loop.misfit->message, HasSubstr("cm apart"));
  EXPECT_EQ(loop.doubts.size(), loop.check.faults.size());
  ConcatenateOptions strict;
  strict.threshold = 0.001;
  const auto joined =
      concatenate(walk.clip, up.clip, walk.calibration, strict, "walk", "up").value();
  ASSERT_TRUE(joined.misfit);
  EXPECT_EQ(joined.misfit->location.file, "up");
  EXPECT_THAT(joined.misfit->message, HasSubstr("does not fit walk"));
  const auto good =
      concatenate(cut(walk.clip, 0, 160), cut(walk.clip, 150, 301), walk.calibration, {}, "a", "b");
  EXPECT_FALSE(good.value().misfit);
}

TEST(Seams, RequireOneSkeletonAndRate) {
  const EditSample &walk = data_sample("walk"), &squat = data_sample("squat");
  EXPECT_TRUE(like_first(subject_of(squat), subject_of(walk)).value().notes.empty());
  const EditSample fast(change_timing(squat.clip, {.rate = FrameRate{60, 1}}).value());
  const Edited slowed = like_first(subject_of(fast), subject_of(walk)).value();
  EXPECT_TRUE(same_rate(slowed.clip.rate(), walk.clip.rate()));
  ASSERT_EQ(slowed.notes.size(), 1u);
  EXPECT_THAT(slowed.notes[0].text, HasSubstr("60 to 30"));
}

TEST(Transfers, ReportPlantedFeet) {
  const EditSample &walk = data_sample("walk"), &squat = data_sample("squat");
  const Transferred moved = transfer(subject_of(walk), subject_of(squat));
  EXPECT_TRUE(moved.left_out.empty());
  EXPECT_TRUE(moved.at_rest.empty());
  ASSERT_TRUE(moved.feet);
  EXPECT_THAT(moved.notes.back().text, HasSubstr("to stand"));
}

TEST(Paths, ChangeAsRequested) {
  const GroundPath own = line_path({}, 4.0);
  EXPECT_FALSE(PathChange().any());
  EXPECT_NEAR(change_path(own, {.scale = 2.0}).value().length(), 8.0, 1e-9);
  const GroundPose turned = change_path(own, {.degrees = 90.0}).value().at(1.0);
  EXPECT_LT((turned.position - Eigen::Vector2d(0.0, 1.0)).norm(), 1e-9);
  EXPECT_NEAR(change_path(own, {.to = "circle", .radius = -1.0})->length(), 4.0, 1e-3);
  EXPECT_EQ(change_path(own, {.radius = 0.001}).error().kind, ErrorKind::kUsage);
  EXPECT_FALSE(change_path(own, {.to = "no such file.json"}));
}

}  // namespace
}  // namespace retarget
