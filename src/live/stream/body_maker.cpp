#include "live/stream/body_maker.h"

#include <chrono>
#include <exception>
#include <utility>

#include "retarget/try.h"

namespace retarget {

Result<MadeBody> BodyMaker::make(const BodyTask& task, bool is_first) const {
  Options run = run_;
  if (run.human.rest == RestPose::kAuto && run.human.tpose_file.empty()) {
    run.human.rest = task.rest;
  }
  Clip clip = task.clip;
  if (clip.frame_count() == 0) clip.resize(1);
  MadeBody made;
  RETARGET_TRY_ASSIGN(made.plan, make_plan(std::move(clip), robot_, run));
  if (is_first) return made;
  RETARGET_TRY_ASSIGN(made.body, LiveSession::prepare(made.plan, live_, *made.plan.robot.robot));
  return made;
}

void BodyMaker::start(BodyTask task) {
  task_ = std::move(task);
  result_ = std::async(std::launch::async, [this] { return make(*task_, false); });
}

bool BodyMaker::is_ready() const {
  return is_busy() && result_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace retarget
