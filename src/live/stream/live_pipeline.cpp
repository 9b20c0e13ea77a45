#include "live/stream/live_pipeline.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "live/session/playout.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Frames due before a packet arrives leave before it; frames due at its time include it.
constexpr double kJustBefore = 2e-6;  // seconds
// Maximum number of frames in one packet at clock pace.
constexpr std::size_t kMostFrames = 128;

// Why frames of a stream are not frames of a file's skeleton.
std::string difference(const Skeleton& file, const Skeleton& stream) {
  const auto missing = [](const Skeleton& from, const Skeleton& in) -> const Joint* {
    const auto found = std::ranges::find_if(from.joints(), [&](const Joint& joint) {
      return std::ranges::find(in.joints(), joint.name, &Joint::name) == in.joints().end();
    });
    return found == from.joints().end() ? nullptr : &*found;
  };
  if (const Joint* joint = missing(file, stream)) {
    return fmt::format("it has no joint \"{}\"", printable(joint->name));
  }
  if (const Joint* joint = missing(stream, file)) {
    return fmt::format("the file has no joint \"{}\"", printable(joint->name));
  }
  return "their joints have other parents or channels";
}

// Minimum interval between two recognitions of a body.
constexpr double kBodyEvery = 1.0;  // seconds
// Poses of a new skeleton that are tried before a running stream returns to its previous body.
constexpr int kMostPoses = 5;
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

void LivePipeline::recalibrate(double now) {
  tick(now);
  calibrates_ = true;
  calibration_begin_.reset();
  tell_("body", fmt::format("hold a T-pose; calibrating in {} s",
                            number_text(options_.calibrate_after_s, 1)));
}

void LivePipeline::finish(double now) {
  tick(now);
  if (!session_) return;
  session_->finish();
  pull(now_);
}

Result<void> LivePipeline::check_used(std::string_view format) const {
  // In lag mode, a short stream at clock pace ends before its first robot frame.
  const LiveStatistics now = statistics();
  const bool is_used = now.received > now.bad + now.late + now.doubled;
  if (is_used || now.robot_frames > 0 || packets_.packets == 0) return {};
  std::string why = fmt::format("no frame of the stream is usable: {} of {} malformed",
                                packets_.malformed, count_text(packets_.packets, "packet"));
  if (!malformed_why_.empty()) why += ", the first one: " + printable(malformed_why_);
  if (!session_ && !refused_why_.empty()) why += "; no human: " + refused_why_;
  if (!session_ && calibrates_) why += "; the input ended before the calibration";
  const std::string_view likely = likely_format(malformed_head_);
  if (likely.empty() || likely == format) return input_failure("stdin", why);
  return input_failure("stdin", why,
                       fmt::format("the input looks like {0}: use stdin?format={0}", likely));
}

LiveStatistics LivePipeline::statistics() const {
  return session_ ? session_->statistics() : LiveStatistics();
}

void LivePipeline::take_skeleton(const Clip& clip, bool has_rest) {
  // Senders repeat the skeleton.
  if (session_ && received_ && is_same(*received_, clip)) {
    lacks_skeleton_ = false;
    return;
  }
  ++packets_.skeletons;
  if (refused_ && is_same(*refused_, clip)) {
    ++packets_.refused_skeletons;
    restores_ = used_.has_value();
    return;
  }
  lacks_skeleton_ = false;
  received_ = clip;
  calibration_begin_.reset();
  poseless_.reset();
  if (calibrates_) return;
  BodyTask task{clip, has_rest ? RestPose::kFirst : RestPose::kAuto, false};
  if (clip.frame_count() == 0) {
    task.poses_left = kMostPoses;
    poseless_ = std::move(task);
    old_frames_ = 0;
    pose_tried_ = -std::numeric_limits<double>::infinity();
    return;
  }
  change_body(std::move(task));
}

// Tells the user that the recognised skeleton of the stream replaces that of a file.
void LivePipeline::warn_of_unused_file(const Clip& used) {
  if (!known_ || used.shared_skeleton() == known_) return;
  warn_once(file_reported_, "body",
            fmt::format("the stream's own skeleton is used instead of " RETARGET_OPTION(
                            "skeleton") ", because {}",
                        difference(*known_, used.skeleton())));
}

// Recognises a body from its first frame, because the zero pose of a skeleton without poses may be
// folded up. If that frame is not recognised as human, tries later frames: a running stream only
// some, then it returns to its previous body.
void LivePipeline::take_first_pose(const StreamFrame& frame) {
  if (!poseless_ || wall_ - pose_tried_ < kBodyEvery) return;
  pose_tried_ = wall_;
  BodyTask task = *poseless_;
  task.clip.resize(1);
  std::ranges::copy(frame.rotations, task.clip.rotations(0).begin());
  std::ranges::copy(frame.translations, task.clip.translations(0).begin());
  if (session_) {
    --task.poses_left;
    poseless_.reset();
    change_body(std::move(task));
    return;
  }
  change_body(std::move(task));
  if (session_ || error_) poseless_.reset();
}

Result<void> LivePipeline::begin_session(const BodyTask& task) {
  RETARGET_TRY_ASSIGN(MadeBody made, maker_.make(task, true));
  RETARGET_TRY_ASSIGN(session_, LiveSession::make(made.plan, options_.live));
  warn_of_unused_file(task.clip);
  for (const auto& [label, text] : made.plan.human.lines()) tell_(label, text);
  poser_.emplace(made.plan);
  up_ = made.plan.human.calibration.up.direction();
  used_ = received_;
  refused_.reset();
  skeleton_packets_.accept();
  return {};
}

// Switches to another body: at once, or in the background while the robot continues.
void LivePipeline::change_body(BodyTask task) {
  if (!session_) {
    auto begun = begin_session(task);
    if (begun) return;
    // Incompatible options are the user's error; invalid input from a sender is not.
    if (begun.error().kind == ErrorKind::kUsage) {
      error_ = std::move(begun.error());
    } else {
      refuse(task, begun.error());
    }
    return;
  }
  if (!options_.in_background) {
    adopt(task, maker_.make(task, false));
    return;
  }
  waiting_ = std::move(task);
}

void LivePipeline::start_waiting_body() {
  if (!waiting_ || maker_.is_busy() || wall_ - looked_ < kBodyEvery) return;
  looked_ = wall_;
  maker_.start(std::move(*std::exchange(waiting_, std::nullopt)));
}

void LivePipeline::take_body(double now) {
  if (!maker_.is_busy()) return;
  tick(now);
  adopt(maker_.task(), maker_.take());
  start_waiting_body();
}

void LivePipeline::adopt(const BodyTask& task, Result<MadeBody> made) {
  if (!made) {
    refuse(task, made.error());
    return;
  }
  warn_of_unused_file(task.clip);
  for (const auto& [label, text] : made->plan.human.lines()) tell_(label, text);
  poser_.emplace(made->plan);
  session_->recalibrate(std::move(*made->body));
  used_ = task.clip;
  refused_.reset();
  if (task.is_posed) return;
  known_.reset();
  // Accept unless another skeleton has arrived meanwhile.
  if (!waiting_) skeleton_packets_.accept();
}

// Refuses a body; a running stream keeps its current one.
void LivePipeline::refuse(const BodyTask& task, const Error& why) {
  ++packets_.refused_skeletons;
  refused_why_ = full_message(why);
  if (task.is_posed && session_) {
    tell_("body", "remains unchanged: " + refused_why_);
    return;
  }
  warn_of_refusal(refused_why_);
  if (task.is_posed) return;
  if (session_ && task.poses_left > 0 && !waiting_ && is_same(*received_, task.clip)) {
    poseless_ = task;
    return;
  }
  refused_ = task.clip;
  // Unless another skeleton has arrived meanwhile.
  if (!used_ || waiting_ || poseless_) return;
  received_ = used_;
  restores_ = true;
}

void LivePipeline::warn_of_refusal(const std::string& why) {
  warn_once(refused_reported_, "body",
            (session_ ? "remains unchanged (similar skeletons are not reported): "
                      : "waiting for a human (similar skeletons are not reported): ") +
                why);
}

// Returns to the body in use, because the new skeleton is not that of the stream. It may be tried
// again, because no pose of it was refused.
void LivePipeline::drop_poseless() {
  ++packets_.refused_skeletons;
  refused_why_ = "a new skeleton arrived, but the frames are still those of the body in use";
  warn_of_refusal(refused_why_);
  poseless_.reset();
  received_ = used_;
  reads_old_ = false;
}

// Whether the frame precedes the calibration pose.
bool LivePipeline::collects(const StreamFrame& frame) {
  if (!calibrates_) return false;
  if (!calibration_begin_) calibration_begin_ = now_;
  if (now_ - *calibration_begin_ < options_.calibrate_after_s) return true;
  calibrates_ = false;
  Clip pose = received_->empty_like(received_->rate(), 1);
  std::ranges::copy(frame.rotations, pose.rotations(0).begin());
  std::ranges::copy(frame.translations, pose.translations(0).begin());
  const bool begins = !session_;
  change_body({std::move(pose), RestPose::kFirst, true});
  // If the pose is not recognised as human, wait for another one.
  if (begins && !session_) {
    calibrates_ = true;
    calibration_begin_.reset();
  }
  return !session_;
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
    warn_once(pace_reported_, "stream",
              "the frames have no timestamps and arrive faster than in real time, so the robot's "
              "motion is too short: state their rate (stdin?format=bvh&fps=30) or their times");
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
  session_->push(human_, now_);
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
