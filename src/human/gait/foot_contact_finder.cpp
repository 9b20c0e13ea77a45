#include "human/gait/foot_contact_finder.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "human/gait/contact_plan.h"
#include "human/gait/frame_runs.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

// Minimum z of the up vector of a heel and of a toe that may be flat on the floor, and maximum |z|
// of the toe's side vector.
constexpr double kHeelUp = 0.75, kToeUp = 0.1, kToeSide = 0.35;
constexpr double kMinLevelTime = 1.0 / 6.0;  // Seconds.
// Seconds for which a part of a drifting run must stay in place to be a raised stance.
constexpr double kMinDriftingStance = 0.5;
// Metres: a toe alone stands only on surfaces at least as high as a low stair. Bumps of a floor are
// lower, and toes roll over them.
constexpr double kMinStair = 0.1;
constexpr std::array kBothEnds{kHeelEnd, kToeEnd};
constexpr std::array kToeOnly{kToeEnd};
// Height difference of heel and toe, metres, below which the surface is level.
constexpr double kFlat = 0.03;

}  // namespace

void FootContactFinder::find_stands(const SourceFeet& source, const ContactPlan& plan,
                                    const ContactOptions& options, int foot) {
  source_ = &source;
  standing_ = &plan.standing;
  options_ = &options;
  size_ = plan.scale;
  foot_ = foot;
  frames_ = source.frame_count();
  raised_.clear();
  for (auto& of_end : stands_on_) {
    of_end.assign(static_cast<std::size_t>(frames_), kUnsupported);
  }
  if (has(kHeelEnd) && has(kToeEnd)) find_raised_stances();
  for (const int end : {kHeelEnd, kToeEnd}) {
    if (!has(end)) continue;
    stand_on_floor(end);
    for (std::size_t i = 0; i < raised_.size(); ++i) stand_raised(static_cast<int>(i), end);
  }
}

void FootContactFinder::find_carrying_stances(const std::function<bool(int)>& carries) {
  if (!has(kHeelEnd) || !has(kToeEnd)) return;
  find_carrying_stances(kBothEnds, 0.0, kMinDriftingStance, carries);
  find_carrying_stances(kToeOnly, kMinStair * size_, options_->support_time, carries);
}

std::optional<double> FootContactFinder::speed_near_floor(int frame, int end) const {
  if (!has(end) || height(frame, end) > options_->begin_height * size_) return std::nullopt;
  return source_->speed(frame, foot_, end) / size_;
}

void FootContactFinder::find_contacts_of_ends(std::array<EndContacts, 2>& ends) const {
  for (const int end : {kHeelEnd, kToeEnd}) {
    if (!has(end)) continue;
    add_phases(end, ends[end]);
    for (const ContactPhase& phase : ends[end].phases) smooth_levels(phase, ends[end].level);
  }
}

void FootContactFinder::find_whole_foot(std::vector<ContactPhase>& phases) {
  const int last = has(kToeEnd) ? kToeEnd : kHeelEnd;
  std::vector<int>& both = both_stand_on_;
  both.assign(static_cast<std::size_t>(frames_), kUnsupported);
  for (int frame = 0; frame < frames_; ++frame) {
    const bool on = frame > 0 && both[frame - 1] != kUnsupported;
    const double low = on ? options_->end_height : options_->begin_height;
    // The standing height of an ankle may be a guess, in which case no ankle counts as too low.
    const bool lies = standing_->found && -height(frame, kHeelEnd) > low * size_;
    const int under = stands_on(frame, kHeelEnd);
    if (stands_on(frame, last) == under && !lies) both[frame] = under;
  }
  for_each_run(
      0, frames_, [&](int frame) { return both[frame]; },
      [&](int begin, int end) {
        if (both[begin] == kUnsupported || !lasts(end - begin, options_->shortest)) return;
        phases.push_back(
            {begin, end, 0.5 * (support(both[begin], kHeelEnd) + support(both[begin], last))});
      });
}

void FootContactFinder::reserve(std::size_t frames) {
  raised_.reserve(frames);
  for (auto& of_end : stands_on_) of_end.reserve(frames);
  both_stand_on_.reserve(frames);
  heights_.reserve(frames);
}

void FootContactFinder::stand_on_floor(int end) {
  bool on = false;
  for (int frame = 0; frame < frames_; ++frame) {
    const double high = on ? options_->end_height : options_->begin_height;
    on = height(frame, end) <= high * size_ &&
         is_slow(frame, end, on ? options_->end_speed : options_->begin_speed);
    if (on) stands_on_[end][static_cast<std::size_t>(frame)] = kFloor;
  }
}

// @param ends  foot ends that must be still.
bool FootContactFinder::is_still_above_floor(int frame, std::span<const int> ends) const {
  return source_->at(frame, foot_).up > kSoleUp && std::ranges::all_of(ends, [&](int end) {
           return height(frame, end) > options_->begin_height * size_ &&
                  source_->speed(frame, foot_, end) < options_->begin_speed * size_;
         });
}

// Returns the first frame up to `end` in which the ends have moved too far since frame `first`.
int FootContactFinder::end_in_place(int first, int end, std::span<const int> ends) const {
  std::array<Eigen::AlignedBox3d, 2> boxes;
  for (int frame = first; frame < end; ++frame) {
    for (const int foot_end : ends) {
      boxes[foot_end].extend(place(frame, foot_end));
      if (!(boxes[foot_end].sizes().maxCoeff() <= options_->support_drift * size_)) return frame;
    }
  }
  return end;
}

void FootContactFinder::add_raised_stance(int begin, int end) {
  RaisedStance stance{begin, end, {}};
  for (const int foot_end : {kHeelEnd, kToeEnd}) {
    heights_.clear();
    for (int frame = begin; frame < end; ++frame) heights_.push_back(height(frame, foot_end));
    stance.height[foot_end] = median_in_place(heights_);
  }
  if (std::abs(stance.height[kHeelEnd] - stance.height[kToeEnd]) < kFlat * size_) {
    stance.height.fill(0.5 * (stance.height[kHeelEnd] + stance.height[kToeEnd]));
  }
  raised_.push_back(stance);
}

// Returns the longest part of the run in which the ends stay in place, up to an eighth of its
// length.
ContactPhase FootContactFinder::longest_in_place(int begin, int end,
                                                 std::span<const int> ends) const {
  ContactPhase longest{begin, begin, 0.0};
  for (int first = begin; first < end;) {
    const int last = end_in_place(first, end, ends);
    if (last - first > longest.end - longest.begin) longest = {first, last, 0.0};
    first += std::max(1, (last - first) / 8);
  }
  return longest;
}

// @param min_height  height of the toe, metres.
// @param min_time    seconds.
void FootContactFinder::find_carrying_stances(std::span<const int> ends, double min_height,
                                              double min_time,
                                              const std::function<bool(int)>& carries) {
  const auto is_free_and_still = [&](int frame) {
    return !stands(frame, kToeEnd) && height(frame, kToeEnd) > min_height &&
           is_still_above_floor(frame, ends);
  };
  for_each_run_where(0, frames_, is_free_and_still, [&](int begin, int end) {
    const ContactPhase part = longest_in_place(begin, end, ends);
    if (!lasts(part.end - part.begin, min_time)) return;
    int alone = 0;
    for (int frame = part.begin; frame < part.end; ++frame) alone += carries(frame) ? 1 : 0;
    if (2 * alone < part.end - part.begin) return;
    add_raised_stance(part.begin, part.end);
    for (const int foot_end : ends) stand_raised(static_cast<int>(raised_.size()) - 1, foot_end);
  });
}

void FootContactFinder::find_raised_stances() {
  const auto is_still = [&](int frame) { return is_still_above_floor(frame, kBothEnds); };
  for_each_run_where(0, frames_, is_still, [&](int begin, int end) {
    if (!lasts(end - begin, options_->support_time)) return;
    if (end_in_place(begin, end, kBothEnds) == end) add_raised_stance(begin, end);
  });
}

// Marks the frames of a raised stance, and the frames around it in which this end is already, or
// still, in place.
void FootContactFinder::stand_raised(int index, int end) {
  const RaisedStance& stance = raised_[static_cast<std::size_t>(index)];
  const auto mark = [&](int frame) {
    int& under = stands_on_[end][static_cast<std::size_t>(frame)];
    if (under != kUnsupported) return false;
    under = index;
    return true;
  };
  for (int frame = stance.begin; frame < stance.end; ++frame) mark(frame);
  const auto near = [&](int frame, int edge, double speed) {
    return (place(frame, end) - place(edge, end)).norm() <= options_->support_drift * size_ &&
           is_slow(frame, end, speed);
  };
  for (int frame = stance.begin - 1; frame >= 0; --frame) {
    if (!near(frame, stance.begin, options_->begin_speed) || !mark(frame)) break;
  }
  for (int frame = stance.end; frame < frames_; ++frame) {
    if (!near(frame, stance.end - 1, options_->end_speed) || !mark(frame)) break;
  }
}

void FootContactFinder::add_phases(int end, EndContacts& contacts) const {
  contacts.level.assign(static_cast<std::size_t>(frames_), 0);
  for_each_run(
      0, frames_, [&](int frame) { return stands_on(frame, end); },
      [&](int begin, int last) {
        const int under = stands_on(begin, end);
        const bool goes_on = options_->goes_on && last == frames_;
        if (under == kUnsupported || !(goes_on || lasts(last - begin, options_->shortest))) return;
        contacts.phases.push_back({begin, last, support(under, end)});
        for (int frame = begin; frame < last; ++frame) {
          const SourceFoot& foot = source_->at(frame, foot_);
          const bool level = end == kHeelEnd ? foot.up > kHeelUp
                                             : foot.up > kToeUp && std::abs(foot.side) < kToeSide;
          contacts.level[static_cast<std::size_t>(frame)] = level ? 1 : 0;
        }
      });
}

// Removes short changes within a phase, in both directions.
void FootContactFinder::smooth_levels(const ContactPhase& phase, std::vector<char>& levels) const {
  for (const char passed_over : {0, 1}) {
    for_each_run(
        phase.begin, phase.end, [&](int frame) { return levels[frame]; },
        [&](int begin, int end) {
          const bool inside = begin > phase.begin && end < phase.end;
          if (!inside || levels[begin] != passed_over || lasts(end - begin, kMinLevelTime)) return;
          std::fill(levels.begin() + begin, levels.begin() + end,
                    static_cast<char>(1 - passed_over));
        });
  }
}

}  // namespace retarget
