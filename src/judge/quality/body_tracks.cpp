#include "judge/quality/body_tracks.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/math/two_largest.h"
#include "judge/quality/mujoco_contacts.h"
#include "retarget/shape_distance.h"
#include "robot/model/half_way.h"

namespace retarget {
namespace {

// Depth up to which a penetration is a rounding error, metres.
constexpr double kNoDepth = 1e-9;

class BodyTracker {
 public:
  BodyTracker(const RobotClip& clip, std::vector<int> kept_bodies, int stride)
      : clip_(clip),
        stride_(stride),
        collisions_(clip.robot()),
        contacts_(clip.shared_robot()),
        world_from_body_(clip.robot().bodies().size()),
        placed_(collisions_.shapes().size()),
        placed_before_(placed_.size()),
        placed_half_way_(placed_.size()),
        half_way_(clip.frame_count() > 0 ? clip.qpos(0).size() : 0) {
    tracks_.kept_bodies = std::move(kept_bodies);
    for (const Sole& sole : clip.robot().profile().soles) tracks_.soles.push_back({&sole, {}});
    const auto frames = static_cast<std::size_t>(clip.frame_count());
    tracks_.lowest_sole.reserve(frames);
    tracks_.lowest.reserve(frames);
    tracks_.world_from_kept.reserve(frames * tracks_.kept_bodies.size());
    for (SoleTrack& track : tracks_.soles) track.points.reserve(frames * track.sole->points.size());
  }

  BodyTracks track() {
    for (int frame = 0; frame < clip_.frame_count(); ++frame) {
      forward_kinematics(clip_.robot(), clip_.qpos(frame), world_from_body_);
      for (const int body : tracks_.kept_bodies) {
        tracks_.world_from_kept.push_back(world_from_body_[body]);
      }
      std::swap(placed_, placed_before_);
      collisions_.place(world_from_body_, placed_);
      find_lowest(frame);
      if (placed_.empty()) continue;
      find_self_contact(frame);
      if (frame > 0) find_crossing(frame);
    }
    return std::move(tracks_);
  }

 private:
  void find_lowest(int frame) {
    Lowest of_soles{std::numeric_limits<double>::infinity(), 0};
    for (SoleTrack& track : tracks_.soles) {
      for (const Eigen::Vector3d& point : track.sole->points) {
        track.points.push_back(world_from_body_[track.sole->body] * point);
      }
      const double height = track.lowest(frame);
      if (height < of_soles.height) of_soles = {height, track.sole->body};
    }
    Lowest of_all = of_soles;
    for (std::size_t i = 0; i < placed_.size(); ++i) {
      const double height = lowest_point(placed_[i]).z();
      if (height < of_all.height) of_all = {height, collisions_.shapes()[i].body};
    }
    tracks_.lowest_sole.push_back(of_soles);
    tracks_.lowest.push_back(of_all);
  }

  void find_self_contact(int frame) {
    const auto& shapes = collisions_.shapes();
    SelfContact deepest;
    // MuJoCo's depth equals the exact one for pairs of spheres and capsules, but not for boxes.
    // MuJoCo only has geoms, so shapes without a geom use the exact depth.
    double depth_of_round = 0.0;
    boxes_.clear();
    collisions_.near_pairs(placed_, 0.0, near_);
    for (const ShapePair& pair : near_) {
      const double depth = -shape_distance(placed_[pair.a], placed_[pair.b]).distance;
      if (depth <= 0.0) continue;
      if (depth > deepest.depth) deepest = {depth, shapes[pair.a].body, shapes[pair.b].body};
      const bool box = shapes[pair.a].type == CollisionShape::Type::kBox ||
                       shapes[pair.b].type == CollisionShape::Type::kBox;
      const bool both_geoms = shapes[pair.a].geom >= 0 && shapes[pair.b].geom >= 0;
      if (!box || !both_geoms) {
        depth_of_round = std::max(depth_of_round, depth);
      } else if (depth > kNoDepth) {
        boxes_.emplace_back(shapes[pair.a].geom, shapes[pair.b].geom);
      }
    }
    tracks_.self_contact.push_back(deepest);
    if (frame % stride_ != 0) return;
    tracks_.sampled_depth.push_back(
        std::max(depth_of_round, contacts_.depth(clip_.qpos(frame), boxes_)));
  }

  // Finds the deepest penetration half-way from the last frame to this one.
  void find_crossing(int frame) {
    SelfContact& deepest = tracks_.crossings.emplace_back();
    if (!has_fast_shapes()) return;
    half_way_between(clip_.qpos(frame - 1), clip_.qpos(frame), half_way_);
    forward_kinematics(clip_.robot(), half_way_, world_from_body_);
    collisions_.place(world_from_body_, placed_half_way_);
    collisions_.near_pairs(placed_half_way_, 0.0, near_);
    const auto& shapes = collisions_.shapes();
    for (const ShapePair& pair : near_) {
      if ((step_of(pair.a) - step_of(pair.b)).norm() <= kPassing) continue;
      const double depth =
          -shape_distance(placed_half_way_[pair.a], placed_half_way_[pair.b]).distance;
      if (depth > deepest.depth) deepest = {depth, shapes[pair.a].body, shapes[pair.b].body};
    }
  }

  // Movement of a shape's centre since the last frame.
  [[nodiscard]] Eigen::Vector3d step_of(int shape) const {
    return placed_[shape].centre - placed_before_[shape].centre;
  }

  // Whether two shapes may move by more than kPassing relative to each other.
  [[nodiscard]] bool has_fast_shapes() const {
    TwoLargest movements;
    for (int shape = 0; shape < static_cast<int>(placed_.size()); ++shape) {
      movements.add((step_of(shape) - step_of(0)).norm());
    }
    return movements.sum() > kPassing;
  }

  const RobotClip& clip_;
  const int stride_;
  const CollisionModel collisions_;
  MujocoContacts contacts_;
  std::vector<Pose> world_from_body_;
  std::vector<RoundedShape> placed_, placed_before_, placed_half_way_;
  std::vector<double> half_way_;  // Positions half-way between two frames.
  std::vector<ShapePair> near_;
  std::vector<std::pair<int, int>> boxes_;  // Pairs of geoms with a box.
  BodyTracks tracks_;
};

}  // namespace

Eigen::Vector3d SoleTrack::middle(int frame) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : at(frame)) sum += point;
  return sum / static_cast<double>(sole->points.size());
}

double SoleTrack::lowest(int frame) const {
  double height = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& point : at(frame)) height = std::min(height, point.z());
  return height;
}

double SoleTrack::highest(int frame) const {
  double height = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& point : at(frame)) height = std::max(height, point.z());
  return height;
}

bool SoleTrack::stands(int frame, double fps) const {
  constexpr double kStill = 0.25;  // m/s
  if (lowest(frame) >= kSoleHigh) return false;
  const int frames = static_cast<int>(points.size() / sole->points.size());
  const int before = std::max(frame - 1, 0), after = std::min(frame + 1, frames - 1);
  if (before == after) return true;
  return (middle(after) - middle(before)).norm() * fps / (after - before) < kStill;
}

std::vector<SoleTrack> track_soles(const RobotClip& clip) {
  std::vector<SoleTrack> tracks;
  for (const Sole& sole : clip.robot().profile().soles) {
    if (!sole.points.empty()) tracks.push_back({&sole, {}});
  }
  std::vector<Pose> world_from_body(clip.robot().bodies().size());
  for (int frame = 0; frame < clip.frame_count() && !tracks.empty(); ++frame) {
    forward_kinematics(clip.robot(), clip.qpos(frame), world_from_body);
    for (SoleTrack& track : tracks) {
      for (const Eigen::Vector3d& point : track.sole->points) {
        track.points.push_back(world_from_body[track.sole->body] * point);
      }
    }
  }
  return tracks;
}

BodyTracks track_bodies(const RobotClip& clip, std::vector<int> kept_bodies, int stride) {
  return BodyTracker(clip, std::move(kept_bodies), std::max(stride, 1)).track();
}

}  // namespace retarget
