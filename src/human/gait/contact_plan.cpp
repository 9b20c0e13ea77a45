#include "human/gait/contact_plan.h"

#include <algorithm>
#include <iterator>
#include <vector>

#include "human/gait/contact_planner.h"
#include "human/gait/frame_runs.h"

namespace retarget {
namespace {

bool is_in_contact(const std::vector<ContactPhase>& phases, int frame) {
  const auto after = std::ranges::upper_bound(phases, frame, {}, &ContactPhase::begin);
  return after != phases.begin() && frame < std::prev(after)->end;
}

}  // namespace

bool ContactPlan::in_contact(int foot, int frame) const {
  return is_in_contact(phases[foot], frame);
}

bool ContactPlan::in_contact(int foot, int end, int frame) const {
  return is_in_contact(ends[foot][end].phases, frame);
}

SourceContacts ContactPlan::of_ends() const {
  return {ends[0][kHeelEnd].phases, ends[0][kToeEnd].phases, ends[1][kHeelEnd].phases,
          ends[1][kToeEnd].phases};
}

std::vector<ContactPhase> on_floor(std::vector<ContactPhase> phases) {
  std::erase_if(phases, [](const ContactPhase& phase) { return phase.support != 0.0; });
  return phases;
}

ContactPlan find_contacts(const SourceFeet& source, const ContactOptions& options) {
  return ContactPlanner().plan(source, options);
}

ContactPlan find_contacts(const HumanClip& human, const ContactOptions& options) {
  return find_contacts(SourceFeet(human, human.frame_count), options);
}

void phases_on_sole(const SourceFeet& source, int foot, const std::vector<ContactPhase>& phases,
                    double shortest, std::vector<ContactPhase>& soles) {
  const auto is_down = [&](int frame) { return source.at(frame, foot).sole_up > kSoleUp; };
  soles.clear();
  for (const ContactPhase& phase : phases) {
    for_each_run(phase.begin, phase.end, is_down, [&](int begin, int end) {
      const bool long_enough = (end - begin) * source.frame_time > shortest - 1e-9;
      const bool whole = begin == phase.begin && end == phase.end;
      if (is_down(begin) && (long_enough || whole)) soles.push_back({begin, end, phase.support});
    });
  }
}

}  // namespace retarget
