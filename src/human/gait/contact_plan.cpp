#include <algorithm>
#include <cstddef>
#include <iterator>

#include "human/gait/contact_plan.h"
#include "human/gait/frame_runs.h"
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
    for_each_run_where(phase.begin, phase.end, is_down, [&](int begin, int end) {
      const bool long_enough = (end - begin) * source.frame_time > shortest - 1e-9;
      const bool whole = begin == phase.begin && end == phase.end;
      if (long_enough || whole) soles.push_back({begin, end, phase.support});
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
// Mean height of the shoulders of a body that lies on its back, its front or a side. The shoulders
// of a body that props itself up on an elbow are higher, even if its chest is low.
constexpr RestHeights kShouldersRest{0.22, 0.26};
// Height of the wrist of a hand that carries the whole body. While feet, knees and seat are at
// least kAloft above the floor and the hand is still, it stands on something, even if only on its
// fingers.
constexpr RestHeights kHandstandRest{0.22, 0.25};
// Height in metres of the wrist of a hand that is pressed to the floor, and the speed in m/s up to
// which it counts as in contact.
constexpr double kPressed = 0.05, kCatchSpeed = 0.3;
// Indices into kSupportBones.
constexpr std::size_t kLeftKnee = 0, kRightKnee = 1, kSeat = 6;
// Indices into kUpperBones.
constexpr std::size_t kUpperLeftShoulder = 0, kUpperRightShoulder = 1;

RestHeights rest_of(Bone bone) {
  if (bone == Bone::kHips) return kSeatRest;
  return bone == Bone::kSpine2 ? kBackRest : kJointRest;
}

// Finds the contacts of one body part.
class BodyContactFinder {
 public:
  BodyContactFinder(const SourceFeet& source, std::size_t support, double floor, double scale,
                    const ContactOptions& options)
      : source_(source),
        support_(support),
        rest_(rest_of(kSupportBones[support])),
        is_hand_(limb_bone(kSupportBones[support]) == LimbBone::kHand),
        is_back_(kSupportBones[support] == Bone::kSpine2),
        floor_(floor),
        scale_(scale),
        options_(options) {}

  void find(std::vector<ContactPhase>& phases) const {
    add_runs([&](int frame, bool on) { return rests(frame, on); }, phases);
    if (is_hand_) add_catches(phases);
  }

 private:
  [[nodiscard]] double over_floor(const Eigen::Vector3d& joint) const {
    return (joint.z() - floor_) / scale_;
  }
  [[nodiscard]] double height(int frame) const {
    return over_floor(source_.support(frame, support_));
  }
  [[nodiscard]] bool is_slow(int frame, double speed) const {
    return source_.support_speed(frame, support_) <= speed * scale_;
  }

  // @param on  whether it rests in the frame before.
  [[nodiscard]] bool rests(int frame, bool on) const {
    const RestHeights& rest = is_hand_ && stands_on_hands(frame) ? kHandstandRest : rest_;
    return height(frame) <= (on ? rest.end : rest.begin) &&
           is_slow(frame, on ? options_.end_speed : options_.begin_speed) &&
           (!is_back_ || shoulders_are_low(frame, on));
  }

  [[nodiscard]] bool shoulders_are_low(int frame, bool on) const {
    if (source_.uppers.empty() || !source_.has_upper[kUpperLeftShoulder] ||
        !source_.has_upper[kUpperRightShoulder])
      return true;
    const double mean = 0.5 * (source_.upper(frame, kUpperLeftShoulder).z() +
                               source_.upper(frame, kUpperRightShoulder).z());
    return (mean - floor_) / scale_ <= (on ? kShouldersRest.end : kShouldersRest.begin);
  }

  // Whether everything that could carry the body instead of the arms is far up.
  [[nodiscard]] bool stands_on_hands(int frame) const {
    for (int foot = 0; foot < source_.foot_count; ++foot) {
      const SourceFoot& of_foot = source_.at(frame, foot);
      if (std::min(over_floor(of_foot.ankle), over_floor(of_foot.toe)) < kAloft) return false;
    }
    for (const std::size_t other : {kLeftKnee, kRightKnee, kSeat}) {
      if (!source_.has_support[other]) return false;
      if (over_floor(source_.support(frame, other)) < kAloft) return false;
    }
    return true;
  }

  // A hand that catches a fall or pushes the body off is briefly on the floor, but not as slow as
  // one that rests.
  void add_catches(std::vector<ContactPhase>& phases) const {
    const auto resting = static_cast<std::ptrdiff_t>(phases.size());
    add_runs(
        [&](int frame, bool) { return height(frame) <= kPressed && is_slow(frame, kCatchSpeed); },
        phases);
    const auto first = phases.begin() + resting;
    const auto overlaps = [&](const ContactPhase& added) {
      return std::any_of(phases.begin(), first, [&](const ContactPhase& found) {
        return added.begin <= found.end && found.begin <= added.end;
      });
    };
    phases.erase(std::remove_if(first, phases.end(), overlaps), phases.end());
    std::ranges::sort(phases, {}, &ContactPhase::begin);
  }

  template <typename Touches>
  void add_runs(const Touches& touches, std::vector<ContactPhase>& phases) const {
    const int frames = source_.frame_count();
    for (int begin = 0; begin < frames;) {
      int end = begin;
      while (end < frames && touches(end, end > begin)) ++end;
      if (end > begin && (end - begin) * source_.frame_time >= options_.shortest - 1e-9) {
        phases.push_back({begin, end, 0.0});
      }
      begin = std::max(end, begin + 1);
    }
  }

  const SourceFeet& source_;
  std::size_t support_;
  RestHeights rest_;
  bool is_hand_, is_back_;
  double floor_, scale_;
  const ContactOptions& options_;
};

double floor_below(const StandingHeights& standing, double scale) {
  // A floor below the body touches known soles.
  if (standing.from_body && standing.ankle_over_heel != 0.0) return standing.toe;
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
    if (!source.has_support[i]) continue;
    BodyContactFinder(source, i, floor, scale, options).find(contacts[i]);
  }
}

std::vector<FrameRange> foot_stances(const ContactPlan& contacts, int foot, int count,
                                     double frame_time) {
  constexpr double kSameStance = 0.1;  // Seconds.
  const int same = frames_in(kSameStance, frame_time);
  std::vector<FrameRange> stances;
  const auto stands = [&](int frame) {
    return contacts.in_contact(foot, kHeelEnd, frame) || contacts.in_contact(foot, kToeEnd, frame);
  };
  for_each_run_where(0, count, stands, [&](int begin, int end) {
    if (!stances.empty() && begin - stances.back().end < same) {
      stances.back().end = end;
    } else {
      stances.push_back({begin, end});
    }
  });
  return stances;
}

}  // namespace retarget
