#include "solve/fit/window_contacts.h"

#include "solve/dynamics/centroidal_step.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// Distance from a lifted body within which links carry it, for a G1; metres.
constexpr double kCarryReach = 0.04;

}  // namespace

WindowContacts::WindowContacts(const FitModel& model, const FitOptions& options,
                               const FitWindow& window, const FitClip& clip)
    : model_(model), window_(window), frames_(at(window.end - window.begin)) {
  shrink_soles(options.sole_shrink);
  if (!clip.scene) return;
  scene_.emplace(clip.scene->world, window.begin, window.end);
  list_points();
}

// Moves the contact points of each sole towards its middle.
void WindowContacts::shrink_soles(double share) {
  for (const FitFoot& foot : model_.feet) {
    const Vector3d middle = 0.5 * (foot.ends[0].middle + foot.ends[1].middle);
    auto& places = sole_contacts_.emplace_back();
    for (std::size_t e = 0; e < foot.ends.size(); ++e) {
      for (const Vector3d& corner : foot.ends[e].points) {
        places[e].push_back(corner + share * (middle - corner));
      }
    }
  }
}

void WindowContacts::list_points() {
  for (const FitFoot& foot : model_.feet) {
    for (const FitFoot::End& end : foot.ends) {
      for (const Vector3d& corner : end.points) points_.push_back({foot.link, corner, 0.0, true});
    }
  }
  for (std::size_t link = 0; link < model_.floor_points.size(); ++link) {
    if (model_.is_foot[link] != 0) continue;
    for (const FloorPoint& point : model_.floor_points[link]) {
      points_.push_back({static_cast<int>(link), point.position, point.radius, false});
    }
  }
}

std::span<const LinkLoad> WindowContacts::loads(int t, const TreeState& pose) {
  if (scene_) {
    scene_->find_loads(window_.begin + t, points_, pose, kCarryReach * model_.leg / kUsualLeg,
                       loads_);
  }
  return loads_;
}

void WindowContacts::find(int t, const FitClip& clip, const Robot& robot) {
  constexpr Near kSole{0.012, 0.35}, kBody{0.02, 0.35}, kLoose{0.04, 1.5};
  constexpr double kHeld = 0.35;
  std::vector<Contact>& contacts = frames_[at(t)].contacts;
  contacts.clear();
  add_feet(t, clip, robot, kSole, contacts);
  add_links(robot, kBody, contacts);
  add_touched_bodies(t, robot, kBody, contacts);
  // A body that is not falling must have a support, so this search accepts faster and higher
  // points.
  if (contacts.empty() && robot.supported > kHeld) {
    add_feet(t, clip, robot, kLoose, contacts);
    add_touched_bodies(t, robot, kLoose, contacts);
  }
  keep_outermost_contacts(t, robot, contacts);
}

void WindowContacts::place(int t, const TreeState& pose) {
  Frame& frame = frames_[at(t)];
  frame.places.clear();
  for (const Contact& contact : frame.contacts) {
    frame.places.push_back({place_of(t, contact, pose), contact.foot});
  }
}

void WindowContacts::lend(int reach) {
  const int count = static_cast<int>(frames_.size());
  std::vector<char> empty;
  for (const Frame& frame : frames_) empty.push_back(frame.contacts.empty() ? 1 : 0);
  for (int t = 0; t < count; ++t) {
    for (int away = 1; away <= reach && frames_[at(t)].contacts.empty(); ++away) {
      for (const int neighbour : {t - away, t + away}) {
        if (neighbour < 0 || neighbour >= count || empty[at(neighbour)] != 0) continue;
        if (frames_[at(t)].contacts.empty()) frames_[at(t)] = frames_[at(neighbour)];
      }
    }
  }
}

ContactPlace WindowContacts::place_of(int t, const Contact& contact, const TreeState& pose) const {
  if (!contact.body) return {lowest_of(contact.point, pose)};
  const SupportPoint& point = contact.point;
  return scene_->place(window_.begin + t, pose.world_from_link[at(point.link)] * point.in_link,
                       point.radius, *contact.body);
}

bool WindowContacts::touches(const SupportPoint& point, const Robot& robot, Near near) {
  const Vector3d place = lowest_of(point, robot.pose);
  return place.z() < near.height &&
         robot.inverse.velocity_of(point.link, place, robot.pose).norm() < near.speed;
}

void WindowContacts::add_feet(int t, const FitClip& clip, const Robot& robot, Near near,
                              std::vector<Contact>& contacts) const {
  const auto goals = clip.feet.ends_of(window_.begin + t);
  for (std::size_t f = 0; f < model_.feet.size(); ++f) {
    const FitFoot& foot = model_.feet[f];
    for (std::size_t e = 0; e < foot.ends.size(); ++e) {
      // An end that rises may have left the floor.
      const FootEndGoal& goal = goals[2 * f + e];
      const bool planned = goal.phase >= 0 && goal.lift == 0.0;
      for (std::size_t i = 0; i < foot.ends[e].points.size(); ++i) {
        const SupportPoint point{foot.link, foot.ends[e].points[i], 0.0, true};
        if (!planned && !touches(point, robot, near)) continue;
        contacts.push_back({point, {}, static_cast<int>(f)});
        contacts.back().point.in_link = sole_contacts_[f][e][i];
      }
    }
  }
}

// Adds the points of links other than feet that touch the floor.
void WindowContacts::add_links(const Robot& robot, Near near,
                               std::vector<Contact>& contacts) const {
  for (std::size_t link = 0; link < model_.floor_points.size(); ++link) {
    if (model_.is_foot[link] != 0) continue;
    const double height = robot.pose.world_from_link[link].translation.z();
    if (height - model_.floor_reach[link] > near.height) continue;
    for (const FloorPoint& floor : model_.floor_points[link]) {
      const SupportPoint point{static_cast<int>(link), floor.position, floor.radius, false};
      if (touches(point, robot, near)) contacts.push_back({point, {}, -1});
    }
  }
}

// Adds the points that touch bodies of the scene. Points of planned foot ends are already contacts,
// with the floor's normal.
void WindowContacts::add_touched_bodies(int t, const Robot& robot, Near near,
                                        std::vector<Contact>& contacts) const {
  if (!scene_) return;
  for (const SupportPoint& point : points_) {
    const Vector3d centre = robot.pose.world_from_link[at(point.link)] * point.in_link;
    const auto body = scene_->touched(window_.begin + t, centre, point.radius,
                                      robot.inverse.velocity_of(point.link, centre, robot.pose),
                                      near.height, near.speed);
    if (body) contacts.push_back({point, body, -1});
  }
}

void WindowContacts::keep_outermost_contacts(int t, const Robot& robot,
                                             std::vector<Contact>& contacts) {
  outermost_.clear();
  chosen_.clear();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    outermost_.push_back(place_of(t, contacts[i], robot.pose).position);
    chosen_.push_back(static_cast<int>(i));
  }
  keep_outermost(outermost_, ForceCone::kMaxPoints, chosen_, robot.heading);
  for (std::size_t i = 0; i < chosen_.size(); ++i) contacts[i] = contacts[at(chosen_[i])];
  contacts.resize(chosen_.size());
}

}  // namespace retarget
