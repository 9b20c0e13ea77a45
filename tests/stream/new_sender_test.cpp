// Frames that arrive faster than in real time, and senders that replace others, without sockets.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "human/twins.h"
#include "live/stream/human_bones.h"
#include "live/stream/live_pipeline.h"
#include "live/stream/stream_formats.h"
#include "retarget/resample.h"
#include "stream/stream_support.h"
#include "support/with_joints.h"

namespace retarget {
namespace {

struct SentFrame {
  double time;
  LiveState state;
  std::vector<double> qpos;
};

// A pipeline and its output.
struct SentStream {
  explicit SentStream(LivePace pace, const char* address = "udp:1?format=lines")
      : pipeline(
            set_up_robot(streamed_g1(), {}).value(), options(pace),
            (*find_stream_format(parse_address(address)->format))
                ->decoder(parse_address(address).value()),
            [this](const RobotFrame& frame) {
              frames.push_back({frame.time, frame.state, {frame.qpos.begin(), frame.qpos.end()}});
            },
            [this](std::string_view, std::string_view text) { told += std::string(text) + "\n"; }) {
  }

  static LivePipelineOptions options(LivePace pace) {
    LivePipelineOptions made;
    made.pace = pace;
    made.in_background = pace == LivePace::kClock;
    return made;
  }
  void send(std::string_view text, double now) {
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      ASSERT_TRUE(pipeline.packet(text.substr(0, end), now));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
  }
  [[nodiscard]] bool is_told(std::string_view text) const {
    return told.find(text) != std::string::npos;
  }

  std::vector<SentFrame> frames;
  std::string told;
  LivePipeline pipeline;
};

// The text of a clip in a format, without its header.
std::vector<std::string> sent_lines(const Clip& clip, Encoder& encoder) {
  std::vector<std::string> lines;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    lines.push_back(encoder.frame(clip, frame).value());
  }
  return lines;
}

// The frames of a session that gets the clip's frames at their times.
std::vector<SentFrame> frames_of_session(const Clip& clip) {
  const Plan plan = make_plan(clip, streamed_g1()).value();
  LiveSession session = LiveSession::make(plan).value();
  LivePoser poser(plan);
  std::vector<SentFrame> frames;
  const auto pull = [&](double now) {
    while (const auto frame = session.pull(now)) {
      frames.push_back({frame->time, frame->state, {frame->qpos.begin(), frame->qpos.end()}});
    }
  };
  for (int i = 0; i < clip.frame_count(); ++i) {
    HumanFrame human;
    human.time = clip.rate().time_of(i);
    poser.pose(clip.rotations(i), clip.translations(i), human.world_from_bone);
    session.push(human, human.time);
    pull(human.time);
  }
  session.finish();
  pull(clip.rate().time_of(clip.frame_count()));
  return frames;
}

TEST(InputPace, GivesTheFramesOfASession) {
  const Clip clip = sample_clip("walk");
  const auto expected = frames_of_session(clip);
  ASSERT_EQ(expected.size(), 501U);
  for (const char* address :
       {"stdin?format=lines", "stdin?format=bvh", "stdin?format=bvh&fps=30"}) {
    SentStream run(LivePace::kInput, address);
    const auto encoder = (*find_stream_format(parse_address(address)->format))->encoder();
    run.send(encoder->begin(clip), 0.0);
    // All lines arrive at once.
    for (const std::string& line : sent_lines(clip, *encoder)) run.send(line, 0.001);
    run.pipeline.finish(0.001);
    ASSERT_EQ(run.frames.size(), expected.size()) << address;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_NEAR(run.frames[i].time, expected[i].time, 1e-9) << address << i;
      ASSERT_EQ(run.frames[i].state, LiveState::kFollowing) << address << i;
    }
    EXPECT_FALSE(run.is_told("no timestamps")) << address;
  }
}

TEST(InputPace, HoldsThePoseInAGapOfTheTimes) {
  const Clip clip = sample_clip("walk");
  SentStream run(LivePace::kInput);
  const auto encoder = stream_encoder("lines");
  run.send(encoder->begin(clip), 0.0);
  for (int i = 0; i < 120; ++i) {
    if (i >= 50 && i < 80) continue;  // A second.
    run.send(encoder->frame(clip, i).value(), 0.0);
  }
  const auto held = std::ranges::count(run.frames, LiveState::kHolding, &SentFrame::state);
  EXPECT_NEAR(static_cast<double>(held), 43.0, 3.0);
}

// Frames are missing for up to a quarter of a second, whatever the rate of the others.
TEST(InputPace, InterpolatesGaps) {
  const Clip clip = resample(sample_clip("walk"), frame_rate_from_fps(120.0)).value();
  for (const int missing : {10, 20, 25, 28}) {
    SentStream run(LivePace::kInput);
    const auto encoder = stream_encoder("lines");
    run.send(encoder->begin(clip), 0.0);
    for (int i = 0; i < 480; ++i) {
      if (i <= 200 || i > 200 + missing) run.send(encoder->frame(clip, i).value(), 0.0);
    }
    run.pipeline.finish(0.0);
    for (std::size_t i = 0; i < run.frames.size(); ++i) {
      ASSERT_EQ(run.frames[i].state, LiveState::kFollowing) << missing << ", " << i;
      if (i == 0) continue;
      ASSERT_LT(run.frames[i].time - run.frames[i - 1].time, 0.031) << missing << ", " << i;
    }
  }
}

TEST(InputPace, WarnsOfTimesThatAreNoSeconds) {
  const Clip clip = sample_clip("walk");
  struct Stamps {
    double begin, step;
    const char* told;
  };
  for (const auto& [begin, step, told] : {Stamps{0.0, 1.0 / 30.0, ""},
                                          {5.0, 0.0, "the timestamps stay at 5"},
                                          {9.0, -0.03, "the timestamps fall"},
                                          {0.0, 33.0, "look like milliseconds"},
                                          {7.0, 1.0, "look like frame numbers"},
                                          {1e6, 8333.0, "look like microseconds"},
                                          {0.0, 1.0 / 120.0, ""}}) {
    SentStream run(LivePace::kInput);
    const auto encoder = stream_encoder("lines");
    run.send(encoder->begin(clip), 0.0);
    for (int i = 0; i < 60; ++i) {
      auto line = nlohmann::json::parse(encoder->frame(clip, i).value());
      line["time"] = begin + step * i;
      run.send(line.dump(), 0.001 * i);
    }
    const bool is_faulty = told[0] != 0;
    EXPECT_EQ(run.is_told("the timestamps"), is_faulty) << run.told;
    if (is_faulty) {
      EXPECT_TRUE(run.is_told(told)) << run.told;
    }
  }
}

TEST(InputPace, WarnsOfFramesWithoutTimes) {
  const Clip clip = sample_clip("walk");
  const auto encoder = stream_encoder("bvh");
  const std::string header = encoder->begin(clip);
  const auto lines = sent_lines(clip, *encoder);
  // Without the line that states the frame time.
  for (const double step : {0.0001, 0.03}) {
    SentStream run(LivePace::kInput, "stdin?format=bvh");
    run.send(header.substr(0, header.find("Frame Time:")), 0.0);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      run.send(lines[i], step * static_cast<double>(i));
    }
    EXPECT_EQ(run.is_told("no timestamps"), step < 0.001);
    EXPECT_EQ(run.is_told("stdin?format=bvh&fps=30"), step < 0.001);
    EXPECT_EQ(run.frames.size() > 400, step > 0.001);
  }
}

// The poses of a larger body, or in another unit, without its skeleton.
TEST(InputPace, NoticesAnotherBodySize) {
  const Clip clip = sample_clip("walk");
  struct Size {
    double scale;
    const char* told;
  };
  for (const auto& [scale, told] :
       {Size{1.0, ""}, Size{1.05, ""}, Size{1.25, "1.25 times"}, Size{0.8, "0.8 times"},
        Size{100.0, "look like another unit"}}) {
    SentStream run(LivePace::kInput);
    const auto encoder = stream_encoder("lines");
    run.send(encoder->begin(clip), 0.0);
    for (int i = 0; i < 120; ++i) {
      auto line = nlohmann::json::parse(encoder->frame(clip, i).value());
      for (auto& joint : line["joints"]) {
        for (std::size_t k = 0; k < 3 && i >= 30; ++k) joint[k] = scale * joint[k].get<double>();
      }
      run.send(line.dump(), 0.0);
    }
    run.pipeline.finish(0.0);
    EXPECT_EQ(run.is_told("times as long"), told[0] != 0) << scale << ": " << run.told;
    EXPECT_TRUE(run.is_told(told)) << scale << ": " << run.told;
    const bool is_person = scale < 2.0;
    EXPECT_EQ(run.frames.back().state == LiveState::kFollowing, is_person) << scale;
    EXPECT_EQ(run.pipeline.packets().malformed > 80, !is_person) << scale;
    // The robot neither floats nor flies.
    EXPECT_NEAR(run.frames.back().qpos[2], 0.76, 0.05) << scale;
  }
}

// The remedy is that of the format: lines have times, no option for their rate.
TEST(InputPace, NamesTheMemberForTheTimesOfLines) {
  const Clip clip = sample_clip("walk");
  const auto encoder = stream_encoder("lines");
  SentStream run(LivePace::kInput);
  run.send(encoder->begin(clip), 0.0);
  for (int i = 0; i < 60; ++i) {
    auto line = nlohmann::json::parse(encoder->frame(clip, i).value());
    line.erase("time");
    run.send(line.dump(), 0.0001 * i);
  }
  EXPECT_TRUE(run.is_told("add \"time\" to every frame")) << run.told;
  EXPECT_FALSE(run.is_told("fps=")) << run.told;
}

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
