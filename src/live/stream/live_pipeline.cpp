#include "live/stream/live_pipeline.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "live/session/frame_queue.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Frames due before a packet arrives leave before it; frames due at its time include it.
constexpr double kJustBefore = 2e-6;  // seconds
// Maximum number of frames in one packet at clock pace.
constexpr std::size_t kMostFrames = 128;

// Consecutive frames of the body in use after which a new skeleton without poses is dropped. Fewer
// may be late packets.
constexpr int kMostOldFrames = 5;
// Maximum number of packets per kBodyEvery that are tried as frames of the body in use, because the
// decoder reads both skeletons again for each of them.
constexpr int kMostOldTries = 10;

}  // namespace

LivePipeline::LivePipeline(RobotSetup robot, LivePipelineOptions options,
                           std::unique_ptr<Decoder> decoder, TakeFrame take_frame, Tell tell)
    : options_(std::move(options)),
      maker_(std::move(robot), options_.run, options_.live),
      decoder_(std::move(decoder)),
      take_robot_frame_(std::move(take_frame)),
      tell_(std::move(tell)),
      batch_(options_.pace == LivePace::kInput ? std::numeric_limits<std::size_t>::max()
                                               : kMostFrames),
      calibrates_(options_.calibrate != LiveCalibration::kAuto) {}

LivePipeline::~LivePipeline() = default;

Result<void> LivePipeline::know_skeleton(Clip clip) {
  known_ = clip.shared_skeleton();
  decoder_->know_skeleton(known_);
  ++packets_.skeletons;
  received_ = clip;
  if (calibrates_) {
    // The performer's pose determines the body; only the file states its axes.
    know_up(clip.origin().up);
    return {};
  }
  RETARGET_TRY(begin_session({std::move(clip), RestPose::kAuto, false}));
  know_up(up_);
  return {};
}

// The user's own choice of an axis holds for the stream as well as for the file.
void LivePipeline::know_up(const std::optional<Eigen::Vector3d>& up) {
  if (up && !options_.run.human.up) decoder_->know_up(*up);
}

Result<void> LivePipeline::packet(std::string_view bytes, double now) {
  decode(bytes);
  return use_decoded(now);
}

void LivePipeline::decode(std::string_view bytes) {
  if (std::exchange(restores_, false)) restore_used_skeleton();
  if (std::exchange(reads_old_, false)) skeleton_packets_.restore_latest(*decoder_);
  batch_.clear();
  auto taken = decoder_->take(bytes, batch_);
  reads_old_ = !taken && session_ && poseless_ && is_of_old_skeleton(bytes);
  if (reads_old_) taken = {};
  decode_error_.reset();
  if (!taken) note_malformed(bytes, taken.error().message);
  if (!taken || batch_.empty() || batch_.has_skeleton()) {
    skeleton_packets_.see(bytes, batch_, !taken.has_value());
  } else {
    skeleton_packets_.forget_waiting();
  }
}

void LivePipeline::note_malformed(std::string_view bytes, const std::string& why) {
  constexpr std::size_t kHead = 4096;
  decode_error_ = why;
  if (!malformed_why_.empty()) return;
  malformed_why_ = why;
  malformed_head_ = bytes.substr(0, kHead);
}

void LivePipeline::restore_used_skeleton() {
  if (known_) decoder_->know_skeleton(known_);
  skeleton_packets_.restore(*decoder_);
}

// Whether a packet that does not fit a new skeleton without poses has frames of the body in use.
// The decoder then keeps the skeleton in use until the next packet.
bool LivePipeline::is_of_old_skeleton(std::string_view bytes) {
  if (!batch_.empty()) return false;
  if (wall_ - first_old_try_ >= kBodyEvery) {
    first_old_try_ = wall_;
    old_tries_ = 0;
  }
  if (old_tries_ >= kMostOldTries) return false;
  ++old_tries_;
  restore_used_skeleton();
  if (decoder_->take(bytes, batch_) && !batch_.empty() && !batch_.has_skeleton()) return true;
  batch_.clear();
  skeleton_packets_.restore_latest(*decoder_);
  return false;
}

Result<void> LivePipeline::use_decoded(double now) {
  // At input pace, time advances with the timestamps of the frames.
  const bool by_clock = options_.pace != LivePace::kInput;
  if (by_clock) now_ = now;
  wall_ = now;
  pull(now_ - kJustBefore);
  ++packets_.packets;
  packets_.crowded += static_cast<std::int64_t>(batch_.dropped());
  if (decode_error_) {
    ++packets_.malformed;
    warn_once(
        malformed_reported_, "stream",
        "skipping malformed packet (similar ones are not reported): " + printable(*decode_error_));
  }
  return use_items();
}

Result<void> LivePipeline::use_items() {
  for (std::size_t i = 0; i < batch_.size() && !error_; ++i) {
    PacketBatch::Item& item = batch_[i];
    if (item.skeleton) {
      take_skeleton(*item.skeleton, item.has_rest);
    } else if (reads_old_) {
      take_old_frame(item.frame);
    } else {
      take_frame(item.frame);
    }
  }
  if (error_) return failure(std::move(*std::exchange(error_, std::nullopt)));
  start_waiting_body();
  pull(now_);
  return {};
}

void LivePipeline::pull(double until) {
  if (!session_) return;
  while (const auto frame = session_->pull(until)) take_robot_frame_(*frame);
  report_changes();
}

void LivePipeline::tick(double now) {
  if (options_.pace == LivePace::kInput) return;
  now_ = std::max(now_, now);
  pull(now_);
}

std::optional<double> LivePipeline::due() const {
  if (!session_ || options_.pace == LivePace::kInput) return std::nullopt;
  return session_->due();
}

void LivePipeline::skip(double due, double now) {
  if (options_.pace == LivePace::kInput) return;
  tick(due - kJustBefore);
  if (session_) session_->skip_to(now);
}

void LivePipeline::restart_sender(double now, bool may_lack_skeleton) {
  tick(now);
  decoder_->restart();
  skeleton_packets_.forget_waiting();
  // The user's file is the skeleton of any sender.
  lacks_skeleton_ = may_lack_skeleton && !known_;
}

Result<void> LivePipeline::take_early(std::string_view bytes, double now) {
  tick(now);
  wall_ = now;
  decode(bytes);
  batch_.drop_frames();
  return use_items();
}

void LivePipeline::finish(double now) {
  tick(now);
  if (!session_) return;
  session_->finish();
  pull(now_);
}

Result<void> LivePipeline::check_used(const std::string& input, std::string_view format) const {
  // In lag mode, a short stream at clock pace ends before its first robot frame.
  const LiveStatistics now = statistics();
  const bool is_used = now.received > now.bad + now.late + now.doubled;
  if (is_used || now.robot_frames > 0) return {};
  const std::string lack = decoder_->lack();
  if (packets_.packets == 0) {
    return lack.empty() ? Result<void>() : input_failure(input, "no packet arrived: " + lack);
  }
  std::string why = fmt::format("no frame of the stream is usable: {} of {} malformed",
                                packets_.malformed, count_text(packets_.packets, "packet"));
  if (!malformed_why_.empty()) why += ", the first one: " + printable(malformed_why_);
  if (!lack.empty()) why += "; " + lack;
  if (!session_ && !refused_why_.empty()) why += "; no human: " + refused_why_;
  if (!session_ && calibrates_) why += "; the input ended before the calibration";
  const std::string_view likely = likely_format(malformed_head_);
  if (likely.empty() || likely == format) return input_failure(input, why);
  return input_failure(input, why,
                       fmt::format("the input looks like {0}: use {1}?format={0}", likely, input));
}

LiveStatistics LivePipeline::statistics() const {
  return session_ ? session_->statistics() : LiveStatistics();
}

bool LivePipeline::is_of_received_body(const StreamFrame& frame) const {
  return received_ &&
         frame.rotations.size() == static_cast<std::size_t>(received_->skeleton().joint_count());
}

bool LivePipeline::is_of_used_body(const StreamFrame& frame) const {
  const Skeleton& used = used_->skeleton();
  return frame.rotations.size() == static_cast<std::size_t>(used.joint_count()) &&
         frame.translations.size() == static_cast<std::size_t>(used.translated_count());
}

// Whether frames may belong to another body than the one whose skeleton was received last.
bool LivePipeline::is_foreign() {
  if (!lacks_skeleton_) return false;
  ++packets_.foreign;
  warn_once(
      foreign_reported_, "stream",
      "ignoring the frames of a new sender, whose skeleton is missing: restart the sender, or "
      "name its skeleton with " RETARGET_OPTION("skeleton"));
  return true;
}

// The time of a frame on the sender's clock; NaN: unknown. If frames need not arrive in real time,
// the rate that the stream declares gives their times.
double LivePipeline::time_of(const StreamFrame& frame) const {
  const bool is_declared =
      options_.pace == LivePace::kInput && options_.live.clock == LiveClock::kSender;
  return is_declared && !std::isfinite(frame.time) ? frame.declared : frame.time;
}

void LivePipeline::watch_stamp(double stamp) {
  if (stamps_reported_ || options_.live.clock == LiveClock::kArrival) return;
  if (!std::isfinite(stamp)) return;
  if (const std::string fault = stamps_.add(stamp, wall_); !fault.empty()) {
    warn_once(stamps_reported_, "stream", fault);
  }
}

// Advances the time by the timestamps; if they jump, by one robot frame.
void LivePipeline::pass_time(double stamp) {
  constexpr double kMostStep = 10.0, kReordered = 0.5;  // seconds
  if (!std::isfinite(stamp)) {
    now_ = std::max(now_, wall_);
    if (!untimed_.add(wall_)) return;
    warn_once(
        pace_reported_, "stream",
        fmt::format("the frames have no timestamps and arrive faster than in real time, so the "
                    "robot's motion is too short: {}",
                    decoder_->time_remedy()));
    return;
  }
  if (stamp_) {
    const double step = stamp - *stamp_;
    if (step < 0.0 && step > -kReordered) return;
    now_ += step >= 0.0 && step <= kMostStep ? step : 1.0 / options_.live.fps;
  }
  stamp_ = stamp;
}

// Advances the session time to a frame at input pace. @return the frame's own time
double LivePipeline::advance_to(const StreamFrame& frame) {
  const double time = time_of(frame);
  watch_stamp(time);
  if (options_.pace != LivePace::kInput) return time;
  const double before = now_;
  pass_time(time);
  // Robot frames in between wait for this frame, as far as the human can be interpolated.
  if (now_ - before > kMaxBridgedGap) pull(now_ - kJustBefore);
  return time;
}

void LivePipeline::follow(const StreamFrame& frame, double time) {
  human_.time = time;
  poser_->pose(frame.rotations, frame.translations, human_.world_from_bone);
  if (has_size_of_body(frame)) session_->push(human_, now_);
  if (options_.pace == LivePace::kInput) pull(now_);
}

// A frame of the body in use while a new skeleton has no pose yet.
void LivePipeline::take_old_frame(const StreamFrame& frame) {
  if (is_foreign()) return;
  if (!is_of_used_body(frame)) {
    ++packets_.malformed;
    return;
  }
  follow(frame, advance_to(frame));
  if (++old_frames_ >= kMostOldFrames) drop_poseless();
}

void LivePipeline::take_frame(const StreamFrame& frame) {
  if (is_foreign()) return;
  if (!is_of_received_body(frame)) {
    if (received_) ++packets_.malformed;
    return;
  }
  old_frames_ = 0;
  const double time = advance_to(frame);
  // A running stream continues while it waits for its new pose.
  if (collects(frame) && !session_) return;
  take_first_pose(frame);
  if (!session_ || !poser_) return;
  // Another body has not been recognised yet.
  if (!is_like(*received_, *used_)) return;
  follow(frame, time);
}

void LivePipeline::warn_once(bool& warned, std::string_view label, std::string_view text) const {
  if (!std::exchange(warned, true)) tell_(label, text);
}

// Reports each kind of change once per run, because streams may be intermittent; the summary counts
// them.
void LivePipeline::report_changes() {
  const LiveState state = session_->state();
  if (state == LiveState::kHolding) {
    warn_once(hold_reported_, "stream", "frames are missing: holding the last pose");
  }
  if (state == LiveState::kStanding) {
    warn_once(stand_reported_, "stream", "frames are still missing: returning to standing");
  }
  if (session_->statistics().clock_jumps > 0) {
    warn_once(jump_reported_, "stream", "the sender's clock has jumped: following it");
  }
}

}  // namespace retarget
