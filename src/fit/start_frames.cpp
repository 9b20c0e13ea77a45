#include "fit/start_frames.h"

#include <algorithm>

#include "fit/foot_plan.h"
#include "fit/frame_terms.h"
#include "fit/shorthand.h"
#include "retarget/pose.h"

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
  const auto add = [&](int index, int link, const Eigen::Vector3d& middle) {
    if (index < 0) return;
    Eigen::Vector2d& anchor = clip_.anchors[at(index)];
    anchor += (pose_.world_from_link[at(link)] * middle).head<2>();
    const PlantedPhase& phase = clip_.feet.phases[at(index)];
    if (frame + 1 == phase.end) anchor /= phase.end - phase.begin;
  };
  const auto ends = clip_.feet.ends_of(frame);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const FitFoot& foot = model_.feet[i / 2];
    add(ends[i].phase, foot.link, foot.ends[i % 2].middle);
  }
  const auto supports = clip_.feet.supports_of(frame);
  for (std::size_t i = 0; i < supports.size(); ++i) {
    if (supports[i].place <= 0.0) continue;
    add(supports[i].phase, model_.supports[i].link, model_.supports[i].middle);
  }
}

}  // namespace retarget
