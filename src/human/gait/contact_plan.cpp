#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <vector>

#include "human/gait/contact_plan.h"
#include "human/gait/contact_planner.h"
#include "human/gait/frame_runs.h"
#include "human/gait/source_feet.h"
#include "human/gait/standing_heights.h"

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

// Detects when a human's knees, elbows, hands, seat and back rest on the floor.

namespace {

// Joint heights above the floor at which a body with legs of kUsualSourceLeg rests, metres. In
// motion capture data, slow knees, wrists and elbows are either below 8 cm or much higher. The hip
// and chest joints lie inside the body: at 4 to 17 cm and 3 to 12 cm when it lies down.
struct RestHeights {
  double begin, end;
};
constexpr RestHeights kJointRest{0.09, 0.12}, kSeatRest{0.17, 0.20}, kBackRest{0.13, 0.17};
constexpr double kDrift = 0.04;      // Largest movement of a resting joint, metres.
constexpr double kToeHeight = 0.02;  // Height of the toe joint of a standing foot, metres.

RestHeights rest_of(Bone bone) {
  if (bone == Bone::kHips) return kSeatRest;
  return bone == Bone::kSpine2 ? kBackRest : kJointRest;
}

void add_phases_of(const SourceFeet& source, std::size_t support, double floor, double scale,
                   const ContactOptions& options, std::vector<ContactPhase>& phases) {
  const RestHeights rest = rest_of(kSupportBones[support]);
  const auto place = [&](int frame) -> const Eigen::Vector3d& {
    return source.support(frame, support);
  };
  const auto rests = [&](int frame, bool before) {
    return place(frame).z() - floor <= (before ? rest.end : rest.begin) * scale &&
           source.support_speed(frame, support) <=
               (before ? options.end_speed : options.begin_speed) * scale;
  };
  const int frames = source.frame_count();
  for (int begin = 0; begin < frames;) {
    int end = begin;
    // A body that slides or rolls slowly gives a sequence of short contacts.
    while (end < frames && rests(end, end > begin) &&
           (place(end) - place(begin)).norm() <= kDrift * scale) {
      ++end;
    }
    if ((end - begin) * source.frame_time >= options.shortest - 1e-9) {
      phases.push_back({begin, end, 0.0});
    }
    begin = std::max(end, begin + 1);
  }
}

double floor_below(const StandingHeights& standing, double scale) {
  return standing.toe - kToeHeight * scale;
}

}  // namespace

double floor_height(const ContactPlan& contacts) {
  return floor_below(contacts.standing, contacts.scale);
}

double rest_height(std::size_t support, double scale) {
  return rest_of(kSupportBones[support]).begin * scale;
}

void find_body_contacts(const SourceFeet& source, const StandingHeights& standing, double scale,
                        const ContactOptions& options, BodyContacts& contacts) {
  for (auto& phases : contacts) phases.clear();
  if (source.foot_count == 0 || source.supports.empty()) return;
  const double floor = floor_below(standing, scale);
  for (std::size_t i = 0; i < kSupportBones.size(); ++i) {
    if (source.has_support[i]) add_phases_of(source, i, floor, scale, options, contacts[i]);
  }
}

}  // namespace retarget
