// The bodies of a LivePipeline: their skeletons, their recognition and their calibration.

#include <fmt/format.h>
#include <algorithm>
#include <cstddef>
#include <utility>

#include "live/stream/live_pipeline.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

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

// Poses of a new skeleton that are tried before a running stream returns to its previous body.
constexpr int kMostPoses = 5;

}  // namespace

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
  use_body(made.plan);
  rest_ = task.rest;
  up_ = made.plan.human.calibration.up.direction();
  used_ = received_;
  refused_.reset();
  skeleton_packets_.accept();
  return {};
}

void LivePipeline::use_body(const Plan& plan) {
  poser_.emplace(plan);
  pose_ = plan.clip->empty_like(plan.clip->rate(), 1);
  std::ranges::copy(plan.clip->rotations(0), pose_->rotations(0).begin());
  std::ranges::copy(plan.clip->translations(0), pose_->translations(0).begin());
  HumanPose body;
  poser_->pose(pose_->rotations(0), pose_->translations(0), body);
  size_.emplace(plan.human.calibration, body);
}

// Whether a frame, which human_ has, may be of the body in use. A body of another size is
// calibrated from the frame, as the skeleton of another body would be.
bool LivePipeline::has_size_of_body(const StreamFrame& frame) {
  switch (size_->add(human_.world_from_bone)) {
    case BodyMatch::Fit::kSame:
      return true;
    case BodyMatch::Fit::kOther:
      resize_body(frame);
      return true;
    case BodyMatch::Fit::kNoPerson:
      break;
  }
  ++packets_.malformed;
  warn_once(unit_reported_, "body",
            fmt::format("frames are dropped whose limbs are {} times as long as those of the "
                        "calibrated body: they look like another unit; send its skeleton first",
                        number_text(size_->ratio(), size_->ratio() < 1.0 ? 4 : 1)));
  return false;
}

void LivePipeline::resize_body(const StreamFrame& frame) {
  if (poseless_ || waiting_ || maker_.is_busy()) return;
  const double ratio = size_->ratio();
  warn_once(
      size_reported_, "body",
      fmt::format("the limbs of the frames are {} times as long as those of the calibrated "
                  "body: calibrating again for another performer (further changes are not "
                  "reported); a new skeleton or " RETARGET_OPTION("calibrate") " is more exact",
                  number_text(ratio, 2)));
  // The pose of the known body with the lengths of the frame.
  Clip pose = *pose_;
  std::ranges::copy(frame.translations, pose.translations(0).begin());
  const int root = pose.skeleton().translation_slot(0);
  if (root >= 0) {
    const auto slot = static_cast<std::size_t>(root);
    pose.translations(0)[slot] = ratio * pose_->translations(0)[slot];
  }
  change_body({std::move(pose), rest_, true});
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
  use_body(made->plan);
  session_->recalibrate(std::move(*made->body));
  used_ = task.clip;
  rest_ = task.rest;
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

void LivePipeline::recalibrate(double now) {
  tick(now);
  calibrates_ = true;
  calibration_begin_.reset();
  tell_("body", fmt::format("hold a T-pose; calibrating in {} s",
                            number_text(options_.calibrate_after_s, 1)));
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

}  // namespace retarget
