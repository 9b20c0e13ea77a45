#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/live.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "stream/decoder.h"

namespace retarget {

/// How a body that comes in a stream is calibrated.
enum class LiveCalibration : unsigned char {
  kAuto,   ///< By what the skeleton's file or header says.
  kTpose,  ///< By the pose that the performer has some seconds after the first frame: a T-pose,
  kNpose,  ///< or with the arms down.
};

struct LivePipelineOptions {
  LiveOptions live;
  Options run;  ///< How the human is recognised and the robot is solved for.
  LiveCalibration calibrate = LiveCalibration::kAuto;
  double calibrate_after_s = 3.0;
};

/// What became of a stream's bytes, beside LiveStatistics.
struct PipelineStatistics {
  std::int64_t packets = 0;
  std::int64_t malformed = 0;  ///< Left out.
  int skeletons = 0;           ///< That were told, one after the other.
};

/// Packets in, robot frames out, with the time of each packet given: the same packets at the same
/// times give the same frames, however often tick was called between them.
class LivePipeline final : private StreamSink {
 public:
  using TakeFrame = std::function<void(const RobotFrame&)>;
  /// A line for people: a label, and what there is to say; options marked.
  using Tell = std::function<void(std::string_view label, std::string_view text)>;

  LivePipeline(RobotSetup robot, LivePipelineOptions options, std::unique_ptr<Decoder> decoder,
               TakeFrame take_frame, Tell tell);
  ~LivePipeline() override;
  LivePipeline(const LivePipeline&) = delete;
  LivePipeline& operator=(const LivePipeline&) = delete;

  /// The skeleton of a file, before the first packet: of a stream that tells none. Its frames, where
  /// it has any, are the body's for calibration.
  [[nodiscard]] Result<void> know_skeleton(Clip clip);

  /// Takes a packet. What cannot be understood is counted; errors end the stream: a body that cannot
  /// be recognised, or a robot that cannot follow it.
  [[nodiscard]] Result<void> packet(std::string_view bytes, double now);
  /// Gives what is due.
  void tick(double now);
  /// Another connection begins.
  void restart_sender(double now);
  /// The body is calibrated anew, by its pose after so many seconds.
  void recalibrate(double now);
  /// What the sender must be asked now (Decoder::request).
  [[nodiscard]] std::string_view request() const { return decoder_->request(); }
  /// Nothing more comes: gives what is left.
  void finish(double now);

  [[nodiscard]] const PipelineStatistics& packets() const { return packets_; }
  [[nodiscard]] LiveStatistics statistics() const;
  [[nodiscard]] bool has_begun() const { return session_.has_value(); }

 private:
  void take_skeleton(Clip clip, bool has_rest) override;
  void take_frame(const StreamFrame& frame) override;
  [[nodiscard]] Result<void> begin_session(Clip clip, RestPose rest);
  [[nodiscard]] bool collects(const StreamFrame& frame);
  void tell_once(bool& told, std::string_view label, std::string_view text) const;
  void tell_changes();

  RobotSetup robot_;
  LivePipelineOptions options_;
  std::unique_ptr<Decoder> decoder_;
  TakeFrame take_robot_frame_;
  Tell tell_;

  std::optional<Clip> skeleton_;  // as it was told last
  std::optional<LiveSession> session_;
  std::optional<LivePoser> poser_;
  bool calibrates_ = false;
  std::optional<double> calibration_begin_;
  double now_ = 0.0;
  std::optional<Error> error_;
  PipelineStatistics packets_;
  HumanFrame human_;
  bool malformed_told_ = false, hold_told_ = false, stand_told_ = false, jump_told_ = false;
};

}  // namespace retarget
