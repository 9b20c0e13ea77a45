#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "retarget/shape_distance.h"
#include "solve/fit/fit_model.h"

namespace retarget {

/// The near pairs of one pose, and the link poses at that time, used to bound later changes of
/// distances.
struct NearList {
  struct Place {
    Eigen::Vector3d centre;       ///< Centre of the bounding sphere, base frame.
    Eigen::Quaterniond rotation;  ///< Base from link.
  };
  std::vector<std::uint32_t> pairs;
  std::vector<Place> places;  ///< One per link with shapes; empty: nothing is known.

  void forget() {
    pairs.clear();
    places.clear();
  }
};

/// Finds the pairs of a robot's shapes that are near each other, in a sequence of poses.
///
/// It keeps the last distance of each pair and a bound on the motion of its links since then, and
/// measures only pairs that may have become near or far (conservative advancement). The order of
/// the poses affects the time, but not the result. Does not allocate per pose. Keeps a reference to
/// the model.
class NearPairs {
 public:
  explicit NearPairs(const FitModel& model);

  /// @param within  metres.
  /// @param pairs   receives the indices of the pairs that are less than `within` apart, ascending.
  void find(const TreeState& pose, double within, std::vector<std::uint32_t>& pairs);
  /// Updates a list of near pairs that is kept while no distance may have changed by more than
  /// `stay` since the pairs were found.
  void update(const TreeState& pose, double within, double stay, NearList& list);

 private:
  struct LinkPath {
    NearList::Place place;  // In the last pose.
    double length = 0.0;    // Bound on the path of every point of the link's shapes, metres.
  };

  void follow(const TreeState& pose);
  [[nodiscard]] NearList::Place place_of(const Pose& base_from_world, const TreeState& pose,
                                         int link) const;
  [[nodiscard]] double motion(int link, const NearList::Place& before,
                              const NearList::Place& now) const;
  [[nodiscard]] bool stays(const TreeState& pose, double stay, const NearList& list) const;
  [[nodiscard]] double path_of(int link_a, int link_b) const;
  [[nodiscard]] const RoundedShape& in_world(const TreeState& pose, int shape);

  const FitModel& model_;
  std::vector<int> paired_links_;
  std::vector<LinkPath> paths_;  // One per link.
  bool started_ = false;
  double within_ = -1.0;
  // Sum of the two links' path lengths up to which the shapes are not near: by pair, and by group.
  std::vector<double> far_until_, group_far_until_;
  std::vector<double> near_until_;        // One per pair: the sum up to which the shapes are near.
  std::vector<RoundedShape> placed_;      // One per shape.
  std::vector<std::uint64_t> placed_in_;  // One per shape: number of the pose of `placed_`.
  std::uint64_t pose_count_ = 0;
};

}  // namespace retarget
