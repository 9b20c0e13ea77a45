// Packets in, robot frames out, without sockets: deterministic.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "human/twins.h"
#include "live/stream/live_pipeline.h"
#include "live/stream/stats_writer.h"
#include "live/stream/stream_formats.h"
#include "live/stream/stream_record.h"
#include "retarget/human_skeleton.h"
#include "stream/stream_support.h"
#include "support/lafan1_map.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

struct StreamRun {
  explicit StreamRun(LivePipelineOptions options = {}, const char* format = "lines")
      : pipeline(
            set_up_robot(streamed_g1(), options.run).value(), options,
            (*find_stream_format(format))->decoder(parse_address("udp:1?fps=30").value()),
            [this](const RobotFrame& frame) {
              states.push_back(frame.state);
              frames.emplace_back(frame.qpos.begin(), frame.qpos.end());
            },
            [this](std::string_view label, std::string_view text) {
              told.push_back(std::string(label) + ": " + std::string(text));
            }) {}

  // All lines of a text at one time.
  void lines(std::string_view text, double now) {
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      const auto taken = pipeline.packet(text.substr(0, end), now);
      EXPECT_TRUE(taken) << describe(taken.error());
      text.remove_prefix(std::min(end + 1, text.size()));
    }
  }

  std::vector<std::vector<double>> frames;
  std::vector<LiveState> states;
  std::vector<std::string> told;
  LivePipeline pipeline;
};

// Plays a sample to a run.
void play_clip_to(StreamRun& run, const Clip& clip, const char* format, double begin = 0.0,
                  bool ticks = false) {
  const auto encoder = (*find_stream_format(format))->encoder();
  run.lines(encoder->begin(clip), begin);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const double now = begin + clip.rate().time_of(frame);
    for (double time = now - 0.03; ticks && time < now; time += 0.002) run.pipeline.tick(time);
    run.lines(encoder->frame(clip, frame).value(), now);
  }
}

TEST(LivePipeline, FollowsAStreamWithItsSkeleton) {
  for (const char* format : {"lines", "bvh"}) {
    StreamRun run({}, format);
    play_clip_to(run, sample_clip("walk"), format);
    run.pipeline.finish(6.0);
    EXPECT_GT(run.frames.size(), 400U) << format;
    EXPECT_EQ(run.pipeline.packets().skeletons, 1);
    EXPECT_EQ(run.pipeline.packets().malformed, 0);
  }
}

bool is_told(const StreamRun& run, std::string_view text) {
  return std::ranges::any_of(
      run.told, [&](const std::string& line) { return line.find(text) != std::string::npos; });
}

// The zero pose of LAFAN1's skeleton is folded up.
TEST(LivePipeline, RecognisesABodyByItsFirstFrame) {
  for (const char* format : {"lines", "bvh"}) {
    StreamRun run({}, format);
    const Clip clip = sample_clip("walk");
    const auto encoder = (*find_stream_format(format))->encoder();
    run.lines(encoder->begin(clip), 0.0);
    EXPECT_TRUE(run.told.empty()) << format;
    EXPECT_FALSE(run.pipeline.has_begun()) << format;
    run.lines(encoder->frame(clip, 0).value(), 0.0);
    EXPECT_TRUE(run.pipeline.has_begun()) << format;
    EXPECT_TRUE(is_told(run, "LAFAN1")) << format;
    EXPECT_FALSE(is_told(run, "unusual")) << format;
    EXPECT_FALSE(is_told(run, "in no frame")) << format;
  }
}

TEST(LivePipeline, IsIndependentOfThePollingRate) {
  StreamRun seldom, often;
  play_clip_to(seldom, sample_clip("wave"), "lines");
  play_clip_to(often, sample_clip("wave"), "lines", 0.0, true);
  EXPECT_EQ(seldom.frames, often.frames);
}

TEST(LivePipeline, SkipsMalformedPackets) {
  StreamRun run;
  const Clip clip = sample_clip("wave");
  const auto encoder = stream_encoder("lines");
  run.lines(encoder->begin(clip), 0.0);
  for (int frame = 0; frame < 60; ++frame) {
    const double now = clip.rate().time_of(frame);
    run.lines("{\"joints\": 7}\nnoise", now);
    run.lines(encoder->frame(clip, frame).value(), now);
  }
  EXPECT_EQ(run.pipeline.packets().malformed, 120);
  EXPECT_GT(run.frames.size(), 80U);
  EXPECT_EQ(std::ranges::count_if(run.told,
                                  [](const std::string& line) {
                                    return line.starts_with("stream: skipping malformed");
                                  }),
            1);
}

TEST(LivePipeline, AcceptsAnotherSkeletonDuringTheStream) {
  StreamRun run;
  play_clip_to(run, sample_clip("squat"), "lines");
  const std::size_t first = run.frames.size();
  // The same joints, a smaller body, and a restarted clock.
  const Clip other = scaled_and_turned(sample_clip("walk"), 0.9, Eigen::Quaterniond::Identity());
  play_clip_to(run, other, "lines", 20.0);
  EXPECT_EQ(run.pipeline.packets().skeletons, 2);
  EXPECT_GT(run.frames.size(), first + 400);
  EXPECT_EQ(run.states.back(), LiveState::kFollowing);
}

// A frame of a sample's body in its T-pose.
Clip t_pose_of(const Clip& clip) {
  const Calibration calibration = lafan1_calibration(clip.skeleton());
  Clip pose = clip.empty_like(clip.rate(), 1);
  copy_frame(clip, 0, pose, 0);
  const int joints = clip.skeleton().joint_count();
  std::vector<Eigen::Quaterniond> world(static_cast<std::size_t>(joints),
                                        Eigen::Quaterniond::Identity());
  for (const Bone bone : kMappedBones) {
    const int joint = calibration.bones[bone].rotation_joint;
    if (joint < 0) continue;
    world[static_cast<std::size_t>(joint)] = Eigen::Quaterniond(
        Eigen::Matrix3d(calibration.human_from_source.transpose() * canonical_t_pose(bone)));
  }
  for (int joint = 0; joint < joints; ++joint) {
    const int parent = clip.skeleton().joint(joint).parent;
    const auto& own = world[static_cast<std::size_t>(joint)];
    pose.rotations(0)[static_cast<std::size_t>(joint)] =
        parent < 0 ? own : world[static_cast<std::size_t>(parent)].conjugate() * own;
  }
  return pose;
}

TEST(LivePipeline, CalibratesFromThePerformersPose) {
  LivePipelineOptions options;
  options.calibrate = LiveCalibration::kTpose;
  options.calibrate_after_s = 1.0;
  const Clip clip = sample_clip("wave"), pose = t_pose_of(clip);
  StreamRun known, posed(options);
  play_clip_to(known, clip, "lines");
  const auto encoder = stream_encoder("lines");
  posed.lines(encoder->begin(clip), 0.0);
  for (int frame = 0; frame < 29; ++frame) {
    posed.lines(encoder->frame(pose, 0).value(), frame / 30.0);
  }
  EXPECT_FALSE(posed.pipeline.has_begun());
  EXPECT_TRUE(posed.frames.empty());
  posed.lines(encoder->frame(pose, 0).value(), 1.01);
  EXPECT_TRUE(posed.pipeline.has_begun());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    posed.lines(encoder->frame(clip, frame).value(), 1.02 + clip.rate().time_of(frame));
  }
  // The same motion as with the known properties of such skeletons.
  ASSERT_GT(posed.frames.size(), 200U);
  for (std::size_t i = 7; i < known.frames.back().size(); ++i) {
    EXPECT_NEAR(posed.frames.back()[i], known.frames.back()[i], 0.1) << i;
  }
}

constexpr const char* kNobody =
    R"({"skeleton": {"joints": [{"name": "a", "rest": [0, 0, 0, 1, 0, 0, 0]}, )"
    R"({"name": "b", "parent": "a", "rest": [0, 0, 1, 1, 0, 0, 0]}]}})";

TEST(LivePipeline, WaitsForAHuman) {
  StreamRun run;
  for (int i = 0; i < 3; ++i) run.lines(kNobody, 0.1 * i);
  EXPECT_FALSE(run.pipeline.has_begun());
  EXPECT_EQ(run.pipeline.packets().refused_skeletons, 3);
  EXPECT_EQ(
      std::ranges::count_if(
          run.told, [](const std::string& line) { return line.starts_with("body: waiting"); }),
      1);
  play_clip_to(run, sample_clip("wave"), "lines", 1.0);
  EXPECT_GT(run.frames.size(), 100U);
}

TEST(LivePipeline, KeepsItsBodyIfAnotherSkeletonIsRejected) {
  for (const char* format : {"lines", "bvh"}) {
    StreamRun run({}, format);
    const Clip clip = sample_clip("wave");
    const auto encoder = (*find_stream_format(format))->encoder();
    run.lines(encoder->begin(clip), 0.0);
    for (int frame = 0; frame < 60; ++frame) {
      if (frame == 30) {
        run.lines(
            std::string_view(format) == "lines"
                ? kNobody
                : "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n"
                  "End Site\n{\nOFFSET 0 1 0\n}\n}\nMOTION\n",
            clip.rate().time_of(frame));
      }
      run.lines(encoder->frame(clip, frame).value(), clip.rate().time_of(frame));
    }
    EXPECT_EQ(run.pipeline.packets().refused_skeletons, 1) << format;
    EXPECT_EQ(run.pipeline.packets().malformed, 0) << format;
    EXPECT_EQ(run.pipeline.statistics().received, 60) << format;
    EXPECT_EQ(run.pipeline.statistics().interruptions, 0) << format;
    EXPECT_EQ(run.states.back(), LiveState::kFollowing) << format;
  }
}

TEST(StreamRecord, RoundTrips) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "input.stream").string();
  auto recorder = value_of(StreamRecorder::create(file, {}));
  recorder.add(StreamEvent::kNewSender, 5);
  recorder.add(StreamEvent::kPacket, 7, std::string("a\nb\0c", 5));
  recorder.add(StreamEvent::kEnd, 1000000);
  ASSERT_TRUE(recorder.finish());
  auto replay = value_of(StreamReplay::open(file));
  StreamReplay::Entry entry;
  ASSERT_TRUE(*replay.next(entry));
  EXPECT_EQ(entry.event, StreamEvent::kNewSender);
  ASSERT_TRUE(*replay.next(entry));
  EXPECT_EQ(entry.bytes, std::string("a\nb\0c", 5));
  EXPECT_EQ(entry.microseconds, 7);
  ASSERT_TRUE(*replay.next(entry));
  EXPECT_FALSE(*replay.next(entry));
  for (const char* bad : {"X 1 0\n\n", "P 1\n", "P 2 99999999999\n", "P 1 5\nab\n", "P -1 0\n\n"}) {
    auto broken = value_of(StreamReplay::open(folder.write("bad", bad)));
    EXPECT_FALSE(broken.next(entry)) << bad;
  }
}

TEST(LatencyTest, ComputesPercentiles) {
  Latency latency;
  EXPECT_EQ(latency.percentile(99.0), 0.0);
  for (int i = 1; i <= 1000; ++i) latency.add(1e-6 * i);
  EXPECT_NEAR(latency.percentile(50.0), 500e-6, 30e-6);
  EXPECT_NEAR(latency.percentile(99.0), 990e-6, 50e-6);
  EXPECT_EQ(latency.max(), 1e-3);
}

}  // namespace
}  // namespace retarget
