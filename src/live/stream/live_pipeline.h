#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "live/stream/body_match.h"
#include "live/stream/stamp_faults.h"
#include "live/stream/stream_formats.h"
#include "live/stream/stream_skeleton.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/live.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/serve.h"

namespace retarget {

/// Converts packets to robot frames. The caller passes the time of each packet: the same packets at
/// the same times give the same frames, regardless of how often tick is called in between.
///
/// decode may run on one thread while another thread calls tick; all other calls exclude each
/// other.
class LivePipeline final {
 public:
  using TakeFrame = std::function<void(const RobotFrame&)>;
  using Tell = LiveTell;

  LivePipeline(RobotSetup robot, LivePipelineOptions options, std::unique_ptr<Decoder> decoder,
               TakeFrame take_frame, Tell tell);
  ~LivePipeline();
  LivePipeline(const LivePipeline&) = delete;
  LivePipeline& operator=(const LivePipeline&) = delete;

  /// Sets a skeleton from a file before the first packet, for streams that do not send one. Its
  /// frames, if any, are used for calibration. Errors: no human found; incompatible options.
  [[nodiscard]] Result<void> know_skeleton(Clip clip);

  /// Handles a packet: decode, then use_decoded. Invalid packets are counted; no input ends a
  /// stream. Errors (kUsage): options incompatible with the first body.
  [[nodiscard]] Result<void> packet(std::string_view bytes, double now);
  /// Decodes a packet.
  void decode(std::string_view bytes);
  /// Uses the decoded skeletons and frames.
  [[nodiscard]] Result<void> use_decoded(double now);
  /// Emits the robot frames that are due.
  void tick(double now);
  /// Time at which the next robot frame is due (LiveSession::due); nothing if the clock sets none.
  [[nodiscard]] std::optional<double> due() const;
  /// Drops the robot frames between `due` and now, because the caller was not running
  /// (LiveSession::skip_to).
  void skip(double due, double now);
  /// Declares a new sender or connection.
  /// @param may_lack_skeleton  the sender may have sent its skeleton before it was accepted. Its
  ///     frames are dropped until its skeleton arrives, because they may belong to another body.
  void restart_sender(double now, bool may_lack_skeleton = false);
  /// Uses the skeletons of a packet that a new sender sent before it was accepted. Its frames are
  /// old.
  [[nodiscard]] Result<void> take_early(std::string_view bytes, double now);
  /// Recalibrates the body from its pose after calibrate_after_s seconds.
  void recalibrate(double now);
  /// Whether a body has been recognised in the background.
  [[nodiscard]] bool body_is_ready() const { return maker_.is_ready(); }
  /// Switches to that body; waits until it is ready.
  void take_body(double now);
  /// The request to send to the sender now (Decoder::request).
  [[nodiscard]] std::string_view request() const { return decoder_->request(); }
  /// Decoder::lack of the stream. Called by the thread that decodes.
  [[nodiscard]] std::string lack() const { return decoder_->lack(); }
  /// Ends the input and emits the remaining frames.
  void finish(double now);

  /// Why an input gave no robot frame; no error if it gave any, or if nothing is known of an input
  /// without packets.
  /// @param input   address of the input, without its format.
  /// @param format  name of the stream's format.
  [[nodiscard]] Result<void> check_used(const std::string& input, std::string_view format) const;

  [[nodiscard]] const PipelineStatistics& packets() const { return packets_; }
  [[nodiscard]] LiveStatistics statistics() const;
  [[nodiscard]] LiveState state() const {
    return session_ ? session_->state() : LiveState::kWaiting;
  }
  [[nodiscard]] bool has_begun() const { return session_.has_value(); }

 private:
  void know_up(const std::optional<Eigen::Vector3d>& up);
  void note_malformed(std::string_view bytes, const std::string& why);
  void restore_used_skeleton();
  [[nodiscard]] bool is_of_old_skeleton(std::string_view bytes);
  Result<void> use_items();
  void take_skeleton(const Clip& clip, bool has_rest);
  void warn_of_unused_file(const Clip& used);
  void take_frame(const StreamFrame& frame);
  void take_old_frame(const StreamFrame& frame);
  [[nodiscard]] double advance_to(const StreamFrame& frame);
  void follow(const StreamFrame& frame, double time);
  [[nodiscard]] Result<void> begin_session(const BodyTask& task);
  void change_body(BodyTask task);
  void start_waiting_body();
  void adopt(const BodyTask& task, Result<MadeBody> made);
  void use_body(const Plan& plan);
  [[nodiscard]] bool has_size_of_body(const StreamFrame& frame);
  void resize_body(const StreamFrame& frame);
  void refuse(const BodyTask& task, const Error& why);
  void warn_of_refusal(const std::string& why);
  void drop_poseless();
  void take_first_pose(const StreamFrame& frame);
  [[nodiscard]] bool collects(const StreamFrame& frame);
  [[nodiscard]] bool is_of_received_body(const StreamFrame& frame) const;
  [[nodiscard]] bool is_of_used_body(const StreamFrame& frame) const;
  [[nodiscard]] bool is_foreign();
  [[nodiscard]] double time_of(const StreamFrame& frame) const;
  void watch_stamp(double stamp);
  void pass_time(double stamp);
  void pull(double until);
  void warn_once(bool& warned, std::string_view label, std::string_view text) const;
  void report_changes();

  static constexpr double kBodyEvery = 1.0;  // Seconds from one recognition of a body to the next.

  LivePipelineOptions options_;
  BodyMaker maker_;
  std::unique_ptr<Decoder> decoder_;
  TakeFrame take_robot_frame_;
  Tell tell_;

  PacketBatch batch_;
  std::optional<std::string> decode_error_;
  SkeletonPackets skeleton_packets_;
  bool restores_ = false;  // Restore the skeleton in use in the decoder before the next packet.
  // While `poseless_` waits: the packet is of the body in use, and the decoder has its skeleton.
  bool reads_old_ = false;
  int old_frames_ = 0;  // Consecutive frames of the body in use while `poseless_` waits.
  int old_tries_ = 0;   // Packets tried as such frames since the time of the first of them.
  double first_old_try_ = -std::numeric_limits<double>::infinity();
  bool lacks_skeleton_ = false;  // The sender's skeleton is missing.

  std::optional<Clip> received_;      // Skeleton of the received frames.
  std::optional<Clip> used_;          // Skeleton of the body in use.
  std::optional<Clip> refused_;       // Last refused skeleton.
  std::optional<BodyTask> waiting_;   // Latest body that is not being recognised yet.
  std::optional<BodyTask> poseless_;  // A body whose skeleton has no pose yet.
  double pose_tried_ = -std::numeric_limits<double>::infinity();  // Last recognition attempt.
  double looked_ = -std::numeric_limits<double>::infinity();      // Last background recognition.
  std::shared_ptr<const Skeleton> known_;  // Skeleton of a file, while in use.
  std::optional<LiveSession> session_;
  std::optional<LivePoser> poser_;
  std::optional<BodyMatch> size_;
  std::optional<Clip> pose_;                       // Of the body in use, in its calibration.
  RestPose rest_ = RestPose::kAuto;                // Meaning of that pose.
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();  // Of the first body's skeleton.
  bool calibrates_ = false;
  std::optional<double> calibration_begin_;
  double now_ = 0.0;  // Session time.
  double wall_ = 0.0;
  std::optional<double> stamp_;  // Last timestamp, if timestamps are the clock.
  UntimedFrames untimed_;
  StampFaults stamps_;
  std::optional<Error> error_;
  PipelineStatistics packets_;
  HumanFrame human_;
  std::string malformed_why_, malformed_head_;  // Of the first malformed packet.
  std::string refused_why_;                     // Of the latest refused skeleton.
  bool malformed_reported_ = false, hold_reported_ = false, stand_reported_ = false,
       jump_reported_ = false;
  bool refused_reported_ = false, foreign_reported_ = false, pace_reported_ = false,
       file_reported_ = false, stamps_reported_ = false, size_reported_ = false,
       unit_reported_ = false;
};

}  // namespace retarget
