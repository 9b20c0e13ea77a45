#pragma once

#include <Eigen/Core>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "live/stream/file_axes.h"
#include "live/stream/stream_formats.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/live.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/pose.h"

namespace retarget {

/// The channels of a joint that moves and turns.
[[nodiscard]] std::vector<Channel> all_channels();

/// Whether two skeletons have the same joints and channels, regardless of bone lengths.
[[nodiscard]] bool have_same_joints(const Skeleton& a, const Skeleton& b);
/// Whether two clips have the same skeleton, unit, axes and height.
[[nodiscard]] bool is_same(const Clip& a, const Clip& b);
/// Whether frames of a skeleton can be read as those of another body until their own is recognised:
/// equal joints, unit and axes, and similar lengths.
[[nodiscard]] bool is_like(const Clip& a, const Clip& b);

/// A joint of a stream whose frames are world poses, metres.
struct StreamJoint {
  std::string name;
  int parent = -1;  ///< Precedes the joint; -1: the first joint only.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< Offset from the parent, in its axes.
};

/// The skeleton of such a stream; converts its frames to frames of this skeleton. A file of the
/// same skeleton named by the user takes precedence. It may have another unit, other axes, another
/// order of joints, and fixed offsets.
class StreamSkeleton {
 public:
  /// Sets the skeleton of the user's file.
  void know(std::shared_ptr<const Skeleton> skeleton) { known_ = std::move(skeleton); }
  [[nodiscard]] const Skeleton* known() const { return known_.get(); }
  /// Sets the up axis of its world.
  void know_up(const Eigen::Vector3d& up) { known_up_ = up; }

  /// Sets the joints of the following frames.
  /// @param up            up direction of the stream's world.
  /// @param is_rest_pose  whether the body is in a T-pose with all rotations zero.
  /// @param height        height of the body, metres, if the stream contains it.
  void set_joints(std::vector<StreamJoint> joints, const Eigen::Vector3d& up, bool is_rest_pose,
                  StreamSink& sink, std::optional<double> height = std::nullopt);
  [[nodiscard]] const std::vector<StreamJoint>& joints() const { return joints_; }
  void forget() { joints_.clear(); }

  /// @param time              sender's time, s; NaN: none.
  /// @param world_from_joint  poses in the order of the joints passed to set_joints().
  void give(double time, std::span<const Pose> world_from_joint, StreamSink& sink);

 private:
  [[nodiscard]] bool use_known(const Eigen::Vector3d& up);
  void use_received();

  std::shared_ptr<const Skeleton> known_;
  std::optional<Eigen::Vector3d> known_up_;
  std::vector<StreamJoint> joints_;

  // For each joint of the output frames: its index among the stream's joints, its parent among the
  // output joints, and its translation slot; -1: none.
  std::vector<std::size_t> sources_;
  std::vector<int> parents_, slots_;
  FileAxes axes_;  // Of the user's file; otherwise it changes nothing.
  StreamFrame frame_;
};

/// A recognised body, ready for use in a stream.
struct MadeBody {
  Plan plan;
  std::optional<LiveSession::Body> body;  ///< Body for a running session; empty for the first body.
};

/// A body to be recognised.
struct BodyTask {
  Clip clip;                        ///< Skeleton and a pose.
  RestPose rest = RestPose::kAuto;  ///< Meaning of the first frame.
  bool is_posed = false;            ///< The performer holds the pose on request.
  int poses_left = 0;               ///< Number of later poses to try if this one is refused.
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
