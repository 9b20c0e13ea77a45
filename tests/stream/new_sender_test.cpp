// Senders that replace others, without sockets.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "human/twins.h"
#include "live/stream/human_bones.h"
#include "live/stream/live_pipeline.h"
#include "live/stream/stream_formats.h"
#include "retarget/resample.h"
#include "stream/sent_stream.h"
#include "stream/stream_support.h"
#include "support/with_joints.h"

namespace retarget {
namespace {

// The same skeleton in another unit: the robot would leap by a hundred times the human's distance.
Clip in_millimetres(const Clip& clip) {
  return scaled_and_turned(clip, 10.0, Eigen::Quaterniond::Identity());
}

double farthest_root(const SentStream& run) {
  double farthest = 0.0;
  for (const SentFrame& frame : run.frames) {
    farthest = std::max({farthest, std::abs(frame.qpos[0]), std::abs(frame.qpos[1])});
  }
  return farthest;
}

TEST(NewSender, FramesWaitForItsSkeleton) {
  for (const char* format : {"lines", "bvh"}) {
    const Clip first = sample_clip("walk"), second = in_millimetres(first);
    SentStream run(LivePace::kClock,
                   format == std::string("bvh") ? "udp:1?format=bvh" : "udp:1?format=lines");
    const auto encoder = (*find_stream_format(format))->encoder();
    const auto other = (*find_stream_format(format))->encoder();
    const std::string header = other->begin(second);
    run.send(encoder->begin(first), 0.0);
    for (int i = 0; i < 60; ++i) run.send(encoder->frame(first, i).value(), i / 30.0);
    run.pipeline.restart_sender(3.0, true);
    for (int i = 0; i < 30; ++i) run.send(other->frame(second, i).value(), 3.0 + i / 30.0);
    EXPECT_EQ(run.pipeline.packets().foreign, 30) << format;
    EXPECT_EQ(run.pipeline.packets().malformed, 0) << format;
    EXPECT_NE(run.frames.back().state, LiveState::kFollowing) << format;
    EXPECT_TRUE(run.is_told("whose skeleton is missing")) << format;
    // Of its packets from before, the skeleton is used and the frame is not.
    const auto received = run.pipeline.statistics().received;
    for (std::string_view text = header; !text.empty();) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      ASSERT_TRUE(run.pipeline.take_early(text.substr(0, end), 4.0));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
    ASSERT_TRUE(run.pipeline.take_early(other->frame(second, 0).value(), 4.0));
    // Until its body is recognised, its frames cannot be read with the old one.
    run.send(other->frame(second, 0).value(), 4.05);
    EXPECT_EQ(run.pipeline.statistics().received, received) << format;
    run.pipeline.take_body(4.1);
    for (int i = 0; i < 90; ++i) run.send(other->frame(second, i).value(), 4.1 + i / 30.0);
    EXPECT_EQ(run.pipeline.packets().foreign, 30) << format;
    EXPECT_EQ(run.frames.back().state, LiveState::kFollowing) << format;
    EXPECT_LT(farthest_root(run), 5.0) << format;
  }
}

// The same motion with other joint axes, so that the zero pose is not human.
Clip with_other_axes(const Clip& clip) {
  std::vector<Eigen::Quaterniond> old_from_new;
  for (int j = 0; j < clip.skeleton().joint_count(); ++j) {
    const Eigen::Vector3d axis(1.0, 0.5 * (j % 3), -0.4);
    old_from_new.emplace_back(Eigen::AngleAxisd(0.3 + 0.7 * (j % 5), axis.normalized()));
  }
  Clip turned = with_other_axes(clip, old_from_new);
  turned.set_origin(clip.origin());
  return turned;
}

// The zero pose of a skeleton may be folded up: the first frame calibrates a body that replaces
// another, as it does the first body.
TEST(NewSender, IsCalibratedByItsFirstFrame) {
  const Clip before = sample_clip("walk");
  const Clip clip = with_other_axes(sample_clip("squat"));
  for (const auto& [pace, format] : {std::pair{LivePace::kClock, "bvh"},
                                     {LivePace::kInput, "bvh"},
                                     {LivePace::kInput, "lines"}}) {
    const std::string address = "stdin?format=" + std::string(format);
    SentStream alone(LivePace::kInput, address.c_str());
    SentStream after(pace, address.c_str());
    const auto first = (*find_stream_format(format))->encoder();
    const auto second = (*find_stream_format(format))->encoder();
    alone.send(second->begin(clip), 0.0);
    after.send(first->begin(before), 0.0);
    for (int i = 0; i < 60; ++i) after.send(first->frame(before, i).value(), i / 30.0);
    after.send(second->begin(clip), 2.0);
    for (int i = 0; i < clip.frame_count(); ++i) {
      alone.send(second->frame(clip, i).value(), i / 30.0);
      after.send(second->frame(clip, i).value(), 2.1 + i / 30.0);
      if (i == 5) after.pipeline.take_body(2.1 + i / 30.0);
    }
    alone.pipeline.finish(0.0);
    after.pipeline.finish(0.0);
    ASSERT_EQ(after.frames.back().state, LiveState::kFollowing);
    for (std::size_t j = 7; j < alone.frames.back().qpos.size(); ++j) {
      EXPECT_NEAR(after.frames.back().qpos[j], alone.frames.back().qpos[j], 0.02) << j;
    }
  }
}

// The same motion with one more joint, so that the frames of either body do not fit the other one.
Clip with_a_prop(const Clip& clip) {
  std::vector<Joint> joints = clip.skeleton().joints();
  joints.push_back({"Prop", 0, Eigen::Vector3d(0.1, 0.0, 0.0), {}, joints.back().channels});
  Clip made = with_joints(clip, joints);
  made.set_origin(clip.origin());
  return made;
}

// A stream of the walk whose skeleton changes to one with a prop after two seconds.
struct ChangedStream {
  explicit ChangedStream(const std::string& format, const Clip& next)
      : run(LivePace::kClock, ("udp:1?format=" + format).c_str()),
        old((*find_stream_format(format))->encoder()),
        changed((*find_stream_format(format))->encoder()) {
    run.send(old->begin(before), 0.0);
    for (int i = 0; i < 60; ++i) run.send(old->frame(before, i).value(), i / 30.0);
    run.send(changed->begin(next), 2.0);
  }

  Clip before = sample_clip("walk");
  SentStream run;
  std::unique_ptr<Encoder> old, changed;
};

TEST(NewSender, IsNotRejectedByLatePacketsOfTheOldBody) {
  const Clip next = with_a_prop(sample_clip("walk"));
  for (const char* format : {"lines", "bvh"}) {
    ChangedStream stream(format, next);
    SentStream& run = stream.run;
    run.send(stream.old->frame(stream.before, 60).value(), 2.0);
    run.send(stream.old->frame(stream.before, 61).value(), 2.0);
    EXPECT_EQ(run.pipeline.statistics().received, 62) << format;
    run.send(stream.changed->frame(next, 62).value(), 2.01);
    run.pipeline.take_body(2.02);
    for (int i = 63; i < 120; ++i) run.send(stream.changed->frame(next, i).value(), i / 30.0);
    EXPECT_EQ(run.pipeline.packets().refused_skeletons, 0) << format << run.told;
    EXPECT_EQ(run.pipeline.packets().malformed, 0) << format << run.told;
    EXPECT_EQ(run.pipeline.statistics().received, 62 + 57) << format;
    EXPECT_EQ(run.frames.back().state, LiveState::kFollowing) << format;
  }
}

// Nothing judged the skeleton, so it may be sent again.
TEST(NewSender, MaySendItsSkeletonAgainAfterFramesOfTheOldBody) {
  const Clip next = with_a_prop(sample_clip("walk"));
  for (const char* format : {"lines", "bvh"}) {
    ChangedStream stream(format, next);
    SentStream& run = stream.run;
    for (int i = 60; i < 75; ++i) run.send(stream.old->frame(stream.before, i).value(), i / 30.0);
    EXPECT_EQ(run.pipeline.statistics().received, 75) << format;
    EXPECT_EQ(run.pipeline.packets().refused_skeletons, 1) << format;
    EXPECT_TRUE(run.is_told("frames are still those of the body in use")) << format;
    run.send(stream.changed->begin(next), 3.0);
    run.send(stream.changed->frame(next, 90).value(), 3.0);
    run.pipeline.take_body(3.02);
    for (int i = 91; i < 120; ++i) run.send(stream.changed->frame(next, i).value(), i / 30.0);
    EXPECT_EQ(run.pipeline.packets().refused_skeletons, 1) << format;
    EXPECT_EQ(run.pipeline.packets().malformed, 0) << format << run.told;
    EXPECT_EQ(run.pipeline.statistics().received, 75 + 29) << format;
  }
}

// Counts the skeletons that it gives.
class CountingDecoder final : public Decoder, private StreamSink {
 public:
  explicit CountingDecoder(int& skeletons) : skeletons_(skeletons) {}
  Result<void> take(std::string_view bytes, StreamSink& sink) override {
    sink_ = &sink;
    return lines_->take(bytes, *this);
  }

 private:
  void take_skeleton(Clip clip, bool has_rest) override {
    ++skeletons_;
    sink_->take_skeleton(std::move(clip), has_rest);
  }
  void take_frame(const StreamFrame& frame) override { sink_->take_frame(frame); }

  int& skeletons_;
  StreamSink* sink_ = nullptr;
  std::unique_ptr<Decoder> lines_ = stream_decoder("lines");
};

// While a skeleton has no pose, the decoder reads both skeletons again to try packets.
TEST(NewSender, MalformedPacketsReadSkeletonsAgainAFewTimesPerSecond) {
  int skeletons = 0;
  const Clip clip = sample_clip("walk"), next = with_a_prop(clip);
  LivePipeline pipeline(
      set_up_robot(streamed_g1(), {}).value(), SentStream::options(LivePace::kClock),
      std::make_unique<CountingDecoder>(skeletons), [](const RobotFrame&) {},
      [](std::string_view, std::string_view) {});
  const auto encoder = stream_encoder("lines");
  ASSERT_TRUE(pipeline.packet(encoder->begin(clip), 0.0));
  ASSERT_TRUE(pipeline.packet(encoder->frame(clip, 0).value(), 0.0));
  ASSERT_TRUE(pipeline.packet(encoder->begin(next), 0.1));
  skeletons = 0;
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(pipeline.packet("{}", 0.1 + 0.01 * i));
  EXPECT_GT(skeletons, 0);
  EXPECT_LE(skeletons, 4 * 2 * 10);
}

TEST(NewSender, MayReplaceAnotherWithTheUsersSkeleton) {
  const Clip clip = sample_clip("walk");
  SentStream run(LivePace::kClock, "udp:1?format=bvh");
  ASSERT_TRUE(run.pipeline.know_skeleton(clip));
  const auto encoder = stream_encoder("bvh");
  EXPECT_FALSE(encoder->begin(clip).empty());
  run.send(encoder->frame(clip, 0).value(), 0.0);
  run.pipeline.restart_sender(2.0, true);
  run.send(encoder->frame(clip, 1).value(), 2.0);
  EXPECT_EQ(run.pipeline.packets().foreign, 0);
  EXPECT_EQ(run.pipeline.statistics().received, 2);
}

TEST(NewSender, MayHaveOtherJointsThanTheUsersSkeleton) {
  const Clip clip = sample_clip("walk");
  const Clip bones = clip_of_human_bones(clip, {}, RETARGET_SOURCE_DIR).value();
  for (const char* format : {"rokoko", "smplx", "xrobot", "lines", "bvh"}) {
    const std::string address = "stdin?format=" + std::string(format);
    const bool has_own_names = (*find_stream_format(format))->plays_human == nullptr;
    const Clip& sent = has_own_names ? clip : bones;
    SentStream run(LivePace::kInput, address.c_str());
    ASSERT_TRUE(run.pipeline.know_skeleton(clip));
    const auto encoder = (*find_stream_format(format))->encoder();
    run.send(encoder->begin(sent), 0.0);
    for (int i = 0; i < 60; ++i) run.send(encoder->frame(sent, i).value(), i / 30.0);
    run.pipeline.finish(2.0);
    EXPECT_GT(run.frames.size(), 90U) << format;
    EXPECT_EQ(run.pipeline.statistics().interruptions, 0) << format;
    EXPECT_EQ(run.is_told("own skeleton is used instead of"), !has_own_names) << format;
    EXPECT_EQ(run.is_told("no joint \"Hips\""), !has_own_names) << format << run.told;
  }
}

TEST(NewSender, ReplacesTheUsersSkeletonOnlyIfItIsHuman) {
  constexpr const char* kBox =
      R"({"skeleton": {"joints": [{"name": "a", "rest": [0, 0, 0, 1, 0, 0, 0]}, )"
      R"({"name": "b", "parent": "a", "rest": [0, 0, 1, 1, 0, 0, 0]}]}})";
  const Clip clip = sample_clip("walk");
  SentStream run(LivePace::kInput, "stdin?format=lines");
  ASSERT_TRUE(run.pipeline.know_skeleton(clip));
  run.send(kBox, 0.0);
  EXPECT_EQ(run.pipeline.packets().refused_skeletons, 1);
  EXPECT_FALSE(run.is_told("own skeleton is used instead of")) << run.told;
}

TEST(NewSender, ABodyIsLikeAnotherInTheSameUnit) {
  const Clip clip = sample_clip("walk");
  EXPECT_TRUE(is_like(clip, clip));
  EXPECT_TRUE(is_like(clip, sample_clip("wave")));
  EXPECT_FALSE(is_like(clip, in_millimetres(clip)));
  Clip with_unit = clip;
  ClipOrigin origin = clip.origin();
  origin.metres_per_unit = 1.0;
  with_unit.set_origin(origin);
  EXPECT_FALSE(is_same(clip, with_unit));
}

}  // namespace
}  // namespace retarget
