#include <algorithm>
#include <cmath>
#include <cstddef>

#include "human/gait/frame_runs.h"
#include "human/gait/standing_heights.h"
#include "judge/quality/flight_metrics.h"
#include "judge/quality/report_parts.h"

namespace retarget {
namespace {

constexpr double kFreeFallShare = 0.4;

// Smallest height of an ankle or a toe above its standing height, metres.
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
                                       int frames) {
  const ContactOptions options;
  std::vector<SourceFlight> flights;
  if (contacts.phases[0].empty() && contacts.phases[1].empty()) return flights;
  std::vector<double> heights;
  for (int frame = 0; frame < frames; ++frame) {
    heights.push_back(clearance(human, contacts, frame));
  }
  const auto is_aloft = [&](int frame) {
    return heights[static_cast<std::size_t>(frame)] > options.begin_height * contacts.scale;
  };
  for_each_run_where(0, frames, is_aloft, [&](int begin, int end) {
    const double peak = *std::max_element(heights.begin() + begin, heights.begin() + end);
    const SourceFlight flight{begin, end, peak};
    const double time = (end - begin) * human.rate.frame_time();
    if (time > options.shortest - 1e-9 && hips_fall(human, flight)) flights.push_back(flight);
  });
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

namespace {

constexpr double kHovers = kSoleHigh;
constexpr double kLongestFlight = 1.0;  // Seconds.

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
                      const std::vector<SourceFlight>& flights,
                      const std::vector<char>& touches_scene, double scale) {
  const int frames = std::min(source.frame_count(), static_cast<int>(tracks.lowest.size()));
  if (frames == 0) return;
  const std::vector<char> in_flight = frames_in_flight(flights, frames);
  FaultList faults("hover_pct", "m");
  int hovering = 0;
  for (int frame = 0; frame < frames; ++frame) {
    const auto& [height, body] = tracks.lowest[static_cast<std::size_t>(frame)];
    if (!std::isfinite(height)) return;  // The robot has neither soles nor primitives.
    if (in_flight[static_cast<std::size_t>(frame)] != 0) continue;
    const bool on_scene = frame < static_cast<int>(touches_scene.size()) &&
                          touches_scene[static_cast<std::size_t>(frame)] != 0;
    if (on_scene) continue;
    const double over = height - scale * source_clearance(source, contacts, frame);
    if (over <= kHovers) continue;
    ++hovering;
    faults.add(draft.clip.robot().bodies()[static_cast<std::size_t>(body)].name, frame, over);
  }
  draft.set("hover_pct", percent(hovering, frames));
  faults.move_to(draft.report, draft.options.faults_per_metric);
}

namespace {

// The support of the body in a frame.
enum class Carrier : char { kNothing, kFloorOrScene, kMissingSurface, kSeat };

// Whether only the source has the surface.
bool is_missing_surface(Carrier carrier) {
  return carrier == Carrier::kMissingSurface || carrier == Carrier::kSeat;
}

// Carriers by frame, and the height of the highest surface below a foot, metres.
struct Carriers {
  std::vector<Carrier> of;
  std::vector<double> raised;
};

Carriers find_carriers(const ContactPlan& contacts, int frames, const std::vector<SeatRest>& seats,
                       const std::vector<char>& touches_scene) {
  Carriers found;
  found.of.assign(static_cast<std::size_t>(frames), Carrier::kNothing);
  found.raised.assign(found.of.size(), 0.0);
  const auto each = [frames](const std::vector<ContactPhase>& phases, const auto& visit) {
    for (const ContactPhase& phase : phases) {
      const int end = std::min(phase.end, frames);
      for (int frame = phase.begin; frame < end; ++frame) {
        visit(static_cast<std::size_t>(frame), phase.support);
      }
    }
  };
  for (const auto& foot : contacts.ends) {
    for (const EndContacts& end : foot) {
      each(end.phases, [&](std::size_t i, double support) {
        if (!(support > 0.0)) found.of[i] = Carrier::kFloorOrScene;
        found.raised[i] = std::max(found.raised[i], support);
      });
    }
  }
  // Feet on the floor do not carry a body that sits, but hands and knees do.
  for (const SeatRest& seat : seats) {
    const int end = std::min(seat.frames.end, frames);
    for (int frame = seat.frames.begin; frame < end; ++frame) {
      found.of[static_cast<std::size_t>(frame)] = Carrier::kSeat;
      found.raised[static_cast<std::size_t>(frame)] = seat.height - floor_height(contacts);
    }
  }
  for (const auto& phases : contacts.bodies) {
    each(phases, [&](std::size_t i, double) { found.of[i] = Carrier::kFloorOrScene; });
  }
  for (std::size_t i = 0; i < found.of.size(); ++i) {
    if (i < touches_scene.size() && touches_scene[i] != 0) found.of[i] = Carrier::kFloorOrScene;
    if (found.of[i] == Carrier::kNothing && found.raised[i] > 0.0) {
      found.of[i] = Carrier::kMissingSurface;
    }
  }
  return found;
}

// A flight between two surfaces of the same kind counts as a contact with the first one.
void bridge_flights(double frame_time, Carriers& found) {
  const int frames = static_cast<int>(found.of.size());
  const std::vector<Carrier> of = found.of;
  for_each_run(
      0, frames, [&](int frame) { return of[static_cast<std::size_t>(frame)]; },
      [&](int first, int last) {
        const auto begin = static_cast<std::size_t>(first), end = static_cast<std::size_t>(last);
        if (of[begin] != Carrier::kNothing || first == 0 || last == frames) return;
        if (is_missing_surface(of[begin - 1]) != is_missing_surface(of[end])) return;
        if ((last - first) * frame_time > kLongestFlight) return;
        std::fill(found.of.begin() + first, found.of.begin() + last, of[begin - 1]);
        std::fill(found.raised.begin() + first, found.raised.begin() + last,
                  found.raised[begin - 1]);
      });
}

// A robot that stays in the air for longer than a flight is on a surface, even if the source has no
// known support.
void add_long_flights(const std::vector<Lowest>& lowest, const std::vector<char>& touches_scene,
                      double frame_time, Carriers& found) {
  const int frames = std::min(static_cast<int>(found.of.size()), static_cast<int>(lowest.size()));
  const auto is_aloft = [&](int frame) {
    const auto i = static_cast<std::size_t>(frame);
    const bool on_scene = i < touches_scene.size() && touches_scene[i] != 0;
    return !on_scene && std::isfinite(lowest[i].height) && lowest[i].height > kHovers;
  };
  for_each_run_where(0, frames, is_aloft, [&](int first, int last) {
    if ((last - first) * frame_time <= kLongestFlight) return;
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
      if (found.of[i] != Carrier::kNothing) continue;
      found.of[i] = Carrier::kMissingSurface;
      found.raised[i] = lowest[i].height;
    }
  });
}

}  // namespace

std::vector<char> measure_missing_surfaces(const ReportBuilder& draft, const BodyTracks& tracks,
                                           const ContactPlan& contacts, int frames,
                                           const std::vector<SeatRest>& seats,
                                           const std::vector<char>& touches_scene) {
  Carriers carriers = find_carriers(contacts, frames, seats, touches_scene);
  const double frame_time = draft.clip.rate().frame_time();
  bridge_flights(frame_time, carriers);
  std::vector<char> unknown;
  for (const Carrier carrier : carriers.of) unknown.push_back(carrier == Carrier::kNothing ? 1 : 0);
  add_long_flights(tracks.lowest, touches_scene, frame_time, carriers);
  FaultList faults("missing_surface_pct", "m");
  int missing = 0, known = 0;
  for (std::size_t i = 0; i < carriers.of.size(); ++i) {
    if (carriers.of[i] == Carrier::kNothing) continue;
    ++known;
    if (!is_missing_surface(carriers.of[i])) continue;
    ++missing;
    faults.add(carriers.of[i] == Carrier::kSeat ? "seat" : "soles", static_cast<int>(i),
               carriers.raised[i]);
  }
  // In a few frames with a known support, for example of a toe that moves slowly, the share says
  // little about the motion.
  constexpr double kLeastShare = 0.25;  // Of all frames.
  draft.set("missing_surface_pct",
            percent(missing, std::max<double>(known, kLeastShare * static_cast<double>(frames))));
  faults.move_to(draft.report, draft.options.faults_per_metric);
  return unknown;
}

}  // namespace retarget
