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

/// Live retargeting: a stream of human frames in, robot frames out, with a bounded delay
/// (docs/live.md). The code never reads a clock. The caller passes the current time, so that a
/// replayed recording gives the same robot frames.

/// Solver of a live stream.
enum class LiveMode : unsigned char {
  kFrame,  ///< Solves each frame on arrival with the published two-pass inverse kinematics.
  kLag,    ///< Fits a sliding window of the latest frames: smoother, but delayed.
};

/// Source of frame timestamps.
enum class LiveClock : unsigned char {
  kSender,   ///< The timestamp in the frame.
  kArrival,  ///< The arrival time.
};

/// Limits on the change between two robot frames, given the time between them: the guarantee of
/// live mode (docs/live.md). The position and speed limits of the joints apply as well.
struct LiveLimits {
  double root_speed = 8.0;            ///< m/s
  double turn_speed = 15.0;           ///< Angular speed limit of the root, rad/s.
  double joint_acceleration = 400.0;  ///< rad/s^2
  double root_acceleration = 80.0;    ///< m/s^2
  double turn_acceleration = 300.0;   ///< Angular acceleration limit of the root, rad/s^2.
  double resume_joint_speed = 3.0;    ///< Joint speed limit right after an interruption, rad/s.
  double resume_root_speed = 1.0;     ///< Root speed limit right after an interruption, m/s.
  double resume_turn_speed = 2.0;     ///< Root turning limit right after an interruption, rad/s.
  double resume_s = 1.0;  ///< Seconds in which the resume limits ramp up to the full limits.
};

/// Options of a live session.
struct LiveOptions {
  LiveMode mode = LiveMode::kFrame;
  double lag_s = 0.2;    ///< Delay of kLag, seconds: a frame leaves at this age.
  double fps = 50.0;     ///< Rate of the robot frames, 1/s.
  double delay_s = 0.0;  ///< Minimum playout delay, seconds: absorbs network jitter.
  double hold_s =
      2.0;  ///< Seconds to hold the pose when the stream stalls, before returning to standing.
  LiveClock clock = LiveClock::kSender;
  bool limit_speeds =
      true;  ///< Apply `limits` while following; after an interruption they always apply.
  LiveLimits limits;
  bool floor = true;      ///< kFrame only: keep the lowest point on the floor.
  bool hold_feet = true;  ///< kFrame only: pull feet in contact to their contact positions.
};

/// Largest time of a caller's clock, seconds. Larger numbers do not resolve single frames.
inline constexpr double kMaxLiveTime = 1e12;
/// Whether a number is a time of a caller's clock. NaN and infinity are none.
[[nodiscard]] constexpr bool is_live_time(double seconds) {
  return seconds >= -kMaxLiveTime && seconds <= kMaxLiveTime;
}

/// A pose of the human with its time.
struct HumanFrame {
  /// Seconds on the sender's clock, with any origin; NaN: use the arrival time.
  double time = std::numeric_limits<double>::quiet_NaN();
  HumanPose world_from_bone;  ///< Metres, Z up.
};

/// State of the robot in a live session.
enum class LiveState : unsigned char {
  kWaiting,    ///< No frame has arrived yet.
  kFollowing,  ///< The robot follows the human.
  kHolding,    ///< Frames are missing: the robot holds its pose.
  kStanding,   ///< Frames are missing for longer than `hold_s`: the robot returns to standing.
};

/// A robot frame; valid until the next call to its session.
struct RobotFrame {
  std::int64_t index = 0;  ///< 0, 1, 2, ...
  double time = 0.0;  ///< Time of the human pose shown, seconds. It starts on the sender's clock
                      ///< and stays continuous when that clock steps.
  LiveState state = LiveState::kFollowing;
  std::span<const double>
      qpos;          ///< Configuration, layout of RobotClip; quaternions are sign-continuous.
  double due = 0.0;  ///< Time at which the frame is due, seconds on the caller's clock.
  /// Arrival time of the newest human frame shown, seconds on the caller's clock; NaN: no new one.
  double since = std::numeric_limits<double>::quiet_NaN();
};

/// Counters and timing estimates of a live session.
struct LiveStatistics {
  std::int64_t received = 0;
  std::int64_t bad = 0;  ///< Dropped: non-finite values or times, or the frame cannot be solved.
  std::int64_t doubled = 0;  ///< Dropped: duplicates.
  std::int64_t late =
      0;  ///< Dropped: a later frame was already used, or the timestamp is implausible.
  std::int64_t skipped =
      0;  ///< Dropped: arrived late together with later frames; skipped to catch up.
  /// Never arrived, inferred from the timestamps of the others; 0 without timestamps.
  std::int64_t lost = 0;
  int clock_jumps = 0;    ///< Steps of the sender's clock.
  int clock_anchors = 0;  ///< Times that offset and rate of the sender's clock were re-estimated.
  int teleports = 0;      ///< Implausibly large displacements of the human between two frames.
  int interruptions = 0;  ///< Gaps too long to bridge, stalls, teleports and changes of the body.
  /// Solver steps of kLag that were rejected because of non-finite values.
  std::int64_t failed_steps = 0;
  std::int64_t robot_frames = 0;
  std::int64_t held = 0;     ///< Robot frames without a human pose to follow.
  std::int64_t limited = 0;  ///< Robot frames changed by a speed or acceleration limit.
  std::int64_t missed = 0;   ///< Robot frames never sent because the caller did not pull them.
  double sender_rate = 1.0;  ///< Estimated seconds of the sender's clock per local second.
  double frame_rate = 0.0;   ///< Received frames per local second; 0: not known yet.
  double delay_s = 0.0;   ///< Age of the human pose shown last, relative to the fastest delivery.
  double jitter_s = 0.0;  ///< Mean delay of frames beyond the fastest delivery, seconds.
};

class OnlineSolver;

/// Retargets one stream. Use an object from one thread at a time.
class LiveSession {
 public:
  /// Creates a session.
  /// @param plan  result of make_plan, with its clip: a few frames of the performer, such as a
  ///   T-pose or a recording. Limb lengths are measured once from this clip. The plan's method
  ///   selects the targets: `gmr` uses the published ones, `fit` scales limbs and aligns limb
  ///   directions.
  /// @return kUsage errors: options out of range, kLag with the method `gmr`, a plan without
  ///     frames; errors of make_targets.
  [[nodiscard]] static Result<LiveSession> make(const Plan& plan, const LiveOptions& options = {});
  ~LiveSession();
  LiveSession(LiveSession&&) noexcept;
  LiveSession& operator=(LiveSession&&) noexcept;

  /// Adds a human frame.
  /// @param now  seconds on the caller's clock; must not decrease.
  void push(const HumanFrame& frame, double now);

  /// The next robot frame if one is due, else empty. After the first human frame, one is due every
  /// 1 / fps seconds, independent of the input. After every push, and when due() is reached, call
  /// it until it returns nothing. Returns nothing for an invalid time (is_live_time).
  [[nodiscard]] std::optional<RobotFrame> pull(double now);
  /// Time at which the next robot frame is due, unless a human frame arrives earlier; empty before
  /// the first human frame. Seconds on the caller's clock.
  [[nodiscard]] std::optional<double> due() const;
  /// Drops the robot frames that became due while the caller did not call pull for more than a
  /// frame. Without this call, pull returns them late.
  void skip_to(double now);

  /// Ends the stream: pull returns the remaining frames at once, then nothing.
  void finish();
  /// Restores the initial state, for another stream of the same body.
  void reset();
  /// Switches to another body or skeleton. The robot continues from its current configuration.
  /// @param plan  for the same robot.
  /// @return the errors of make; the session is then unchanged.
  [[nodiscard]] Result<void> recalibrate(const Plan& plan);

  /// A prepared body that a session can switch to.
  class Body {
   public:
    ~Body();
    Body(Body&&) noexcept;
    Body& operator=(Body&&) noexcept;

   private:
    friend class LiveSession;
    explicit Body(std::unique_ptr<OnlineSolver> made);
    std::unique_ptr<OnlineSolver> made_;
  };
  /// The slow part of recalibrate. It can run in another thread while the session continues.
  /// @param robot  robot of the session.
  [[nodiscard]] static Result<Body> prepare(const Plan& plan, const LiveOptions& options,
                                            const Robot& robot);
  /// The fast part of recalibrate: switches to a prepared body.
  void recalibrate(Body body);

  [[nodiscard]] const LiveStatistics& statistics() const;
  [[nodiscard]] LiveState state() const;
  [[nodiscard]] const Robot& robot() const;

 private:
  class Impl;
  explicit LiveSession(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Converts single frames of a plan's skeleton to the canonical human.
class LivePoser {
 public:
  explicit LivePoser(const Plan& plan);
  ~LivePoser();
  LivePoser(LivePoser&&) noexcept;
  LivePoser& operator=(LivePoser&&) noexcept;

  /// Computes the world poses of the bones.
  /// @param rotations        one per joint, as Clip::rotations.
  /// @param translations     one per joint with position channels, as Clip::translations.
  /// @param world_from_bone  output; metres, Z up.
  void pose(std::span<const Eigen::Quaterniond> rotations,
            std::span<const Eigen::Vector3d> translations, HumanPose& world_from_bone);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace retarget
