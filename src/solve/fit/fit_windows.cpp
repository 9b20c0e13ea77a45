#include "solve/fit/fit_windows.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "solve/fit/foot_plan.h"
#include "solve/fit/frame_costs.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

// By frame: number of contacts that begin before it and end after it.
std::vector<int> contacts_across(const std::vector<PlantedPhase>& phases, int frames) {
  std::vector<int> counts(at(frames) + 1, 0);
  for (const PlantedPhase& phase : phases) {
    if (phase.begin + 1 >= phase.end) continue;
    ++counts[at(phase.begin) + 1];
    --counts[at(phase.end)];
  }
  std::partial_sum(counts.begin(), counts.end(), counts.begin());
  return counts;
}

// The frame with the lowest count near `frame`; on a tie, the nearest.
int best_cut(const std::vector<int>& counts, int frame, int max_away) {
  int best = frame;
  for (int away = 1; away <= max_away; ++away) {
    for (const int cut : {frame - away, frame + away}) {
      if (counts[at(cut)] < counts[at(best)]) best = cut;
    }
  }
  return best;
}

// Number of leading frames that contain the window and all contacts that it cuts.
int needed_for(const FitWindow& window, const std::vector<PlantedPhase>& phases) {
  int needed = window.end;
  for (const PlantedPhase& phase : phases) {
    if (phase.begin < window.end) needed = std::max(needed, phase.end);
  }
  return needed;
}

}  // namespace

FitWindows plan_windows(const FitClip& clip, const FitOptions& options) {
  constexpr double kMovable = 0.25;  // Share of a window's length by which a border may move.
  FitWindows plan;
  const int frames = clip.frame_count;
  const double per_window = std::max(2.0, options.window / clip.frame_time);
  const int count = std::max(1, static_cast<int>(std::lround(frames / per_window)));
  const std::vector<int> contacts = contacts_across(clip.feet.phases, frames);
  for (int i = 0, begin = 0; i < count; ++i) {
    const auto nominal = static_cast<int>(static_cast<std::int64_t>(frames) * (i + 1) / count);
    const int away = static_cast<int>(kMovable * frames / count);
    const int end = i + 1 == count ? frames : best_cut(contacts, nominal, away);
    plan.windows.push_back({begin, end, false});
    plan.frames_needed.push_back(needed_for(plan.windows.back(), clip.feet.phases));
    begin = end;
  }
  const int half =
      std::min(static_cast<int>(std::lround(options.seam / clip.frame_time)), frames / count / 8);
  // Limits the context so that a seam reads no frame that another seam changes.
  const int context = std::clamp(smoothing_context(clip.frame_time), 0,
                                 std::max(0, (frames / count / 2 - 2 * half) / 2 - 1));
  for (int i = 1; i < count && half > 0; ++i) {
    const int border = plan.windows[at(i)].begin;
    plan.seams.push_back({border - half, border + half, true, context});
  }
  return plan;
}

}  // namespace retarget
