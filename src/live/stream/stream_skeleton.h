#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "live/stream/decoder.h"
#include "retarget/clip.h"
#include "retarget/pose.h"

namespace retarget {

/// A joint of a stream whose frames are world poses, metres.
struct StreamJoint {
  std::string name;
  int parent = -1;  ///< Precedes the joint; -1: the first joint only.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< From the parent, in its axes.
};

/// Possible units of files, in units per metre.
inline constexpr std::array kUnitsPerMetre = {1.0, 10.0, 100.0, 1000.0, 1.0 / 0.0254};

/// The skeleton of such a stream; converts its frames to frames of this skeleton. A file of the
/// same skeleton named by the user takes precedence. It may have another unit, another order of
/// joints, and fixed offsets.
class StreamSkeleton {
 public:
  /// Sets the skeleton of the user's file.
  void know(std::shared_ptr<const Skeleton> skeleton) { known_ = std::move(skeleton); }
  [[nodiscard]] const Skeleton* known() const { return known_.get(); }

  /// Sets the joints of the following frames.
  /// @param up            of the stream's world.
  /// @param is_rest_pose  whether the body is in a T-pose with all rotations zero.
  /// @param height        of the body, metres, if the stream contains it.
  void tell(std::vector<StreamJoint> joints, const Eigen::Vector3d& up, bool is_rest_pose,
            StreamSink& sink, std::optional<double> height = std::nullopt);
  [[nodiscard]] const std::vector<StreamJoint>& joints() const { return joints_; }
  void forget() { joints_.clear(); }

  /// @param time              sender's time, s; NaN: none.
  /// @param world_from_joint  in the order of the joints passed to tell().
  void give(double time, std::span<const Pose> world_from_joint, StreamSink& sink);

 private:
  [[nodiscard]] bool use_known();
  void use_told();

  std::shared_ptr<const Skeleton> known_;
  std::vector<StreamJoint> joints_;

  // For each joint of the output frames: its index among the stream's joints, its parent among the
  // output joints, and its translation slot; -1: none.
  std::vector<std::size_t> sources_;
  std::vector<int> parents_, slots_;
  double units_per_metre_ = 1.0;
  StreamFrame frame_;
};

}  // namespace retarget
