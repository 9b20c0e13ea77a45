#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/pose.h"
#include "stream/decoder.h"

namespace retarget {

/// A joint of a stream whose frames are poses in the world, metres.
struct StreamJoint {
  std::string name;
  int parent = -1;  ///< Smaller than its own index; -1: the first one alone.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< From the parent, in its axes.
};

/// Files are in one of these units; so many of them are a metre.
inline constexpr std::array kUnitsPerMetre = {1.0, 10.0, 100.0, 1000.0, 1.0 / 0.0254};

/// The skeleton of such a stream, and its frames as those of this skeleton. A file of the same
/// skeleton that the user names takes its place: it may have another unit, another order of joints
/// and places that stay.
class StreamSkeleton {
 public:
  /// The skeleton of the user's file.
  void know(std::shared_ptr<const Skeleton> skeleton) { known_ = std::move(skeleton); }
  [[nodiscard]] const Skeleton* known() const { return known_.get(); }

  /// From now on frames are of these joints.
  /// @param up            of the stream's world.
  /// @param is_rest_pose  with all rotations zero the body stands in a T-pose.
  /// @param height        of the body, metres, where the stream tells it.
  void tell(std::vector<StreamJoint> joints, const Eigen::Vector3d& up, bool is_rest_pose,
            StreamSink& sink, std::optional<double> height = std::nullopt);
  [[nodiscard]] const std::vector<StreamJoint>& joints() const { return joints_; }
  void forget() { joints_.clear(); }

  /// @param time              of the sender, s; NaN: none.
  /// @param world_from_joint  in the order of the joints that were told.
  void give(double time, std::span<const Pose> world_from_joint, StreamSink& sink);

 private:
  [[nodiscard]] bool use_known();
  void use_told();

  std::shared_ptr<const Skeleton> known_;
  std::vector<StreamJoint> joints_;

  // of each joint of the frames: the stream's joint that it is, its parent among the frames' joints, and
  // where its translation is; -1: none
  std::vector<std::size_t> sources_;
  std::vector<int> parents_, slots_;
  double units_per_metre_ = 1.0;
  StreamFrame frame_;
};

}  // namespace retarget
