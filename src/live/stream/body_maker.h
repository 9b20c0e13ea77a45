#pragma once

#include <future>
#include <optional>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/live.h"
#include "retarget/options.h"
#include "retarget/plan.h"

namespace retarget {

/// A recognised body, ready for use in a stream.
struct MadeBody {
  Plan plan;
  std::optional<LiveSession::Body> body;  ///< For a running session; empty for the first body.
};

/// A body to be recognised.
struct BodyTask {
  Clip clip;                        ///< Skeleton and a pose.
  RestPose rest = RestPose::kAuto;  ///< Meaning of the first frame.
  bool is_posed = false;            ///< The performer holds the pose on request.
};

/// Recognises a human and prepares the robot for it, on another thread if robot frames must
/// continue.
class BodyMaker {
 public:
  BodyMaker(RobotSetup robot, Options run, LiveOptions live)
      : robot_(std::move(robot)), run_(std::move(run)), live_(live) {}

  /// Recognises a body synchronously.
  /// @param is_first  no session is running that would need a LiveSession::Body.
  [[nodiscard]] Result<MadeBody> make(const BodyTask& task, bool is_first) const;

  /// Recognises a body on another thread. @pre not busy
  void start(BodyTask task);
  [[nodiscard]] bool is_busy() const { return result_.valid(); }
  [[nodiscard]] bool is_ready() const;
  [[nodiscard]] const BodyTask& task() const { return *task_; }
  /// Returns the result; waits for it. @pre busy
  [[nodiscard]] Result<MadeBody> take() { return result_.get(); }

 private:
  RobotSetup robot_;
  Options run_;
  LiveOptions live_;
  std::optional<BodyTask> task_;
  std::future<Result<MadeBody>> result_;
};

}  // namespace retarget
