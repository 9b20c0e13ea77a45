#include "solve/fit/near_pairs.h"

#include <algorithm>
#include <limits>
#include <set>

#include "base/math/two_largest.h"
#include "retarget/pose.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

// Error by which the distance of nearly parallel shapes can be too large, metres; shape_distance()
// approximates it.
constexpr double kSlack = 0.003;
constexpr double kUnknown = -std::numeric_limits<double>::infinity();

}  // namespace

NearPairs::NearPairs(const FitModel& model)
    : model_(model),
      paths_(model.tree.links().size()),
      far_until_(model.pairs.size()),
      group_far_until_(model.pair_groups.size()),
      near_until_(model.pairs.size()),
      placed_(model.shapes.size()),
      placed_in_(model.shapes.size(), 0) {
  std::set<int> links;
  for (const FitPairGroup& group : model.pair_groups) {
    links.insert(group.link_a);
    links.insert(group.link_b);
  }
  paired_links_.assign(links.begin(), links.end());
}

NearList::Place NearPairs::place_of(const Pose& base_from_world, const TreeState& pose,
                                    int link) const {
  const Pose base_from_link = base_from_world * pose.world_from_link[at(link)];
  return {base_from_link * model_.link_spheres[at(link)].centre, base_from_link.rotation};
}

// Bound on the motion of every point of a link's shapes: the motion of the centre of the bounding
// sphere, plus the chord of the rotation times the radius.
double NearPairs::motion(int link, const NearList::Place& before,
                         const NearList::Place& now) const {
  const double chord = 2.0 * (before.rotation.conjugate() * now.rotation).vec().norm();
  return (now.centre - before.centre).norm() + chord * model_.link_spheres[at(link)].radius;
}

// A distance changes at most by the sum of the largest motions of two links.
bool NearPairs::stays(const TreeState& pose, double stay, const NearList& list) const {
  if (list.places.empty()) return false;
  const Pose base_from_world = pose.world_from_link[0].inverse();
  TwoLargest movements;
  for (std::size_t i = 0; i < paired_links_.size(); ++i) {
    const int link = paired_links_[i];
    movements.add(motion(link, list.places[i], place_of(base_from_world, pose, link)));
    if (movements.sum() > stay) return false;
  }
  return true;
}

void NearPairs::update(const TreeState& pose, double within, double stay, NearList& list) {
  if (stays(pose, stay, list)) return;
  find(pose, within, list.pairs);
  list.places.clear();
  for (const int link : paired_links_) list.places.push_back(paths_[at(link)].place);
}

// Adds the motion since the last pose to the paths. They are relative to the base, because a common
// motion changes no distance.
void NearPairs::follow(const TreeState& pose) {
  const Pose base_from_world = pose.world_from_link[0].inverse();
  for (int link = 0; link < static_cast<int>(paths_.size()); ++link) {
    LinkPath& path = paths_[at(link)];
    const NearList::Place now = place_of(base_from_world, pose, link);
    if (started_) path.length += motion(link, path.place, now);
    path.place = now;
  }
  started_ = true;
}

double NearPairs::path_of(int link_a, int link_b) const {
  return paths_[at(link_a)].length + paths_[at(link_b)].length;
}

const RoundedShape& NearPairs::in_world(const TreeState& pose, int shape) {
  if (placed_in_[at(shape)] != pose_count_) {
    const FitShape& own = model_.shapes[at(shape)];
    placed_[at(shape)] = placed(own, pose.world_from_link[at(own.link)]);
    placed_in_[at(shape)] = pose_count_;
  }
  return placed_[at(shape)];
}

void NearPairs::find(const TreeState& pose, double within, std::vector<std::uint32_t>& pairs) {
  if (within != within_) {
    within_ = within;
    std::ranges::fill(group_far_until_, kUnknown);
    std::ranges::fill(far_until_, kUnknown);
    std::ranges::fill(near_until_, kUnknown);
  }
  ++pose_count_;
  follow(pose);
  pairs.clear();
  for (std::size_t g = 0; g < model_.pair_groups.size(); ++g) {
    const FitPairGroup& group = model_.pair_groups[g];
    const double path = path_of(group.link_a, group.link_b);
    if (path < group_far_until_[g]) continue;
    const double apart =
        (paths_[at(group.link_a)].place.centre - paths_[at(group.link_b)].place.centre).norm() -
        model_.link_spheres[at(group.link_a)].radius - model_.link_spheres[at(group.link_b)].radius;
    if (apart > within) {
      group_far_until_[g] = path + (apart - within);
      continue;
    }
    double first = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = group.begin; i < group.end; ++i) {
      if (path < far_until_[i]) {
        first = std::min(first, far_until_[i]);
        continue;
      }
      if (path < near_until_[i]) {
        pairs.push_back(i);
        first = kUnknown;
        continue;
      }
      const FitPair& pair = model_.pairs[i];
      const RoundedShape &a = in_world(pose, pair.a), &b = in_world(pose, pair.b);
      const double spheres_apart =
          (a.centre - b.centre).norm() - a.bounding_radius - b.bounding_radius;
      if (spheres_apart > within) {
        far_until_[i] = path + (spheres_apart - within);
        near_until_[i] = kUnknown;
        first = std::min(first, far_until_[i]);
        continue;
      }
      const double distance = shape_distance(a, b, NearestPoints::kEven).distance;
      if (distance < within) pairs.push_back(i);
      far_until_[i] = path + (distance - within - kSlack);
      near_until_[i] = path - (distance - within + kSlack);
      first = std::min(first, far_until_[i]);
    }
    group_far_until_[g] = first;
  }
}

}  // namespace retarget
