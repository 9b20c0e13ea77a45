#include "retarget/clip_range.h"

#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <system_error>
#include <vector>

#include "base/option_name.h"
#include "base/try.h"
#include "motion/lost_end.h"
#include "retarget/pose.h"

namespace retarget {
namespace {

// Tolerance of times, in frames.
constexpr double kTimeTolerance = 1e-6;

Failure bad_range(std::string_view text) {
  return usage_failure("the frame range \"" + std::string(text) + "\" does not have the form a:b",
                       "frames are numbered from 0 and b is excluded: 0:300, 120: or :300");
}

// Returns "no frames" or, for example, "frames 0 to 299".
std::string extent_text(int frame_count) {
  if (frame_count == 0) return "no frames";
  return "frames 0 to " + std::to_string(frame_count - 1);
}

// Parses an unsigned integer; empty text gives `fallback`. Returns nothing for other text. Numbers
// that do not fit into int are clamped.
std::optional<int> parse_bound(std::string_view text, int fallback) {
  if (text.empty()) return fallback;
  const bool digits = std::ranges::all_of(text, [](char c) { return '0' <= c && c <= '9'; });
  if (!digits) return std::nullopt;
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() ? value : std::numeric_limits<int>::max();
}

// Formats without trailing zeros, independently of the locale.
std::string seconds_text(double seconds) {
  return fmt::format("{:.9g} s", seconds);
}

Result<void> check_time(std::optional<double> time, const std::string& name) {
  if (!time || (std::isfinite(*time) && *time >= 0.0)) return {};
  return usage_failure("the " + name + " at " + seconds_text(*time) + " is not a valid time",
                       "times are in seconds from the first frame");
}

}  // namespace

Result<FrameRange> frame_range_from_text(std::string_view text, int frame_count) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return bad_range(text);
  const auto begin = parse_bound(text.substr(0, colon), 0);
  const auto end = parse_bound(text.substr(colon + 1), frame_count);
  if (!begin || !end) return bad_range(text);
  const std::string quoted = "the frame range \"" + std::string(text) + "\"";
  if (*begin >= frame_count) {
    return usage_failure(quoted + " begins after the end of the clip, which has " +
                         extent_text(frame_count));
  }
  if (*begin >= *end) {
    return usage_failure(quoted + " contains no frames",
                         "b is excluded; for a single frame, use a:b with b = a + 1");
  }
  return FrameRange{*begin, std::min(*end, frame_count)};
}

Result<FrameRange> frame_range_from_seconds(std::optional<double> start, std::optional<double> end,
                                            const FrameRate& rate, int frame_count) {
  TRY(check_time(start, "start"));
  TRY(check_time(end, "end"));
  if (start && end && *end < *start) {
    return usage_failure("the end at " + seconds_text(*end) + " comes before the start at " +
                         seconds_text(*start));
  }
  // Compares as real numbers first, because times may exceed any frame number.
  const double first = start ? std::ceil(*start * rate.fps() - kTimeTolerance) : 0.0;
  const double last = end ? std::floor(*end * rate.fps() + kTimeTolerance) : frame_count - 1.0;
  if (start && first >= frame_count) {
    const std::string extent = frame_count == 0
                                   ? "has no frames"
                                   : "ends at " + seconds_text(rate.time_of(frame_count - 1));
    return usage_failure("the start at " + seconds_text(*start) +
                         " is after the end of the clip, which " + extent);
  }
  if (start && last < first) {
    return usage_failure("no frame lies between " + seconds_text(*start) + " and " +
                         seconds_text(*end));
  }
  return FrameRange{static_cast<int>(first),
                    static_cast<int>(std::min(last, frame_count - 1.0)) + 1};
}

Result<FrameRange> chosen_range(const PartOptions& part, const FrameRate& rate, int frame_count) {
  const auto given = [](double seconds) {
    return seconds < 0.0 ? std::nullopt : std::optional<double>(seconds);
  };
  const auto start = given(part.start_s), end = given(part.end_s);
  if (!start && !end) {
    if (part.frames.empty()) return FrameRange{0, frame_count};
    return frame_range_from_text(part.frames, frame_count);
  }
  if (part.frames.empty()) return frame_range_from_seconds(start, end, rate, frame_count);
  return usage_failure(
      OPTION("frames") " and " OPTION("start") "/" OPTION("end") " both choose a part of the clip",
      "give only one of them");
}

std::vector<Warning> range_doubts(const PartOptions& part, const FrameRate& rate, int frame_count) {
  if (frame_count == 0) return {};
  const std::size_t colon = part.frames.find(':');
  if (colon != std::string::npos) {
    const auto end = parse_bound(std::string_view(part.frames).substr(colon + 1), frame_count);
    if (!end || *end - 1 <= frame_count) return {};
    return {{0, 0,
             "the frame range \"" + part.frames + "\" ends after the clip, which has " +
                 extent_text(frame_count) + ": it is cut there"}};
  }
  // The last frame lasts for one period.
  if (!(part.end_s * rate.fps() > frame_count + kTimeTolerance)) return {};
  return {{0, 0,
           "the end at " + seconds_text(part.end_s) + " is after the clip, which ends at " +
               seconds_text(rate.time_of(frame_count - 1)) + ": the part is cut there"}};
}

namespace {

constexpr double kJump = 0.1;          // Second difference, in spreads of the body.
constexpr double kBeyondMotion = 5.0;  // Second difference, relative to the motion's 95th
                                       // percentile.
constexpr double kStill = 0.05;        // Spreads from the first frame; allows for noise and a
                                       // standing person.
constexpr double kMaxHold = 20.0;      // Seconds.
constexpr double kMotionSeen = 2.0;    // Seconds.
// A pose held for longer than this must differ from the motion's poses; otherwise it is motion
// before a fault.
constexpr double kShortHold = 0.25;  // Seconds.
constexpr double kSamePose = 0.1;    // Spreads, after aligning position and rotation of the root.
constexpr int kMinAfter = 5;         // Frames of motion after the jump.

// The joints of the body, its root first: without helper joints above the hips and what else hangs
// from them. A helper that stays at the origin would count as part of a body that walks away.
std::vector<int> joints_of_body(const Skeleton& skeleton) {
  constexpr double kNearlyAll = 0.8;  // Of the joints; a spine with arms and head has fewer.
  const auto count = static_cast<std::size_t>(skeleton.joint_count());
  std::vector<int> sizes(count, 1);
  for (std::size_t joint = count; joint-- > 1;) {
    const int parent = skeleton.joint(static_cast<int>(joint)).parent;
    if (parent >= 0) sizes[static_cast<std::size_t>(parent)] += sizes[joint];
  }
  int root = 0;
  for (std::size_t joint = 1; joint < count; ++joint) {
    const bool below = skeleton.joint(static_cast<int>(joint)).parent == root;
    if (below && sizes[joint] > kNearlyAll * static_cast<double>(count)) {
      root = static_cast<int>(joint);
    }
  }
  std::vector<int> joints;
  std::vector<char> inside(count);
  for (int joint = root; joint < skeleton.joint_count(); ++joint) {
    const int parent = skeleton.joint(joint).parent;
    if (joint != root && (parent < 0 || inside[static_cast<std::size_t>(parent)] == 0)) continue;
    inside[static_cast<std::size_t>(joint)] = 1;
    joints.push_back(joint);
  }
  return joints;
}

// World positions of the body's joints by frame, computed on demand.
class Positions {
 public:
  explicit Positions(const Clip& clip)
      : clip_(clip),
        joints_(joints_of_body(clip.skeleton())),
        frames_(static_cast<std::size_t>(clip.frame_count())),
        root_turns_(frames_.size()),
        poses_(static_cast<std::size_t>(clip.skeleton().joint_count())) {}

  const Eigen::Matrix3Xd& at(int frame) {
    Eigen::Matrix3Xd& positions = frames_[static_cast<std::size_t>(frame)];
    if (positions.size() > 0) return positions;
    forward_kinematics(clip_, frame, poses_);
    const auto pose_of = [&](std::size_t i) -> const Pose& {
      return poses_[static_cast<std::size_t>(joints_[i])];
    };
    root_turns_[static_cast<std::size_t>(frame)] = pose_of(0).rotation;
    positions.resize(3, static_cast<Eigen::Index>(joints_.size()));
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      positions.col(static_cast<Eigen::Index>(i)) = pose_of(i).translation;
    }
    return positions;
  }

  // Mean joint distance of two frames, relative to the root.
  double pose_distance(int a, int b) {
    return (seen_by_root(a) - seen_by_root(b)).colwise().norm().mean();
  }
  double distance(int a, int b) { return (at(a) - at(b)).colwise().norm().mean(); }

  // step() and second_difference() are means over the joints; spread() is a root mean square.
  double step(int frame) { return (at(frame + 1) - at(frame)).colwise().norm().mean(); }
  double second_difference(int frame) {
    return (at(frame - 1) - 2.0 * at(frame) + at(frame + 1)).colwise().norm().mean();
  }
  double spread(int frame) {
    const Eigen::Matrix3Xd& positions = at(frame);
    const Eigen::Vector3d middle = positions.rowwise().mean();
    return std::sqrt((positions.colwise() - middle).colwise().squaredNorm().mean());
  }

 private:
  Eigen::Matrix3Xd seen_by_root(int frame) {
    const Eigen::Matrix3Xd& positions = at(frame);
    const Eigen::Matrix3d root_from_world =
        root_turns_[static_cast<std::size_t>(frame)].conjugate().toRotationMatrix();
    return root_from_world * (positions.colwise() - positions.col(0));
  }

  const Clip& clip_;
  const std::vector<int> joints_;
  std::vector<Eigen::Matrix3Xd> frames_;
  std::vector<Eigen::Quaterniond> root_turns_;
  std::vector<Pose> poses_;
};

// Whether the motion begins at frame `begin`, with a jump from the frame before.
bool begins_with_a_jump(const Clip& clip, Positions& positions, int begin) {
  if (clip.frame_count() - begin < kMinAfter) return false;
  const double jump = positions.second_difference(begin);
  if (!(jump > kJump * positions.spread(begin))) return false;
  // The frame before a jump has an equally large second difference; a jump may take two frames.
  if (positions.step(begin - 1) < 0.5 * positions.step(begin)) return false;
  const int end = std::min(
      clip.frame_count() - 1,
      begin + 1 +
          std::max(kMinAfter, static_cast<int>(std::lround(kMotionSeen * clip.rate().fps()))));
  std::vector<double> after;
  for (int frame = begin + 1; frame < end; ++frame) {
    after.push_back(positions.second_difference(frame));
  }
  std::ranges::sort(after);
  return jump > kBeyondMotion * after[(95 * (after.size() - 1)) / 100];
}

bool has_no_rotation(const Clip& clip, int frame) {
  constexpr double kNoTurn = 1e-9;
  return std::ranges::all_of(clip.rotations(frame), [](const Eigen::Quaterniond& rotation) {
    return rotation.vec().norm() < kNoTurn;
  });
}

// Whether all rotations of a frame are zero and the next frame leaves it by a jump, which real
// recordings do not do.
bool is_frame_of_zeros(const Clip& clip, Positions& positions, int frame) {
  if (!has_no_rotation(clip, frame) || has_no_rotation(clip, frame + 1)) return false;
  const double step = positions.step(frame);
  const double next = frame + 2 < clip.frame_count() ? positions.step(frame + 1) : 0.0;
  return step > kJump * positions.spread(frame + 1) && step > kBeyondMotion * next;
}

// Whether the motion after `begin` returns to a pose within kMotionSeen.
bool comes_back(const Clip& clip, Positions& positions, int pose, int begin) {
  const double near = kSamePose * positions.spread(pose);
  const int end = std::min<int>(
      clip.frame_count(), begin + static_cast<int>(std::lround(kMotionSeen * clip.rate().fps())));
  for (int frame = begin; frame < end; ++frame) {
    if (positions.pose_distance(pose, frame) < near) return true;
  }
  return false;
}

// Number of static frames from `begin` that end with a jump; 0 if there are none.
int count_held(const Clip& clip, Positions& positions, int begin) {
  const auto longest =
      static_cast<int>(std::min(kMaxHold * clip.rate().fps(), 1.0 * clip.frame_count()));
  for (int count = 1; count <= std::max(1, longest); ++count) {
    if (begin + count >= clip.frame_count()) return 0;
    if (is_frame_of_zeros(clip, positions, begin + count - 1)) return count;
    if (begins_with_a_jump(clip, positions, begin + count)) {
      const bool is_short = count * clip.rate().frame_time() <= kShortHold;
      return is_short || !comes_back(clip, positions, begin, begin + count) ? count : 0;
    }
    if (!(positions.distance(begin, begin + count) <= kStill * positions.spread(begin))) return 0;
  }
  return 0;
}

}  // namespace

int count_lead_in_frames(const Clip& clip) {
  // For example a frame of zeros and a T-pose.
  constexpr int kMaxHolds = 3;
  Positions positions(clip);
  int count = 0;
  for (int hold = 0; hold < kMaxHolds; ++hold) {
    const int held = count_held(clip, positions, count);
    if (held == 0) break;
    count += held;
  }
  return count;
}

int count_lost_end_frames(const Clip& clip) {
  int begin = clip.frame_count();
  while (begin > 0 && has_no_rotation(clip, begin - 1)) --begin;
  if (begin == clip.frame_count() || begin < kMinAfter) return 0;
  Positions positions(clip);
  const double jump = positions.step(begin - 1);
  const bool is_lost = jump > kJump * positions.spread(begin - 1) &&
                       jump > kBeyondMotion * positions.step(begin - 2);
  return is_lost ? clip.frame_count() - begin : 0;
}

}  // namespace retarget
