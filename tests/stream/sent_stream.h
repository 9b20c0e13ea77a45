#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "live/stream/live_pipeline.h"
#include "live/stream/stream_formats.h"
#include "stream/stream_support.h"

namespace retarget {

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
inline std::vector<std::string> sent_lines(const Clip& clip, Encoder& encoder) {
  std::vector<std::string> lines;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    lines.push_back(encoder.frame(clip, frame).value());
  }
  return lines;
}

}  // namespace retarget
