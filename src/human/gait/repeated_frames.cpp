#include "human/gait/repeated_frames.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "human/gait/bridge_frames.h"
#include "retarget/so3.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

// Sum of the rotation angles of all joints from a frame to another one.
double turn_between(const Clip& clip, int a, int b) {
  const auto from = std::as_const(clip).rotations(a);
  const auto to = std::as_const(clip).rotations(b);
  double sum = 0.0;
  for (std::size_t joint = 0; joint < from.size(); ++joint) {
    sum += log_so3(from[joint].conjugate() * to[joint]).norm();
  }
  return sum;
}

// The same to the next frame.
double turn_of_body(const Clip& clip, int frame) {
  return turn_between(clip, frame, frame + 1);
}

// Cosine between the rotations of all joints in the steps after two frames; -1: the body turns back.
double likeness_of_steps(const Clip& clip, int a, int b) {
  double product = 0.0, first = 0.0, second = 0.0;
  for (std::size_t joint = 0; joint < clip.rotations(a).size(); ++joint) {
    const auto step = [&](int frame) {
      return log_so3(clip.rotations(frame)[joint].conjugate() * clip.rotations(frame + 1)[joint]);
    };
    product += step(a).dot(step(b));
    first += step(a).squaredNorm();
    second += step(b).squaredNorm();
  }
  const double lengths = std::sqrt(first * second);
  return lengths > 0.0 ? product / lengths : 0.0;
}

bool equal_rotations(const Clip& clip, int a, int b) {
  const auto same = [](const Eigen::Quaterniond& p, const Eigen::Quaterniond& q) {
    return p.coeffs() == q.coeffs();
  };
  return std::ranges::equal(clip.rotations(a), clip.rotations(b), same);
}

bool equal_frames(const Clip& clip, int a, int b) {
  return equal_rotations(clip, a, b) &&
         std::ranges::equal(clip.translations(a), clip.translations(b));
}

// By frame of the part, except its last: turn_of_body().
std::vector<double> turns_of_body(const Clip& clip, FrameRange part) {
  std::vector<double> turns;
  for (int frame = part.begin; frame + 1 < part.end; ++frame) {
    turns.push_back(turn_of_body(clip, frame));
  }
  return turns;
}

// Runs of equal frames, also those of a single frame.
std::vector<FrameRange> runs_of_equal_frames(const Clip& clip, FrameRange part,
                                             bool (*equal)(const Clip&, int, int) = equal_frames) {
  std::vector<FrameRange> runs;
  for (int begin = part.begin, end = 0; begin < part.end; begin = end) {
    end = begin + 1;
    while (end < part.end && equal(clip, begin, end)) ++end;
    runs.push_back({begin, end});
  }
  return runs;
}

// Sums over the first values: sums[i] is the sum of values before i.
std::vector<double> running_sums(const std::vector<double>& values) {
  std::vector<double> sums(1, 0.0);
  for (const double value : values) sums.push_back(sums.back() + value);
  return sums;
}

}  // namespace

int interpolate_held_frames(Clip& clip, FrameRange part) {
  constexpr double kLongest = 0.25;           // Seconds.
  constexpr double kAround = 0.5;             // Seconds to either side.
  constexpr double kCaughtUp = 0.4;           // Share of the movement during the run.
  constexpr double kLeastShare = 1.0 / 12.0;  // Of the frames that move.
  constexpr int kFewest = 6;
  const std::vector<FrameRange> runs = runs_of_equal_frames(clip, part);
  if (part.end - part.begin - static_cast<int>(runs.size()) < kFewest) return 0;
  const double frame_time = clip.rate().frame_time();
  const std::vector<double> turns = turns_of_body(clip, part);
  const std::vector<double> sums = running_sums(turns);
  const int around = std::max(2, static_cast<int>(std::lround(kAround / frame_time)));
  const auto usual_turn = [&](int frame) {
    const int steps = static_cast<int>(turns.size());
    const int first = std::clamp(frame - part.begin - around, 0, steps);
    const int last = std::clamp(frame - part.begin + around, first, steps);
    return (sums[static_cast<std::size_t>(last)] - sums[static_cast<std::size_t>(first)]) /
           std::max(1, last - first);
  };
  int repeated = 0, moving = 0, longest = 0;
  for (const FrameRange& run : runs) {
    const int length = run.end - run.begin;
    const double usual = usual_turn(run.begin);
    if (!(usual > 0.0) || length * frame_time > kLongest) continue;
    moving += length;
    if (length < 2 || run.end == part.end) continue;
    // After a hold, the body catches up in a single step. After a rest, it starts slowly.
    const double next = turns[static_cast<std::size_t>(run.end - 1 - part.begin)];
    if (!(next > kCaughtUp * length * usual)) continue;
    repeated += length - 1;
    longest = std::max(longest, length);
  }
  if (repeated < kFewest || repeated < kLeastShare * moving) return 0;
  int interpolated = 0;
  for (const FrameRange& run : runs) {
    const int length = run.end - run.begin;
    if (length > longest || run.end == part.end) continue;
    if (length > 1) bridge_body(clip, {run.begin + 1, run.end});
    interpolated += length - 1;
  }
  return interpolated;
}

namespace {

// Shortest and longest run of equal frames that is interpolated, and the frames around it that show
// the movement.
constexpr int kFewestFrozen = 3, kAroundFrozen = 5;
constexpr double kLongestFrozen = 1.0;  // Seconds.

// Smallest jump of a body relative to its usual step.
constexpr double kFreezeJump = 3.0;

// A run of equal frames within a movement, and the steps before and after it relative to the steps
// around it.
struct Freeze {
  FrameRange run;
  double turned_in = 0.0;    // Rotation in the step to its first frame, summed over the joints.
  double turned = 0.0;       // The same in the step after its last frame.
  double across = 0.0;       // The same from the frame before the run to the frame after it.
  double moved = 0.0;        // Translation in the step after its last frame.
  double likeness = 0.0;     // likeness_of_steps() before and after the run.
  bool follows_one = false;  // The frame before it is frozen, too.
  double usual_turn = 0.0, usual_move = 0.0;

  [[nodiscard]] int length() const { return run.end - run.begin; }

  // Whether the body jumps into a pose that is not on its way: after it, the body comes back. In a
  // freeze, the first frame is on the way; after another freeze the body catches up to it.
  [[nodiscard]] bool is_off_the_way() const {
    constexpr double kLeastTurn = 0.2, kDetour = 1.5;  // Rad; relative to the way across the run.
    return !follows_one && turned_in > std::max(kFreezeJump * usual_turn, kLeastTurn) &&
           turned_in + turned > kDetour * across;
  }

  // Whether the pose is certainly not the body's.
  [[nodiscard]] bool is_lost(double frame_time) const {
    constexpr double kLeastTurn = 1.0;  // Rad.
    return length() * frame_time <= kLongestFrozen && is_off_the_way() &&
           std::min(turned_in, turned) > std::max(kFreezeJump * usual_turn, kLeastTurn);
  }

  // Whether the body catches up in a single step, to where it would have turned meanwhile.
  [[nodiscard]] bool catches_up(double frame_time) const {
    return length() * frame_time <= kLongestFrozen && !is_off_the_way() &&
           turned > std::max(2.0, 0.4 * length()) * usual_turn;
  }

  // Whether the body stops at once and comes back at once: it has turned back meanwhile. In a pause
  // of the recording it continues.
  [[nodiscard]] bool comes_back() const {
    constexpr double kShare = 0.7, kBack = -0.5;  // Of the usual step; cosine of 120 degrees.
    return likeness < kBack && std::min(turned_in, turned) > kShare * usual_turn;
  }

  // Whether the body jumps, although it may have turned back meanwhile. The least sizes exclude
  // files of few digits, whose resting joints tick.
  [[nodiscard]] bool jumps(double metres_per_unit) const {
    constexpr double kLeastTurn = 0.2, kLeastMove = 0.05;  // Rad, metres.
    return (turned > kFreezeJump * usual_turn && turned > kLeastTurn) ||
           (moved > kFreezeJump * usual_move && moved * metres_per_unit > kLeastMove);
  }
};

// Translation from a frame to the next one, summed over the joints.
double move_of_body(const Clip& clip, int frame) {
  const auto from = clip.translations(frame), to = clip.translations(frame + 1);
  double sum = 0.0;
  for (std::size_t joint = 0; joint < from.size(); ++joint) sum += (to[joint] - from[joint]).norm();
  return sum;
}

std::vector<Freeze> find_freezes(const Clip& clip, const std::vector<FrameRange>& runs,
                                 FrameRange part) {
  std::vector<Freeze> found;
  for (const FrameRange& run : runs) {
    if (run.end - run.begin < kFewestFrozen || run.begin - kAroundFrozen < part.begin ||
        run.end + kAroundFrozen >= part.end) {
      continue;
    }
    std::vector<double> turns, moves;
    for (int i = 1; i <= kAroundFrozen; ++i) {
      for (const int frame : {run.begin - i, run.end - 1 + i}) {
        turns.push_back(turn_of_body(clip, frame));
        moves.push_back(move_of_body(clip, frame));
      }
    }
    // The body also moves before and after the run.
    const double usual = median(turns);
    if (!(usual > 0.0)) continue;
    found.push_back({run, turn_of_body(clip, run.begin - 1), turn_of_body(clip, run.end - 1),
                     turn_between(clip, run.begin - 1, run.end), move_of_body(clip, run.end - 1),
                     likeness_of_steps(clip, run.begin - 1, run.end - 1),
                     equal_rotations(clip, run.begin - 2, run.begin - 1), usual, median(moves)});
  }
  return found;
}

// Runs of equal rotations that are not the body's. The root may travel on meanwhile.
std::vector<FrameRange> find_lost_runs(const Clip& clip, FrameRange part) {
  std::vector<FrameRange> lost;
  const std::vector<FrameRange> runs = runs_of_equal_frames(clip, part, equal_rotations);
  for (const Freeze& freeze : find_freezes(clip, runs, part)) {
    if (freeze.is_lost(clip.rate().frame_time())) lost.push_back(freeze.run);
  }
  return lost;
}

// Clips in which more than a third of the frames are frozen or lost do not show their movement.
bool are_too_many(int frames, FrameRange part) {
  return 3 * frames > part.end - part.begin;
}

}  // namespace

int bridge_lost_frames(Clip& clip, FrameRange part) {
  const std::vector<FrameRange> runs = find_lost_runs(clip, part);
  int lost = 0;
  for (const FrameRange& run : runs) lost += run.end - run.begin;
  if (are_too_many(lost, part)) return 0;
  for (const FrameRange& run : runs) bridge_body(clip, run);
  return lost;
}

int bridge_frozen_frames(Clip& clip, FrameRange part) {
  std::vector<FrameRange> runs;
  int frozen = 0;
  for (const Freeze& freeze : find_freezes(clip, runs_of_equal_frames(clip, part), part)) {
    if (!freeze.catches_up(clip.rate().frame_time())) continue;
    runs.push_back({freeze.run.begin + 1, freeze.run.end});
    frozen += freeze.length() - 1;
  }
  if (are_too_many(frozen, part)) return 0;
  for (const FrameRange& run : runs) bridge_body(clip, run);
  return frozen;
}

std::vector<FrameRange> kept_freezes(const Clip& clip, FrameRange part, double metres_per_unit) {
  std::vector<FrameRange> kept;
  for (const Freeze& freeze : find_freezes(clip, runs_of_equal_frames(clip, part), part)) {
    const double frame_time = clip.rate().frame_time();
    if (freeze.is_lost(frame_time) || freeze.catches_up(frame_time)) continue;
    if (freeze.jumps(metres_per_unit) || freeze.comes_back()) kept.push_back(freeze.run);
  }
  return kept;
}

}  // namespace retarget
