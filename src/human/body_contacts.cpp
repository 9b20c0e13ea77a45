// when a human's knees, elbows, hands, seat and back lie on the floor

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "human/contact_plan.h"
#include "human/source_feet.h"

namespace retarget {
namespace {

// Heights of joints over the floor on which a body with legs of kUsualSourceLeg rests, metres. In motion
// capture slow knees, wrists and elbows are lower than 8 cm or far higher; hips and the chest's joint are in the
// middle of a body that lies: 4 to 17 and 3 to 12 cm.
struct RestHeights {
  double begin, end;
};
constexpr RestHeights kJointRest{0.09, 0.12}, kSeatRest{0.17, 0.20}, kBackRest{0.13, 0.17};
constexpr double kDrift = 0.04;      // how far a joint moves that rests in one place, metres
constexpr double kToeHeight = 0.02;  // of where toes begin, of a foot that stands

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
    // a body that slides or rolls slowly rests in one place after the other
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

}  // namespace

void find_body_contacts(const SourceFeet& source, const StandingHeights& standing, double scale,
                        const ContactOptions& options, BodyContacts& contacts) {
  for (auto& phases : contacts) phases.clear();
  if (source.foot_count == 0 || source.supports.empty()) return;
  const double floor = standing.toe - kToeHeight * scale;
  for (std::size_t i = 0; i < kSupportBones.size(); ++i) {
    if (source.has_support[i]) add_phases_of(source, i, floor, scale, options, contacts[i]);
  }
}

}  // namespace retarget
