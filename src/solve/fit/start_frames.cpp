#include "solve/fit/start_frames.h"

#include <algorithm>

#include "retarget/pose.h"
#include "solve/fit/foot_plan.h"
#include "solve/fit/frame_terms.h"
#include "solve/fit/shorthand.h"

namespace retarget {

double lowest_below_floor(const FitModel& model, const TreeState& pose) {
  double lowest = 0.0;
  for (std::size_t link = 0; link < model.tree.links().size(); ++link) {
    const Pose& world = pose.world_from_link[link];
    const Eigen::Matrix3d rotation = world.rotation.toRotationMatrix();
    for (const FloorPoint& point : model.floor_points[link]) {
      const double height = world.translation.z() + rotation.row(2).dot(point.position);
      lowest = std::min(lowest, height - point.radius);
    }
  }
  for (const FitFoot& foot : model.feet) {
    for (const FitFoot::End& end : foot.ends) {
      for (const auto& point : end.points) {
        lowest = std::min(lowest, (pose.world_from_link[at(foot.link)] * point).z());
      }
    }
  }
  return lowest;
}

StartFrames::StartFrames(const FitModel& model, std::span<const Eigen::Vector3d> path, bool lift,
                         FitClip& clip)
    : model_(model), path_(path), lift_(lift), clip_(clip), pose_(model.tree) {
  clip.qpos.resize(at(clip.frame_count) * at(model.configuration_size));
  clip.anchors.assign(clip.feet.phases.size(), Eigen::Vector2d::Zero());
}

void StartFrames::take(int frame, std::span<const double> qpos) {
  const auto now = clip_.frame(frame, model_.configuration_size);
  std::ranges::copy(qpos, now.begin());
  for (std::size_t k = 0; k < 3; ++k) now[k] += path_[at(frame)][static_cast<int>(k)];
  if (lift_) {
    pose_.update(now);
    now[2] -= lowest_below_floor(model_, pose_);
  }
  add_to_anchors(frame);
}

void StartFrames::add_to_anchors(int frame) {
  if (!clip_.feet.plants(frame)) return;
  pose_.update(clip_.frame(frame, model_.configuration_size));
  clip_.feet.for_each_planted(frame, [&](int index, const Eigen::Vector2d& slide) {
    const PlantedPhase& phase = clip_.feet.phases[at(index)];
    Eigen::Vector2d& anchor = clip_.anchors[at(index)];
    anchor += planted_place(model_, phase, pose_) - slide;
    if (frame + 1 == phase.last()) anchor /= phase.last() - phase.first();
  });
}

}  // namespace retarget
