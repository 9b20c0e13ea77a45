#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "edit/ground_pose.h"
#include "edit/memory_clip.h"
#include "edit/seam.h"
#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"
#include "retarget/option_name.h"
#include "retarget/pose.h"
#include "retarget/so3.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Minimum length of a cycle, frames.
constexpr int kMinFrames = 3;

struct CycleEnd {
  int frame = 0;
  int overlap = 0;  // Frames from there to the clip's end, at most a window.
  CloudAlignment aligned;
};

CycleEnd find_end(const HumanClip& human, int from, int window) {
  const PoseClouds clouds(human, common_bones(human, human));
  const WindowDistance distance(clouds, clouds, window);
  CycleEnd best;
  double min = std::numeric_limits<double>::infinity();
  for (int frame = from; frame < human.frame_count; ++frame) {
    const int overlap = distance.frames_at(frame, 0);
    const CloudAlignment aligned = distance.at(frame, 0);
    // Among poses that are equal up to rounding, take the first.
    constexpr double kEqual = 1e-6;
    const double cost = distance.counted(aligned.distance, frame, 0);
    if (cost >= min - kEqual) continue;
    min = cost;
    best = {frame, overlap, aligned};
  }
  return best;
}

GroundPose advance_over_ground(const HumanMotion& motion, const CycleEnd& end) {
  // A foot in contact throughout the cycle gives the exact advance.
  for (int foot = 0; foot < 2; ++foot) {
    if (motion.feet.ankles[foot].empty()) continue;
    for (const ContactPhase& phase : motion.feet.contacts.phases[foot]) {
      if (phase.begin > 0 || phase.end <= end.frame) continue;
      return between_places(motion.feet.ankles[foot].front(),
                            motion.feet.ankles[foot][static_cast<std::size_t>(end.frame)]);
    }
  }
  return end.aligned.a_from_b;
}

// Returns the motion of the body over the cycle, including full turns.
GroundPose advance_of(const HumanMotion& motion, const CycleEnd& end) {
  constexpr double kWhole = 2.0 * std::numbers::pi;
  GroundPose advance = advance_over_ground(motion, end);
  const auto hips = hips_over_ground(motion.human);
  const double turned = hips[static_cast<std::size_t>(end.frame)].heading - hips.front().heading;
  advance.heading += kWhole * std::round((turned - advance.heading) / kWhole);
  return advance;
}

// Returns the fraction of a rigid motion over the ground, along the arc of its repetition. The turn
// is at most half a turn: near a full one, the fixed point would be far away.
GroundPose part_of(const GroundPose& whole, double share) {
  constexpr double kStraight = 1e-6;
  if (std::abs(whole.heading) < kStraight) return {share * whole.position, share * whole.heading};
  // Rotate about the fixed point c = R c + position.
  const GroundPose turn{Eigen::Vector2d::Zero(), whole.heading};
  Eigen::Matrix2d system = Eigen::Matrix2d::Identity();
  system.col(0) -= turn * Eigen::Vector2d(1.0, 0.0);
  system.col(1) -= turn * Eigen::Vector2d(0.0, 1.0);
  return turn_about(system.inverse() * whole.position, share * whole.heading);
}

// Moves a clip's last frame to its target evenly, and its last step to the target's first step.
template <typename Value>
struct Closing {
  Value gap, step;  // Missing position and missing step at the end.

  [[nodiscard]] Value at(int frame, int last, int settle) const {
    const double from_end = frame - last;
    const double share = 1.0 + from_end / settle;
    const double late = share > 0.0 ? from_end * share * share : 0.0;
    return gap * (static_cast<double>(frame) / last) + step * late;
  }
};
using VectorClosing = Closing<Eigen::Vector3d>;

// Closes frames 0..last; `next` holds the two frames that follow in place of the last one.
class LoopCloser {
 public:
  LoopCloser(Clip& clip, const Clip& next, int settle)
      : clip_(clip), next_(next), last_(clip.frame_count() - 1), settle_(settle) {}

  void run() {
    for (int joint = 0; joint < clip_.skeleton().joint_count(); ++joint) close_rotation(joint);
    for (int slot = 0; slot < clip_.skeleton().translated_count(); ++slot) close_translation(slot);
  }

 private:
  void close_rotation(int joint) {
    const auto at = [joint](const Clip& clip, int frame) { return clip.rotations(frame)[joint]; };
    const auto between = [](const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
      return log_so3(to * from.conjugate());
    };
    const VectorClosing closing{
        between(at(clip_, last_), at(next_, 0)),
        between(at(next_, 0), at(next_, 1)) - between(at(clip_, last_ - 1), at(clip_, last_))};
    for (int frame = 0; frame <= last_; ++frame) {
      Eigen::Quaterniond& rotation = clip_.rotations(frame)[joint];
      rotation = (exp_so3(closing.at(frame, last_, settle_)) * rotation).normalized();
    }
  }

  void close_translation(int slot) {
    const auto at = [slot](const Clip& clip, int frame) { return clip.translations(frame)[slot]; };
    const VectorClosing closing{
        at(next_, 0) - at(clip_, last_),
        (at(next_, 1) - at(next_, 0)) - (at(clip_, last_) - at(clip_, last_ - 1))};
    for (int frame = 0; frame <= last_; ++frame) {
      clip_.translations(frame)[slot] += closing.at(frame, last_, settle_);
    }
  }

  Clip& clip_;
  const Clip& next_;
  const int last_;
  const int settle_;
};

// Returns the frame most similar to itself one cycle later, which the seam and long stances near it
// affect least; among equal ones, the one nearest to the middle.
int quiet_frame(const HumanClip& joined, int cycle, const GroundPose& advance) {
  const Pose move = advance.in_space();
  const std::vector<Bone> bones = common_bones(joined, joined);
  int best = cycle / 2;
  double min = std::numeric_limits<double>::infinity();
  for (int i = 0; i < cycle - 1; ++i) {
    // Search outwards from the middle.
    const int frame = cycle / 2 + (i % 2 == 0 ? i / 2 : -(i + 1) / 2);
    if (frame < 1 || frame >= cycle) continue;
    double largest = 0.0;
    for (const Bone bone : bones) {
      const auto at = [&](int which) -> const Eigen::Vector3d& {
        return joined.frame(which)[bone].translation;
      };
      largest = std::max(largest, (move * at(frame) - at(frame + cycle)).norm());
    }
    constexpr double kEqual = 1e-6;
    if (largest >= min - kEqual) continue;
    min = largest;
    best = frame;
  }
  return best;
}

// Extracts one cycle from a clip joined to itself after `cycle` frames: from a frame in the first
// pass to the same frame in the second, far from the seam. Reorders it to start at frame 0 and
// closes it exactly.
Clip cycle_of(const Clip& joined, int begin, int cycle, const GroundPose& advance,
              const BodyMover& mover, int settle) {
  Clip part = cut(joined, begin, begin + cycle + 1);
  Clip next = cut(joined, begin, begin + 2);
  mover.move_all(next, advance.in_space());
  LoopCloser(part, next, settle).run();
  Clip result = cut(joined, 0, cycle);
  const GroundPose back = advance.inverse();
  for (int frame = 0; frame < cycle; ++frame) {
    const int from = frame >= begin ? frame - begin : frame - begin + cycle;
    copy_frame(part, from, result, frame);
    if (frame < begin) mover.move(result, frame, back);
  }
  return result;
}

// Removes the advance at a constant rate, so that strides keep their own accelerations. An advance
// is whole turns and at most half a turn with a displacement. Whole turns return to the start about
// any point; the least-squares centre of the hips' turns leaves the least movement.
void keep_in_place(Clip& cycle, const Calibration& calibration, const GroundPose& advance,
                   const BodyMover& mover) {
  constexpr double kWhole = 2.0 * std::numbers::pi;
  const double turned = kWhole * std::round(advance.heading / kWhole);
  const GroundPose rest{advance.position, advance.heading - turned};
  const int frames = cycle.frame_count();
  const auto share_at = [&](int frame) { return static_cast<double>(frame) / frames; };
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  if (turned != 0.0) {
    const std::vector<GroundPose> hips = hips_over_ground(to_human(cycle, calibration));
    for (int frame = 0; frame < frames; ++frame) {
      centre += part_of(rest, share_at(frame)).inverse() *
                hips[static_cast<std::size_t>(frame)].position / frames;
    }
  }
  for (int frame = 0; frame < frames; ++frame) {
    GroundPose advanced = part_of(rest, share_at(frame));
    if (turned != 0.0) advanced = advanced * turn_about(centre, share_at(frame) * turned);
    mover.move(cycle, frame, advanced.inverse());
  }
}

// Returns the largest distance of the hips over the ground from their first position, metres.
double travel_of(const HumanClip& human) {
  double farthest = 0.0;
  const std::vector<GroundPose> hips = hips_over_ground(human);
  for (const GroundPose& place : hips) {
    farthest = std::max(farthest, (place.position - hips.front().position).norm());
  }
  return farthest;
}

Clip repeated(const Clip& cycle, const LoopOptions& options, const GroundPose& advance,
              const BodyMover& mover) {
  Clip result = without_file_size(cycle);
  result.resize(cycle.frame_count() * options.times);
  GroundPose reached;
  for (int time = 1; time < options.times; ++time) {
    if (!options.in_place) reached = reached * advance;
    for (int frame = 0; frame < cycle.frame_count(); ++frame) {
      const int at = time * cycle.frame_count() + frame;
      copy_frame(cycle, frame, result, at);
      mover.move(result, at, reached);
    }
  }
  return result;
}

// @param travel  what remains of the body's movement over the ground in place, metres.
void describe(Loop& loop, const FrameRate& rate, bool in_place, double travel) {
  loop.notes = {
      {"cycle", count_text(loop.cycle, "frame") + ", " + number_text(rate.time_of(loop.cycle), 3) +
                    " s; its ends were " + number_text(100.0 * loop.distance, 2) + " cm apart"},
      {"advance", number_text(loop.way.norm(), 3) + " m and " +
                      number_text(loop.advance.heading * 180.0 / std::numbers::pi, 2) +
                      " degrees per cycle" + (in_place ? ", removed" : "")}};
  constexpr double kSway = 0.1;  // Metres; the hips sway less in even strides.
  if (travel > kSway) {
    loop.notes.push_back({"", "the hips still move up to " + number_text(travel, 2) +
                                  " m from the start: only a constant rate is removed"});
  }
  if (in_place) {
    loop.notes.push_back(
        {"", "retarget it with " RETARGET_OPTION(
                 "clean") " off: otherwise a run takes the sliding feet for drift of the "
                          "root, and restores the advance"});
  }
  loop.doubts = as_warnings(loop.check.faults);
  if (loop.check.faults.empty()) return;
  loop.misfit = run_failure(
                    {}, "the end does not match the beginning: " + list_names(loop.check.faults),
                    RETARGET_OPTION("start") " and " RETARGET_OPTION("end")
                    " select a part that returns to its first pose; " RETARGET_OPTION("force")
                    " closes it anyway")
                    .value();
}

}  // namespace

Result<Loop> make_loop(const Clip& clip, const Calibration& calibration,
                       const LoopOptions& options) {
  RETARGET_TRY_ASSIGN(const auto mover, BodyMover::of(clip, calibration));
  const double shortest = options.shortest > 0.0 ? options.shortest : 0.5 * clip.duration();
  const double wanted = std::ceil(shortest * clip.rate().fps() - 1e-6);
  if (wanted >= clip.frame_count() || clip.frame_count() <= kMinFrames) {
    return input_failure(
        {}, "a clip of " + number_text(clip.duration(), 3) + " s is too short for a cycle" +
                (options.shortest > 0.0 ? " of " + number_text(options.shortest, 3) + " s or more"
                                        : std::string()));
  }
  constexpr std::int64_t kMaxFrames = 10'000'000;
  if (options.times < 1 || std::int64_t{clip.frame_count()} * options.times > kMaxFrames) {
    return usage_failure(
        "the cycle must be repeated at least once, with at most 10 million frames in total");
  }
  const HumanMotion motion(clip, calibration);
  const CycleEnd end = find_end(motion.human, std::max(kMinFrames, static_cast<int>(wanted)),
                                frames_in(options.seam.seam.window, clip.rate()) + 1);
  const GroundPose advance = advance_of(motion, end);
  const double share_of_cycle = end.frame * clip.rate().frame_time() / 3.0;
  ConcatenateOptions how = options.seam;
  how.fade = std::min(how.fade, share_of_cycle);
  how.plant.release = std::min(how.plant.release, share_of_cycle);
  how.plant.pelvis_blend = std::min(how.plant.pelvis_blend, share_of_cycle);
  Seam seam;
  seam.a_frame = end.frame;
  seam.overlap = end.overlap;
  seam.a_from_b = advance;
  seam.distance = end.aligned.distance;
  Clip next = clip;
  mover.move_all(next, advance.in_space());
  RETARGET_TRY_ASSIGN(auto joined, join_clips(motion, HumanMotion(next, calibration), seam,
                                              calibration, mover, how));

  const int settle = std::max(1, std::min(frames_in(how.fade, clip.rate()), end.frame / 3));
  const int quiet = quiet_frame(to_human(joined.clip, calibration), end.frame, advance);
  Clip cycle = cycle_of(joined.clip, quiet, end.frame, advance, mover, settle);
  if (options.in_place) keep_in_place(cycle, calibration, advance, mover);
  const double travel = options.in_place ? travel_of(to_human(cycle, calibration)) : 0.0;
  Clip whole = repeated(cycle, options, advance, mover);
  const Eigen::Vector2d start = motion.human.frame(0)[Bone::kHips].translation.head<2>();
  Loop loop{{std::move(whole)},      end.frame,
            end.aligned.distance,    advance,
            advance * start - start, std::move(joined.check)};
  describe(loop, clip.rate(), options.in_place, travel);
  return loop;
}

}  // namespace retarget
