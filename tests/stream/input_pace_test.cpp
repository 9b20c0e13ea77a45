// Frames that arrive faster than in real time, without sockets.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "human/twins.h"
#include "retarget/resample.h"
#include "stream/sent_stream.h"
#include "stream/stream_support.h"

namespace retarget {
namespace {

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

}  // namespace
}  // namespace retarget
