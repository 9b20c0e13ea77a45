#include "human/gait/surface_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "human/gait/contact_plan.h"
#include "human/gait/frame_runs.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// Distances and speeds for a body with legs of kUsualSourceLeg. The radius of a part is the
// distance of its points from the skin, which skeletons do not define; the thresholds cover its
// error.
constexpr double kBeginDistance = 0.03, kEndDistance = 0.05;  // Metres.
constexpr double kBeginSpeed = 0.3, kEndSpeed = 0.5;          // m/s, relative to the body.
// A part that rests by the rules for the floor must come this near, metres. Few hands move slowly
// just above a floor, but many do above a table. In recordings of people on the floor, parts at
// rest come within 3 cm.
constexpr double kRestDistance = 0.04;
// A contact slides if it moves along the surface by more than this, metres, or always faster than
// this, m/s: a hand that passes over a surface touches it too briefly to move far.
constexpr double kSlideReach = 0.08, kSlideSpeed = 0.15;
// Maximum movement of the nearest surface point before the contact position moves, metres.
constexpr double kStickReach = 0.03;
// The search for the ground below a joint, or the end of a foot, starts this far above it, metres.
constexpr double kAboveJoint = 0.12;
// Maximum depth below the ground of a joint, or the end of a foot, that rests on it, metres.
constexpr double kSunkJoint = 0.05;
// A surface of this height is not the floor, metres.
constexpr double kRaised = 0.015;

// Tracks a contact position that does not change while the nearest point stays within a radius.
class StickingPlace {
 public:
  StickingPlace(const Vector3d& first, double radius) : place_(first), radius_(radius) {}
  const Vector3d& follow(const Vector3d& nearest) {
    const Vector3d away = nearest - place_;
    const double distance = away.norm();
    if (distance > radius_) place_ += (distance - radius_) / distance * away;
    return place_;
  }

 private:
  Vector3d place_;
  double radius_;
};

// Finds the contacts of one part with one body of a scene.
class SurfaceContactFinder {
 public:
  SurfaceContactFinder(const SceneWorld& world, const SurfaceParts& parts, std::size_t part,
                       std::size_t body, const ContactPlan& contacts, const ContactOptions& options,
                       double frame_time)
      : world_(world),
        parts_(parts),
        rests_(contacts.bodies_above_floor[part]),
        part_(part),
        body_(body),
        size_(parts.scale()),
        shortest_(options.shortest),
        frame_time_(frame_time) {
    const int frames = std::min(parts.frame_count(), world.clip.frame_count);
    distances_.reserve(static_cast<std::size_t>(frames));
    places_.reserve(static_cast<std::size_t>(frames));
    for (int frame = 0; frame < frames; ++frame) {
      const SurfaceParts::Nearest nearest = parts.nearest(world, frame, part, body);
      distances_.push_back(nearest.distance);
      places_.push_back(world.clip.pose(frame, body).inverse() * nearest.on_surface);
    }
  }

  void find(std::vector<SurfacePhase>& phases) const {
    std::vector<char> touches(distances_.size());
    if (!take_stated(touches)) {
      detect(touches);
      rest(touches);
      bridge_gaps(touches);
    }
    const auto in_contact = [&](int frame) {
      return touches[static_cast<std::size_t>(frame)] != 0;
    };
    for_each_run_where(0, static_cast<int>(touches.size()), in_contact, [&](int begin, int end) {
      if ((end - begin) * frame_time_ >= shortest_ - 1e-9) phases.push_back(phase(begin, end));
    });
  }

 private:
  [[nodiscard]] int frame_count() const { return static_cast<int>(places_.size()); }

  // Takes the contacts that a file states. @return whether it states any.
  bool take_stated(std::vector<char>& touches) const {
    for (const StatedContact& stated : world_.clip.contacts) {
      if (stated.body != body_ || stated.part != kSupportNames[part_]) continue;
      std::copy_n(stated.touches.begin(), std::min(stated.touches.size(), touches.size()),
                  touches.begin());
      return true;
    }
    return false;
  }

  void detect(std::vector<char>& touches) const {
    bool on = false;
    for (std::size_t frame = 0; frame < touches.size(); ++frame) {
      on = distances_[frame] <= (on ? kEndDistance : kBeginDistance) * size_ &&
           speed(static_cast<int>(frame)) <= (on ? kEndSpeed : kBeginSpeed) * size_;
      touches[frame] = on ? 1 : 0;
    }
  }

  // Adds the frames in which the part rests on the body as on a floor.
  void rest(std::vector<char>& touches) const {
    if (!world_.is_fixed(body_)) return;
    for (const ContactPhase& phase : rests_) {
      const auto is_near = [&](int frame) {
        if (distances_[static_cast<std::size_t>(frame)] > kEndDistance * size_) return false;
        Vector3d place = parts_.joint(frame, part_);
        place.z() = phase.support;
        return body_under(world_, frame, place, size_) == static_cast<int>(body_);
      };
      for_each_run_where(
          phase.begin, std::min(phase.end, frame_count()), is_near, [&](int begin, int end) {
            const double nearest =
                *std::min_element(distances_.begin() + begin, distances_.begin() + end);
            if (nearest > kRestDistance * size_) return;
            std::fill(touches.begin() + begin, touches.begin() + end, char{1});
          });
    }
  }

  // Speed of the nearest point over the surface and of the distance, m/s.
  [[nodiscard]] double speed(int frame) const {
    const int half = frames_in(1.0 / 30.0, frame_time_);
    const int last = frame_count() - 1;
    const auto from = static_cast<std::size_t>(std::max(0, frame - half));
    const auto to = static_cast<std::size_t>(std::min(last, frame + half));
    if (from == to) return 0.0;
    const double over = (places_[to] - places_[from]).norm();
    const double towards = distances_[to] - distances_[from];
    return std::sqrt(over * over + towards * towards) /
           (frame_time_ * static_cast<double>(to - from));
  }

  // A part that stays near the surface between two contacts does not leave it.
  void bridge_gaps(std::vector<char>& touches) const {
    constexpr double kGap = 0.1;  // Seconds.
    const int count = static_cast<int>(touches.size());
    const auto is_free = [&](int frame) { return touches[static_cast<std::size_t>(frame)] == 0; };
    for_each_run_where(0, count, is_free, [&](int begin, int end) {
      if (begin == 0 || end == count || (end - begin) * frame_time_ > kGap) return;
      for (int frame = begin; frame < end; ++frame) {
        if (distances_[static_cast<std::size_t>(frame)] > kEndDistance * size_) return;
      }
      std::fill(touches.begin() + begin, touches.begin() + end, char{1});
    });
  }

  [[nodiscard]] SurfacePhase phase(int begin, int end) const {
    SurfacePhase found{part_, body_, begin, end, false, {}};
    StickingPlace place(places_[static_cast<std::size_t>(begin)], kStickReach * size_);
    for (int frame = begin; frame < end; ++frame) {
      found.places.push_back(place.follow(places_[static_cast<std::size_t>(frame)]));
    }
    Eigen::AlignedBox3d box;
    for (const Vector3d& point : found.places) box.extend(point);
    const double way =
        (places_[static_cast<std::size_t>(end - 1)] - places_[static_cast<std::size_t>(begin)])
            .norm();
    found.slides = box.diagonal().norm() > kSlideReach * size_ ||
                   way > kSlideSpeed * size_ * frame_time_ * (end - begin - 1);
    if (found.slides) return found;
    const Vector3d middle = box.center();
    std::ranges::fill(found.places, middle);
    return found;
  }

  const SceneWorld& world_;
  const SurfaceParts& parts_;
  const std::vector<ContactPhase>& rests_;
  std::size_t part_, body_;
  double size_, shortest_, frame_time_;
  std::vector<double> distances_;  // One per frame.
  std::vector<Vector3d> places_;   // One per frame, in the frame of the body.
};

// Height of the ground under a joint or an end of a foot, metres.
double ground_under(const SceneWorld& world, int frame, const Vector3d& point, double scale) {
  const double ground = world.ground_below(frame, point + kAboveJoint * scale * Vector3d::UnitZ());
  // A foot that passes through the edge of a step does not stand on it.
  return point.z() > ground - kSunkJoint * scale ? ground : 0.0;
}

// Feet and other parts above the ground under them instead of above z = 0. The hips keep their
// heights, which show whether the body falls.
SourceFeet feet_over_ground(const SceneWorld& world, SourceFeet feet, double scale) {
  for (int frame = 0; frame < feet.frame_count(); ++frame) {
    const auto lower = [&](Vector3d& point) {
      point.z() -= ground_under(world, frame, point, scale);
    };
    for (int foot = 0; foot < feet.foot_count; ++foot) {
      SourceFoot& of_frame = feet.feet[static_cast<std::size_t>(frame * feet.foot_count + foot)];
      lower(of_frame.ankle);
      lower(of_frame.toe);
      if (of_frame.heel) lower(*of_frame.heel);
    }
    for (auto* places : {&feet.supports, &feet.uppers}) {
      const std::size_t count = places->size() / static_cast<std::size_t>(feet.frame_count());
      const auto first = static_cast<std::size_t>(frame) * count;
      std::ranges::for_each(std::span(*places).subspan(first, count), lower);
    }
  }
  return feet;
}

// Sets the heights of the surfaces on which feet stand; contacts found over the ground have none.
void add_ground(const SceneWorld& world, const SourceFeet& feet, ContactPlan& contacts) {
  std::vector<double> heights;
  const auto ground = [&](int begin, int end, const auto& place_at) {
    heights.clear();
    for (int frame = begin; frame < end; ++frame) {
      heights.push_back(world.ground_below(
          frame, place_at(frame) + kAboveJoint * contacts.scale * Vector3d::UnitZ()));
    }
    return median_in_place(heights);
  };
  for (std::size_t foot = 0; foot < contacts.ends.size(); ++foot) {
    const auto end_at = [&](int end) {
      return
          [&feet, foot, end](int frame) { return feet.at(frame, static_cast<int>(foot)).end(end); };
    };
    for (const int end : {kHeelEnd, kToeEnd}) {
      for (ContactPhase& phase : contacts.ends[foot][static_cast<std::size_t>(end)].phases) {
        phase.support += ground(phase.begin, phase.end, end_at(end));
      }
    }
    for (auto* phases : {&contacts.phases[foot], &contacts.soles[foot]}) {
      for (ContactPhase& phase : *phases) {
        phase.support += ground(phase.begin, phase.end, end_at(kToeEnd));
      }
    }
  }
  for (std::size_t part = 0; part < kSupportBones.size(); ++part) {
    const auto joint_at = [&](int frame) { return feet.support(frame, part); };
    std::vector<ContactPhase> on_floor;
    for (const ContactPhase& phase : contacts.bodies[part]) {
      const double height = ground(phase.begin, phase.end, joint_at);
      if (height > kRaised) {
        contacts.bodies_above_floor[part].push_back({phase.begin, phase.end, height});
      } else {
        on_floor.push_back(phase);
      }
    }
    contacts.bodies[part] = std::move(on_floor);
  }
}

// The static bodies on which feet stand, for each phase of ContactPlan::of_ends; -1: the floor, or
// something that the scene does not have.
// @param contacts  result of find_contacts_on_ground.
std::array<std::vector<int>, 4> bodies_under_feet(const SceneWorld& world, const SourceFeet& feet,
                                                  const ContactPlan& contacts) {
  const SourceContacts ends = contacts.of_ends();
  std::array<std::vector<int>, 4> bodies;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const int foot = static_cast<int>(i) / 2, end = static_cast<int>(i) % 2;
    for (const ContactPhase& phase : ends[i]) {
      const int frame = (phase.begin + phase.end - 1) / 2;
      Vector3d place = feet.at(frame, foot).end(end);
      place.z() = phase.support;
      bodies[i].push_back(body_under(world, frame, place, contacts.scale));
    }
  }
  return bodies;
}

}  // namespace

int body_under(const SceneWorld& world, int frame, const Vector3d& place, double scale) {
  constexpr double kOnSurface = 0.05;  // Metres.
  // The floor is nearest unless a body is nearer.
  double nearest = std::min(place.z(), kOnSurface * scale);
  int under = -1;
  for (std::size_t body = 0; body < world.body_count(); ++body) {
    if (!world.is_fixed(body)) continue;
    const double distance = std::abs(world.distance(frame, body, place).distance);
    if (distance >= nearest) continue;
    nearest = distance;
    under = static_cast<int>(body);
  }
  return under;
}

SurfaceParts::SurfaceParts(const HumanClipInfo& human, double scale) : scale_(scale) {
  // Distances from the joint to the skin: half the thickness of a limb, and of the trunk.
  constexpr double kLimb = 0.055, kSeat = 0.13, kBack = 0.11;
  constexpr double kWrist = 0.035, kPalm = 0.03, kTip = 0.015;
  constexpr double kPalmReach = 0.09, kTipReach = 0.17;
  for (std::size_t part = 0; part < kSupportBones.size(); ++part) {
    const Bone bone = kSupportBones[part];
    has_[part] = human.has(bone);
    first_[part] = per_frame_;
    if (!has_[part]) continue;
    if (bone == Bone::kHips || bone == Bone::kSpine2) {
      points_[part] = {{bone, 0.0, scale * (bone == Bone::kHips ? kSeat : kBack)}};
    } else if (limb_bone(bone) == LimbBone::kHand) {
      points_[part] = {{bone, 0.0, scale * kWrist},
                       {bone, scale * kPalmReach, scale * kPalm},
                       {bone, scale * kTipReach, scale * kTip}};
    } else {
      points_[part] = {{bone, 0.0, scale * kLimb}};
    }
    per_frame_ += points_[part].size();
  }
}

void SurfaceParts::add(const HumanPose& pose) {
  for (const auto& points : points_) {
    for (const Point& point : points) {
      positions_.push_back(pose[point.bone] * Vector3d(point.along, 0.0, 0.0));
    }
  }
}

int SurfaceParts::frame_count() const {
  return per_frame_ == 0 ? 0 : static_cast<int>(positions_.size() / per_frame_);
}

SurfaceParts::Nearest SurfaceParts::nearest(const SceneWorld& world, int frame, std::size_t part,
                                            std::size_t body) const {
  Nearest nearest;
  nearest.distance = std::numeric_limits<double>::infinity();
  const std::size_t first = static_cast<std::size_t>(frame) * per_frame_ + first_[part];
  for (std::size_t i = 0; i < points_[part].size(); ++i) {
    const Vector3d& position = positions_[first + i];
    const SurfaceDistance found = world.distance(frame, body, position);
    const double distance = found.distance - points_[part][i].radius;
    if (distance >= nearest.distance) continue;
    nearest = {distance, position - found.distance * found.normal};
  }
  return nearest;
}

std::vector<SurfacePhase> find_surface_contacts(const SceneWorld& world, const SurfaceParts& parts,
                                                const ContactPlan& contacts,
                                                const ContactOptions& options, double frame_time) {
  std::vector<SurfacePhase> phases;
  for (std::size_t part = 0; part < kSupportBones.size(); ++part) {
    if (!parts.has(part)) continue;
    for (std::size_t body = 0; body < world.body_count(); ++body) {
      SurfaceContactFinder(world, parts, part, body, contacts, options, frame_time).find(phases);
    }
  }
  return phases;
}

ContactPlan find_contacts_on_ground(const SceneWorld& world, const SourceFeet& feet,
                                    const ContactOptions& options) {
  const double size = feet.leg_length() / kUsualSourceLeg;
  ContactPlan contacts = find_contacts(feet_over_ground(world, feet, size), options);
  add_ground(world, feet, contacts);
  return contacts;
}

std::vector<double> ground_under_feet(const SceneWorld& world, const SourceFeet& feet) {
  const double size = feet.leg_length() / kUsualSourceLeg;
  std::vector<double> ground;
  for (int frame = 0; frame < feet.frame_count(); ++frame) {
    for (int foot = 0; foot < feet.foot_count; ++foot) {
      for (const int end : {kHeelEnd, kToeEnd}) {
        ground.push_back(ground_under(world, frame, feet.at(frame, foot).end(end), size));
      }
    }
  }
  return ground;
}

void set_contacts(const SceneWorld& world, const SourceFeet& feet, const ContactPlan& contacts,
                  std::span<const SurfacePhase> phases, SolvedScene& solved) {
  for (const SurfacePhase& phase : phases) {
    solved.contacts.push_back({kSupportBones[phase.part], static_cast<int>(phase.body), phase.begin,
                               phase.end, phase.slides});
  }
  for (std::size_t part = 0; part < kSupportBones.size(); ++part) {
    for (const ContactPhase& phase : contacts.bodies[part]) {
      solved.on_floor.push_back({kSupportBones[part], kFloorBody, phase.begin, phase.end});
    }
  }
  solved.under_feet = bodies_under_feet(world, feet, contacts);
}

}  // namespace retarget
