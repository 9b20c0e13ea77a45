#include "judge/quality/flight_metrics.h"

#include <algorithm>
#include <cmath>

#include "judge/quality/fault_list.h"

namespace retarget {
namespace {

constexpr double kFreeFallShare = 0.4;

// Height of the lower end of the lower foot above its standing height.
double clearance(const HumanClip& human, const ContactPlan& contacts, int frame) {
  double min = HUGE_VAL;
  const auto look = [&](Bone bone, double standing) {
    if (!human.has(bone)) return;
    min = std::min(min, human.frame(frame)[bone].translation.z() - standing);
  };
  for (const Bone ankle : {Bone::kLeftFoot, Bone::kRightFoot}) look(ankle, contacts.standing.ankle);
  for (const Bone toe : {Bone::kLeftToe, Bone::kRightToe}) look(toe, contacts.standing.toe);
  return std::isfinite(min) ? min : 0.0;
}

bool hips_fall(const HumanClip& human, const SourceFlight& flight) {
  if (!human.has(Bone::kHips) || flight.end - flight.begin < 3) return false;
  std::vector<double> hips;
  for (int frame = flight.begin; frame < flight.end; ++frame) {
    hips.push_back(human.frame(frame)[Bone::kHips].translation.z());
  }
  return falls_freely(hips, human.rate.frame_time(), kFreeFallShare);
}

}  // namespace

std::vector<SourceFlight> find_flights(const HumanClip& human, const ContactPlan& contacts,
                                       int frames, const ContactOptions& options) {
  std::vector<SourceFlight> flights;
  if (contacts.phases[0].empty() && contacts.phases[1].empty()) return flights;
  SourceFlight flight;
  bool aloft = false;
  for (int frame = 0; frame <= frames; ++frame) {
    const double height = frame < frames ? clearance(human, contacts, frame) : 0.0;
    const bool now = height > options.begin_height * contacts.scale;
    if (now && !aloft) flight = {frame, frame, 0.0};
    if (now) flight.peak = std::max(flight.peak, height);
    if (!now && aloft) {
      flight.end = frame;
      const double time = (flight.end - flight.begin) * human.rate.frame_time();
      if (time > options.shortest - 1e-9 && hips_fall(human, flight)) flights.push_back(flight);
    }
    aloft = now;
  }
  return flights;
}

void measure_flights(const ReportBuilder& draft, const BodyTracks& tracks,
                     const std::vector<SourceFlight>& flights, double scale) {
  if (flights.empty() || tracks.soles.empty()) return;
  constexpr double kFarOff = 0.02;  // metres
  FaultList faults("flight_peak_max_cm", "m");
  double max = 0.0;
  for (const SourceFlight& flight : flights) {
    double peak = -HUGE_VAL;
    for (int frame = flight.begin; frame < flight.end; ++frame) {
      peak = std::max(peak, tracks.lowest_sole[static_cast<std::size_t>(frame)].height);
    }
    const double off = std::abs(peak - scale * flight.peak);
    max = std::max(max, off);
    if (off <= kFarOff) continue;
    for (int frame = flight.begin; frame < flight.end; ++frame) faults.add("soles", frame, off);
  }
  draft.set("flights", static_cast<double>(flights.size()));
  draft.set("flight_peak_max_cm", kInCm * max);
  faults.move_to(draft.report, draft.options.faults_per_metric);
}

}  // namespace retarget
