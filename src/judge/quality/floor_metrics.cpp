#include "judge/quality/body_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "human/gait/frame_runs.h"
#include "judge/quality/contact_motion.h"
#include "judge/quality/report_parts.h"
#include "retarget/human.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

constexpr double kDeep = 0.01;  // Penetration depth that a metric counts, metres.
constexpr double kHigh = kSoleHigh;

const std::string& name_of(const ReportBuilder& draft, int body) {
  return draft.clip.robot().bodies()[body].name;
}

// Measures the percentage of penetrating frames, the maximum depth and the faults.
// @param lowest          lowest point by frame.
// @param share, deepest  keys of the two metrics.
void measure_depth(const ReportBuilder& draft, const std::vector<Lowest>& lowest,
                   std::string_view share, std::string_view deepest) {
  FaultList faults(share, "m");
  int deep = 0;
  double min = HUGE_VAL;
  for (std::size_t i = 0; i < lowest.size(); ++i) {
    min = std::min(min, lowest[i].height);
    if (lowest[i].height >= -kDeep) continue;
    ++deep;
    faults.add(name_of(draft, lowest[i].body), static_cast<int>(i), -lowest[i].height);
  }
  draft.set(share, percent(deep, static_cast<double>(lowest.size())));
  draft.set(deepest, -kInCm * min);
  faults.move_to(draft.report, draft.options.faults_per_metric);
}

void measure_flat_slip(const ReportBuilder& draft, const BodyTracks& tracks) {
  std::vector<double> slips;
  for (const SoleTrack& track : tracks.soles) {
    for (int frame = 0; frame + 1 < draft.clip.frame_count(); ++frame) {
      if (track.highest(frame) >= kHigh || track.highest(frame + 1) >= kHigh) continue;
      const Eigen::Vector3d step = track.middle(frame + 1) - track.middle(frame);
      slips.push_back(step.head<2>().norm() * draft.clip.rate().fps());
    }
  }
  if (slips.empty()) return;
  draft.set("flat_slip_p50", median(slips));
  draft.set("flat_slip_p95", percentile(std::move(slips), 95.0));
}

// Adds a fault for each frame with a deep contact. @return the largest depth, metres.
double deepest_of(const ReportBuilder& draft, const std::vector<SelfContact>& contacts,
                  FaultList& faults) {
  double deepest = 0.0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const SelfContact& contact = contacts[i];
    deepest = std::max(deepest, contact.depth);
    if (contact.depth <= kDeep) continue;
    faults.add(name_of(draft, contact.body_a) + " in " + name_of(draft, contact.body_b),
               static_cast<int>(i), contact.depth);
  }
  return deepest;
}

void measure_self_contact(const ReportBuilder& draft, const BodyTracks& tracks) {
  if (tracks.self_contact.empty()) return;
  int deep = 0;
  double deepest = 0.0;
  for (const double depth : tracks.sampled_depth) {
    if (depth > kDeep) ++deep;
    deepest = std::max(deepest, depth);
  }
  draft.set("self_1cm_pct", percent(deep, static_cast<double>(tracks.sampled_depth.size())));
  draft.set("self_max_cm", kInCm * deepest);

  FaultList faults("self_all_1cm_pct", "m");
  deepest = deepest_of(draft, tracks.self_contact, faults);
  const auto all_deep = std::ranges::count_if(
      tracks.self_contact, [](const SelfContact& contact) { return contact.depth > kDeep; });
  draft.set("self_all_1cm_pct",
            percent(static_cast<int>(all_deep), static_cast<double>(tracks.self_contact.size())));
  draft.set("self_all_max_cm", kInCm * deepest);
  faults.move_to(draft.report, draft.options.faults_per_metric);
}

void measure_crossings(const ReportBuilder& draft, const BodyTracks& tracks) {
  if (tracks.crossings.empty()) return;
  FaultList faults("self_crossing_max_cm", "m");
  draft.set("self_crossing_max_cm", kInCm * deepest_of(draft, tracks.crossings, faults));
  faults.move_to(draft.report, draft.options.faults_per_metric);
}

// Motion and agreement of the soles over all contacts of a clip.
struct ContactFigures {
  ContactMotion motion;
  // Numbers of feet and frames: all; source in contact; also robot in contact; both equal.
  int all = 0, in_contact = 0, kept = 0, agreed = 0;
  std::vector<char> floating;  // One per frame: source in contact and robot above the floor.
};

void add_phase(const ReportBuilder& draft, const SoleTrack& track, const ContactPhase& phase,
               ContactFigures& figures, FaultList& slipping) {
  std::vector<Eigen::Vector3d> middles;
  for (int frame = phase.begin; frame < phase.end; ++frame) {
    middles.push_back(track.middle(frame));
    figures.motion.heights.push_back(track.lowest(frame));
  }
  figures.motion.add(middles, phase.begin, draft.clip.rate().fps(),
                     name_of(draft, track.sole->body), slipping);
}

// The contact phases of a source foot on the floor. Raised stances are excluded, because heights
// are measured from the floor.
std::vector<ContactPhase> phases_of(const std::array<std::vector<ContactPhase>, 2>& phases,
                                    const SoleTrack& track) {
  return on_floor(phases[track.sole->side == "left" ? 0 : 1]);
}

// The parts of the phases during which the body is upright.
std::vector<ContactPhase> while_upright(const std::vector<ContactPhase>& phases,
                                        const Posture& posture) {
  std::vector<ContactPhase> parts;
  for (const ContactPhase& phase : phases) {
    const auto is_upright = [&](int frame) { return posture.is_upright(frame); };
    for_each_run_where(phase.begin, phase.end, is_upright, [&](int begin, int end) {
      parts.push_back({begin, end, phase.support});
    });
  }
  return parts;
}

void add_foot(const ReportBuilder& draft, const BodyTracks& tracks, const SoleTrack& track,
              const std::vector<ContactPhase>& phases, ContactFigures& figures,
              FaultList& slipping) {
  const int frames = static_cast<int>(figures.floating.size());
  std::vector<char> in_contact(frames, 0);
  for (const ContactPhase& phase : phases) {
    add_phase(draft, track, phase, figures, slipping);
    for (int frame = phase.begin; frame < phase.end; ++frame) {
      in_contact[frame] = 1;
      if (tracks.lowest[frame].height > kHigh) figures.floating[frame] = 1;
    }
  }
  for (int frame = 0; frame < frames; ++frame) {
    const bool stood = track.stands(frame, draft.clip.rate().fps());
    ++figures.all;
    if (in_contact[frame] != 0) ++figures.in_contact;
    if (in_contact[frame] != 0 && stood) ++figures.kept;
    if ((in_contact[frame] != 0) == stood) ++figures.agreed;
  }
}

}  // namespace

void measure_bodies(const ReportBuilder& draft, const BodyTracks& tracks) {
  const bool soles = !tracks.soles.empty();
  if (soles) {
    measure_depth(draft, tracks.lowest_sole, "foot_pen_1cm_pct", "foot_pen_max_cm");
  }
  const bool floor = !draft.clip.robot().fixed_base();
  if (floor && (soles || !tracks.self_contact.empty())) {
    measure_depth(draft, tracks.lowest, "body_pen_1cm_pct", "body_pen_max_cm");
    const auto high =
        std::ranges::count_if(tracks.lowest, [](const Lowest& low) { return low.height > kHigh; });
    draft.set("float_2cm_pct",
              percent(static_cast<double>(high), static_cast<double>(tracks.lowest.size())));
  }
  if (soles) {
    std::vector<double> heights;
    for (const Lowest& low : tracks.lowest_sole) heights.push_back(kInCm * low.height);
    draft.set("sole_height_p50_cm", median(std::move(heights)));
    measure_flat_slip(draft, tracks);
  }
  measure_self_contact(draft, tracks);
  measure_crossings(draft, tracks);
}

void measure_contacts(const ReportBuilder& draft, const BodyTracks& tracks,
                      const ContactPlan& contacts, int frames) {
  ContactFigures figures;
  figures.floating.assign(frames, 0);
  FaultList slipping("contact_slip_mean", "m/s"), floating("float_planted_pct", "m");
  for (const SoleTrack& track : tracks.soles) {
    add_foot(draft, tracks, track, phases_of(contacts.phases, track), figures, slipping);
  }
  if (figures.all == 0) return;
  int afloat = 0;
  for (int frame = 0; frame < frames; ++frame) {
    if (figures.floating[frame] == 0) continue;
    ++afloat;
    floating.add(name_of(draft, tracks.lowest[frame].body), frame, tracks.lowest[frame].height);
  }
  draft.set("float_planted_pct", percent(afloat, draft.clip.frame_count()));
  draft.set("contact_agreement_pct", percent(figures.agreed, figures.all));
  floating.move_to(draft.report, draft.options.faults_per_metric);
  if (figures.motion.slips.empty()) return;
  draft.set("contact_pct", percent(figures.in_contact, 2.0 * draft.clip.frame_count()));
  draft.set("contact_kept_pct", percent(figures.kept, figures.in_contact));
  draft.set("contact_slip_mean", mean(figures.motion.slips));
  draft.set("contact_slip_p95", percentile(std::move(figures.motion.slips), 95.0));
  draft.set("contact_drift_p95_cm", kInCm * percentile(std::move(figures.motion.drifts), 95.0));
  draft.set("contact_height_p50_cm", kInCm * median(std::move(figures.motion.heights)));
  slipping.move_to(draft.report, draft.options.faults_per_metric);
}

void measure_stances(const ReportBuilder& draft, const BodyTracks& tracks,
                     const ContactPlan& contacts, const Posture& posture) {
  ContactFigures figures;
  FaultList slipping("stance_slip_mean", "m/s");
  for (const SoleTrack& track : tracks.soles) {
    for (const ContactPhase& phase : while_upright(phases_of(contacts.soles, track), posture)) {
      add_phase(draft, track, phase, figures, slipping);
    }
  }
  if (figures.motion.slips.empty()) return;
  draft.set("stance_pct", percent(static_cast<double>(figures.motion.heights.size()),
                                  2.0 * draft.clip.frame_count()));
  draft.set("stance_slip_mean", mean(figures.motion.slips));
  draft.set("stance_drift_p95_cm", kInCm * percentile(std::move(figures.motion.drifts), 95.0));
  draft.set("stance_height_p50_cm", kInCm * median(std::move(figures.motion.heights)));
  slipping.move_to(draft.report, draft.options.faults_per_metric);
}

}  // namespace retarget
