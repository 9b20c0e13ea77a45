#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/plan.h"
#include "retarget/robot.h"

namespace RETARGET_API retarget {

/// A stream of a human's frames in, a robot's frames out, within a bounded delay (docs/live.md).
/// Nothing here looks at a clock: the caller says what time it is, so that a recorded stream gives
/// the same frames again.

/// How a stream is solved.
enum class LiveMode : unsigned char {
  kFrame,  ///< Each frame as it comes: the published two passes of inverse kinematics.
  kLag,    ///< The fit of whole clips, on a window of the latest frames: smoother, later.
};

/// Where the time of a frame comes from.
enum class LiveClock : unsigned char {
  kSender,   ///< The frame's own stamp.
  kArrival,  ///< When it came in.
};

struct LiveOptions {
  LiveMode mode = LiveMode::kFrame;
  double lag_s = 0.2;    ///< Of kLag, seconds: a frame leaves when it is so old.
  double fps = 50.0;     ///< Of the robot's frames.
  double delay_s = 0.0;  ///< Robot frames wait so long for theirs: more, and they come evenly.
  double hold_s = 2.0;   ///< A stream that stalls is held so long; then the robot comes to stand.
  LiveClock clock = LiveClock::kSender;
  bool limit_speeds = true;  ///< No joint faster than its limit, no jump after an interruption.
  bool floor = true;         ///< Of kFrame: the lowest point stays on the floor.
  bool hold_feet = true;     ///< Of kFrame: feet in contact are drawn to their places.
};

/// A human at a time.
struct HumanFrame {
  /// Seconds by the sender's clock, from any origin; not a number: when it arrives.
  double time = std::numeric_limits<double>::quiet_NaN();
  HumanPose world_from_bone;  ///< Metres, Z up.
};

/// What a stream's robot does.
enum class LiveState : unsigned char {
  kWaiting,    ///< No frame came yet.
  kFollowing,  ///< The human.
  kHolding,    ///< Frames are missing: it stays as it is.
  kStanding,   ///< They are missing for long: it comes to stand, and stands.
};

/// A robot at a time; valid until the next call of its session.
struct RobotFrame {
  std::int64_t index = 0;  ///< 0, 1, 2, ...
  double time = 0.0;       ///< Of the human that it shows, seconds by the sender's clock at first.
  LiveState state = LiveState::kFollowing;
  std::span<const double> qpos;  ///< In the layout of RobotClip, quaternions sign-continuous.
};

/// What became of a stream's frames.
struct LiveStatistics {
  std::int64_t received = 0;
  std::int64_t bad = 0;      ///< Left out: values that are no numbers, or cannot be solved.
  std::int64_t doubled = 0;  ///< Left out: came before.
  std::int64_t late = 0;     ///< Left out: a later one had been used.
  std::int64_t lost = 0;     ///< Never came, by the stamps of those that did.
  int clock_jumps = 0;
  int interruptions = 0;  ///< Gaps too long to be bridged, stalls, and other bodies.
  std::int64_t robot_frames = 0;
  std::int64_t held = 0;     ///< Of these, without a human.
  std::int64_t limited = 0;  ///< Of these, kept back by a limit of speed.
};

/// One stream. An object belongs to one thread at a time.
class LiveSession {
 public:
  /// @param plan  from make_plan, with its clip: a few frames of the body that will move, such as its
  ///     T-pose, or a recording of it. Limbs are measured there once. Its method decides what the
  ///     robot is asked: `gmr` as published, `fit` by limbs and lines.
  /// Errors: kUsage: options out of range, a lag with the method `gmr`; those of make_targets.
  [[nodiscard]] static Result<LiveSession> make(const Plan& plan, const LiveOptions& options = {});
  ~LiveSession();
  LiveSession(LiveSession&&) noexcept;
  LiveSession& operator=(LiveSession&&) noexcept;

  /// Takes a frame.
  /// @param now  seconds by the caller's clock, which never goes back.
  void push(const HumanFrame& frame, double now);

  /// The next robot frame that is due; nothing: none yet. Call it until there is none, after every
  /// push and now and then without one.
  [[nodiscard]] std::optional<RobotFrame> pull(double now);

  /// No more frames will come: pull gives what is left, then nothing.
  void finish();
  /// As made, for another stream of the same body.
  void reset();
  /// The body or its skeleton is another one from now on. The robot goes on from where it is.
  /// @param plan  for the same robot. Errors as make's, after which all is as before.
  [[nodiscard]] Result<void> recalibrate(const Plan& plan);

  [[nodiscard]] const LiveStatistics& statistics() const;
  [[nodiscard]] LiveState state() const;
  [[nodiscard]] const Robot& robot() const;

 private:
  class Impl;
  explicit LiveSession(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// The canonical human in single frames of a plan's skeleton.
class LivePoser {
 public:
  explicit LivePoser(const Plan& plan);
  ~LivePoser();
  LivePoser(LivePoser&&) noexcept;
  LivePoser& operator=(LivePoser&&) noexcept;

  /// @param rotations     one per joint, as Clip::rotations.
  /// @param translations  of the joints that have position channels, as Clip::translations.
  void pose(std::span<const Eigen::Quaterniond> rotations,
            std::span<const Eigen::Vector3d> translations, HumanPose& world_from_bone);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace retarget
