#include "stream/live_pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/number_text.h"
#include "base/printable.h"
#include "base/try.h"

namespace retarget {
namespace {

bool same_skeleton(const Skeleton& a, const Skeleton& b) {
  return std::ranges::equal(a.joints(), b.joints(), [](const Joint& one, const Joint& other) {
    return one.name == other.name && one.parent == other.parent && one.offset == other.offset &&
           one.channels == other.channels;
  });
}

}  // namespace

LivePipeline::LivePipeline(RobotSetup robot, LivePipelineOptions options,
                           std::unique_ptr<Decoder> decoder, TakeFrame take_frame, Tell tell)
    : robot_(std::move(robot)),
      options_(std::move(options)),
      decoder_(std::move(decoder)),
      take_robot_frame_(std::move(take_frame)),
      tell_(std::move(tell)),
      calibrates_(options_.calibrate != LiveCalibration::kAuto) {}

LivePipeline::~LivePipeline() = default;

Result<void> LivePipeline::know_skeleton(Clip clip) {
  decoder_->know_skeleton(clip.shared_skeleton());
  take_skeleton(std::move(clip), false);
  if (error_) return failure(std::move(*std::exchange(error_, std::nullopt)));
  return {};
}

Result<void> LivePipeline::packet(std::string_view bytes, double now) {
  // as though it had been asked for just before
  tick(now);
  ++packets_.packets;
  if (const auto taken = decoder_->take(bytes, *this); !taken) {
    ++packets_.malformed;
    tell_once(malformed_told_, "stream",
              "a packet is left out, and every one like it: " + printable(taken.error().message));
  }
  if (error_) return failure(std::move(*std::exchange(error_, std::nullopt)));
  tick(now);
  return {};
}

void LivePipeline::tick(double now) {
  now_ = now;
  if (!session_) return;
  while (const auto frame = session_->pull(now)) take_robot_frame_(*frame);
  tell_changes();
}

void LivePipeline::restart_sender(double now) {
  tick(now);
  decoder_->restart();
}

void LivePipeline::recalibrate(double now) {
  tick(now);
  calibrates_ = true;
  calibration_begin_.reset();
  tell_("body", fmt::format("stand in a T-pose: in {} s it counts",
                            number_text(options_.calibrate_after_s, 1)));
}

void LivePipeline::finish(double now) {
  tick(now);
  if (!session_) return;
  session_->finish();
  tick(now);
}

LiveStatistics LivePipeline::statistics() const {
  return session_ ? session_->statistics() : LiveStatistics();
}

void LivePipeline::take_skeleton(Clip clip, bool has_rest) {
  // senders tell it again and again
  if (session_ && skeleton_ && same_skeleton(skeleton_->skeleton(), clip.skeleton())) return;
  ++packets_.skeletons;
  skeleton_ = clip;
  calibration_begin_.reset();
  if (calibrates_) return;
  if (clip.frame_count() == 0) clip.resize(1);
  const RestPose rest = has_rest ? RestPose::kFirst : RestPose::kAuto;
  if (auto begun = begin_session(std::move(clip), rest); !begun) error_ = std::move(begun.error());
}

Result<void> LivePipeline::begin_session(Clip clip, RestPose rest) {
  Options run = options_.run;
  if (run.human.rest == RestPose::kAuto && run.human.tpose_file.empty()) run.human.rest = rest;
  TRY_ASSIGN(const Plan plan, make_plan(std::move(clip), robot_, run));
  for (const auto& [label, text] : plan.human.lines()) tell_(label, text);
  poser_.emplace(plan);
  if (session_) return session_->recalibrate(plan);
  TRY_ASSIGN(session_, LiveSession::make(plan, options_.live));
  return {};
}

// Whether the frame was one of those before the pose that counts.
bool LivePipeline::collects(const StreamFrame& frame) {
  if (!calibrates_) return false;
  if (!calibration_begin_) calibration_begin_ = now_;
  if (now_ - *calibration_begin_ < options_.calibrate_after_s) return true;
  calibrates_ = false;
  Clip pose = skeleton_->empty_like(skeleton_->rate(), 1);
  std::ranges::copy(frame.rotations, pose.rotations(0).begin());
  std::ranges::copy(frame.translations, pose.translations(0).begin());
  if (auto begun = begin_session(std::move(pose), RestPose::kFirst); !begun) {
    // a stream that runs goes on as it was calibrated
    if (!session_) {
      error_ = std::move(begun.error());
    } else {
      tell_("body", "stays as it is: " + full_message(begun.error()));
    }
  }
  return !session_;
}

void LivePipeline::take_frame(const StreamFrame& frame) {
  if (error_ || !skeleton_) return;
  if (frame.rotations.size() != static_cast<std::size_t>(skeleton_->skeleton().joint_count())) {
    ++packets_.malformed;
    return;
  }
  // while a stream that runs waits for its new pose it goes on
  if (collects(frame) && !session_) return;
  if (!session_ || !poser_) return;
  human_.time = frame.time;
  poser_->pose(frame.rotations, frame.translations, human_.world_from_bone);
  session_->push(human_, now_);
}

void LivePipeline::tell_once(bool& told, std::string_view label, std::string_view text) const {
  if (!std::exchange(told, true)) tell_(label, text);
}

// each kind once, for streams that come and go: the summary counts them
void LivePipeline::tell_changes() {
  const LiveState state = session_->state();
  if (state == LiveState::kHolding) {
    tell_once(hold_told_, "stream", "frames are missing: the robot is held meanwhile");
  }
  if (state == LiveState::kStanding) {
    tell_once(stand_told_, "stream", "frames are missing for long: the robot comes to stand");
  }
  if (session_->statistics().clock_jumps > 0) {
    tell_once(jump_told_, "stream", "the sender's clock has jumped: the robot goes on");
  }
}

}  // namespace retarget
