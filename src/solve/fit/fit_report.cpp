#include "solve/fit/fit_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "base/option_name.h"
#include "retarget/text.h"
#include "solve/fit/fit_dynamics.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

double sum_of(const std::vector<TermCosts>& costs, int begin, int end) {
  double sum = 0.0;
  for (int t = begin; t < end; ++t) {
    sum = std::accumulate(costs[at(t)].begin(), costs[at(t)].end(), sum);
  }
  return sum;
}

std::string not_converged(const FitStatus& window) {
  const std::string frames = fmt::format("frames {} to {}", window.begin, window.end - 1);
  const std::string steps = count_text(window.steps, "step");
  if (window.predicted_decrease >= 1.0 && window.failed_blocks > 0) {
    return fmt::format("not converged after {}: {} of {} could not be factorised", steps,
                       count_text(window.failed_blocks, "block"), frames);
  }
  if (window.steps == 0) return "not converged: no step was taken in " + frames;
  return fmt::format(
      "not converged after {}: the last step predicted a further cost reduction of {} % in {}",
      steps, number_text(100.0 * window.predicted_decrease, 1), frames);
}

// Reports the windows in which the fit reverted the dynamics.
void note_taken_back(const std::vector<FitStatus>& parts, FitReport& report) {
  for (const FitStatus& part : parts) {
    if (!part.dynamics_taken_back) continue;
    report.notes.push_back(fmt::format(
        "dynamics: no improvement, or mostly unknown contacts, in frames {} to {}; they "
        "remain unchanged",
        part.begin, part.end - 1));
  }
}

// Adds the windows in which a step failed; the metric solver_failures counts them.
void add_failures(const std::vector<FitStatus>& parts, FitReport& report) {
  for (const FitStatus& part : parts) {
    if (part.failed) report.failures.push_back({"fit", part.begin, part.end});
    if (part.dynamics_failed) {
      report.failures.push_back({"fit with dynamics", part.begin, part.end});
    }
  }
}

void note_distrust(FitReport& report) {
  constexpr double kReportedShare = 0.02;
  const FitStatus& all = report.status;
  const double share = static_cast<double>(all.distrusted_frames) / (all.end - all.begin);
  if (share < kReportedShare) return;
  report.notes.push_back(
      fmt::format("dynamics: {} % of the frames remain unchanged, because they have unknown "
                  "contacts (hands on an object, steps or a wall?)",
                  number_text(100.0 * share, 1)));
}

// Whether so many frames of a clip are worth a note.
bool is_notable(int frames, const FitClip& clip) {
  constexpr double kShare = 0.05, kTime = 0.5;  // Share of the frames, seconds.
  return frames >= kShare * clip.frame_count && frames * clip.frame_time >= kTime;
}

}  // namespace

void report_status(std::vector<FitStatus> parts, const std::vector<TermCosts>& before,
                   const std::vector<TermCosts>& after, FitReport& report) {
  FitStatus& all = report.status;
  all = {0, static_cast<int>(after.size()), true, 0, 0, 0.0};
  for (FitStatus& part : parts) {
    part.cost_before = sum_of(before, part.begin, part.end);
    part.cost_after = sum_of(after, part.begin, part.end);
  }
  all.cost_before = sum_of(before, all.begin, all.end);
  all.cost_after = sum_of(after, all.begin, all.end);
  for (const FitStatus& part : parts) {
    all.converged = all.converged && part.converged;
    all.steps = std::max(all.steps, part.steps);
    all.failed_blocks += part.failed_blocks;
    all.failed = all.failed || part.failed;
    all.dynamics_failed = all.dynamics_failed || part.dynamics_failed;
    all.predicted_decrease = std::max(all.predicted_decrease, part.predicted_decrease);
  }
  // The windows come first and cover all frames. The condition skips the seams, which overlap them.
  int counted = 0;
  for (const FitStatus& part : parts) {
    if (part.begin != counted) continue;
    counted = part.end;
    all.distrusted_frames += part.distrusted_frames;
  }
  add_failures(parts, report);
  note_taken_back(parts, report);
  note_distrust(report);
  report.windows = std::move(parts);
}

std::string convergence_note(const FitReport& report) {
  if (report.status.converged || report.windows.empty()) return {};
  return not_converged(
      *std::ranges::max_element(report.windows, {}, &FitStatus::predicted_decrease));
}

void report_terms(const FitClip& clip, const std::vector<TermCosts>& before,
                  const std::vector<TermCosts>& after, FitReport& report) {
  constexpr std::array kNames = {"position",       "rotation", "foot-height",    "contact",
                                 "contact-height", "floor",    "self-collision", "limits",
                                 "smoothness",     "speed",    "scene-contact",  "scene"};
  static_assert(kNames.size() == kTermCount);
  constexpr std::size_t kWorst = 5;
  const int apart = static_cast<int>(std::lround(0.5 / clip.frame_time));
  const std::size_t terms = clip.scene ? kTermCount : kTermsWithoutScene;
  for (std::size_t term = 0; term < terms; ++term) {
    FitTermReport entry;
    entry.name = kNames[term];
    std::vector<int> order;
    for (int t = 0; t < clip.frame_count; ++t) {
      entry.before += before[at(t)][term] / clip.frame_count;
      entry.after += after[at(t)][term] / clip.frame_count;
      if (after[at(t)][term] > 0.0) order.push_back(t);
    }
    std::ranges::stable_sort(order,
                             [&](int a, int b) { return after[at(a)][term] > after[at(b)][term]; });
    for (const int t : order) {
      if (entry.worst.size() == kWorst) break;
      const bool near =
          std::ranges::any_of(entry.worst, [&](int other) { return std::abs(other - t) < apart; });
      if (!near) entry.worst.push_back(t);
    }
    report.terms.push_back(std::move(entry));
  }
}

void note_missing_feet(const Robot& robot, const SourceSides& sides, FitReport& report) {
  if (robot.fixed_base()) {
    report.notes.emplace_back("fixed base: the fit has no foot, contact and floor terms");
  } else if (robot.profile().soles.empty()) {
    report.notes.emplace_back(
        "the robot has no soles: the fit has no contact and foot height terms");
  } else if (!sides.left && !sides.right) {
    report.notes.emplace_back(
        "the source has no feet: the fit has no contact and foot height terms");
  } else if (!sides.left || !sides.right) {
    report.notes.emplace_back(std::string("the source has no ") + (sides.left ? "right" : "left") +
                              " foot: the fit has contacts of the other foot only");
  }
}

void note_dynamics(const FitOptions& options, const FitModel& model, FitReport& report) {
  if (!options.dynamics || FitDynamics::possible(model)) return;
  report.notes.emplace_back("the robot has no masses or no feet: the fit has no dynamics term");
}

void note_raised_feet(const FitClip& clip, FitReport& report) {
  const RaisedFrames raised = raised_frames(clip.feet, clip.frame_count);
  if (!is_notable(raised.count, clip)) return;
  report.notes.push_back(fmt::format(
      "in {:.0f} % of the frames, the feet stand only on raised surfaces (up to {:.2f} m) that are "
      "not in the motion: `retarget scene-from-motion` finds them for " OPTION(
          "scene") "; if the human's floor was flat, the height of the root is wrong",
      100.0 * raised.count / clip.frame_count, raised.highest));
}

void note_seats(const std::vector<SeatRest>& seats, const FitClip& clip, double floor,
                FitReport& report) {
  int frames = 0;
  double highest = 0.0;
  for (const SeatRest& seat : seats) {
    frames += seat.frames.end - seat.frames.begin;
    highest = std::max(highest, seat.height - floor);
  }
  if (!is_notable(frames, clip)) return;
  report.notes.push_back(fmt::format(
      "in {:.0f} % of the frames, the human sits on something (up to {:.2f} m high) that is not in "
      "the motion: `retarget scene-from-motion` finds it for " OPTION("scene"),
      100.0 * frames / clip.frame_count, highest));
}

void note_floor(const StandingHeights& standing, FitReport& report) {
  if (!standing.from_body) return;
  report.notes.emplace_back(
      "no foot stands long enough: the floor is where the lowest part of the body rests");
}

}  // namespace retarget
