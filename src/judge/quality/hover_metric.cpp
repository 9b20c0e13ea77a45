#include "judge/quality/hover_metric.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "human/gait/rest_heights.h"
#include "judge/quality/fault_list.h"

namespace retarget {
namespace {

constexpr double kHovers = kSoleHigh;

// By frame: whether the source is in flight.
std::vector<char> frames_in_flight(const std::vector<SourceFlight>& flights, int frames) {
  std::vector<char> in_flight(static_cast<std::size_t>(frames), 0);
  for (const SourceFlight& flight : flights) {
    std::fill(in_flight.begin() + flight.begin, in_flight.begin() + flight.end, char{1});
  }
  return in_flight;
}

}  // namespace

double source_clearance(const SourceFeet& source, const ContactPlan& contacts, int frame) {
  double lowest = HUGE_VAL;
  for (int foot = 0; foot < source.foot_count; ++foot) {
    for (const int end : {kHeelEnd, kToeEnd}) {
      if (!source.has(foot, end)) continue;
      lowest = std::min(lowest, source.at(frame, foot).end(end).z() - contacts.standing.of(end));
    }
  }
  for (std::size_t i = 0; i < kSupportBones.size(); ++i) {
    if (source.supports.empty() || !source.has_support[i]) continue;
    lowest = std::min(lowest, source.support(frame, i).z() - floor_height(contacts) -
                                  rest_height(i, contacts.scale));
  }
  return std::isfinite(lowest) ? std::max(lowest, 0.0) : 0.0;
}

void measure_hovering(const ReportBuilder& draft, const BodyTracks& tracks,
                      const SourceFeet& source, const ContactPlan& contacts,
                      const std::vector<SourceFlight>& flights, double scale) {
  const int frames = std::min(source.frame_count(), static_cast<int>(tracks.lowest.size()));
  if (frames == 0) return;
  const std::vector<char> in_flight = frames_in_flight(flights, frames);
  FaultList faults("hover_pct", "m");
  int hovering = 0;
  for (int frame = 0; frame < frames; ++frame) {
    const auto& [height, body] = tracks.lowest[static_cast<std::size_t>(frame)];
    if (!std::isfinite(height)) return;  // No part of the robot can touch the floor.
    if (in_flight[static_cast<std::size_t>(frame)] != 0) continue;
    const double over = height - scale * source_clearance(source, contacts, frame);
    if (over <= kHovers) continue;
    ++hovering;
    faults.add(draft.clip.robot().bodies()[static_cast<std::size_t>(body)].name, frame, over);
  }
  draft.set("hover_pct", percent(hovering, frames));
  faults.move_to(draft.report, draft.options.faults_per_metric);
}

}  // namespace retarget
