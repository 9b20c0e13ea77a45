#include "solve/fit/start_frames.h"

#include <algorithm>

#include "retarget/pose.h"
#include "solve/fit/fit_scene.h"
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
    now[2] -= std::min(lowest_below_floor(model_, pose_), lowest_below_ground(frame));
  }
  add_to_anchors(frame);
}

// Height of the lowest point above the surfaces of a scene that carry the robot, metres; 0 if no
// point is below one. The robot's feet stand on the ground of the human's, because a robot with
// longer feet would rise to a step that its toes only touch. Other parts count only in contact: a
// shank in a step must leave it sideways.
double StartFrames::lowest_below_ground(int frame) const {
  double lowest = 0.0;
  if (!clip_.scene) return lowest;
  const auto goals = clip_.feet.ends_of(frame);
  for (std::size_t foot = 0; foot < model_.feet.size(); ++foot) {
    const FitFoot& of_model = model_.feet[foot];
    for (const std::size_t end : {kHeelEnd, kToeEnd}) {
      for (const auto& point : of_model.ends[end].points) {
        const double height = (pose_.world_from_link[at(of_model.link)] * point).z();
        lowest = std::min(lowest, height - goals[2 * foot + end].support);
      }
    }
  }
  for (const SceneGoal& goal : clip_.scene->goals_of(frame)) {
    if (!clip_.scene->may_carry(goal)) continue;
    const SupportBody::SceneTouch touch =
        model_.supports[at(goal.support)].nearest(pose_, clip_.scene->world, frame, at(goal.body));
    if (!(touch.normal.z() > kLevelSurface)) continue;
    lowest = std::min(lowest, touch.distance / touch.normal.z());
  }
  return lowest;
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
