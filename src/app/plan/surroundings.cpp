#include "app/plan/surroundings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "base/try.h"
#include "motion/resample.h"
#include "motion/time_warp.h"
#include "retarget/resample.h"
#include "retarget/text.h"
#include "scene/change_scene.h"

namespace retarget {

Result<void> load_surroundings(Plan& plan) {
  const SolveOptions& solve = plan.options.solve;
  if (solve.scene.empty()) return {};
  TRY_ASSIGN(Scene scene, load_scene(solve.scene));
  for (const std::string& spec : solve.object_tracks) {
    TRY_ASSIGN(ObjectTrack track, load_object_track(spec));
    plan.object_tracks.push_back(std::move(track));
  }
  if (solve.scene_axes == SceneAxes::kClip) {
    const Calibration& calibration = plan.human.calibration;
    bring_to_world(calibration.human_from_source, calibration.metres_per_unit, scene,
                   plan.object_tracks);
  }
  const std::size_t bodies = scene.bodies.size();
  plan.scene = std::make_shared<const Scene>(std::move(scene));
  plan.config_notes.push_back(
      {"scene", fmt::format("{}, {}, {}", plan.scene->name,
                            bodies == 1 ? "1 body" : fmt::format("{} bodies", bodies),
                            count_text(plan.object_tracks.size(), "track"))});
  if (!plan.robot.robot->fixed_base()) return {};
  plan.config_notes.push_back({"", "ignored: the base of the robot is fixed"});
  plan.scene = nullptr;
  plan.object_tracks.clear();
  return {};
}

namespace {

// Warps the paths of bodies in time, as warp_time does for joints.
SceneClip warp_scene(const SceneClip& clip, const TimeScale& scale) {
  const std::vector<WarpedFrame> frames = warped_frames(scale, clip.rate, clip.frame_count);
  SceneClip warped{clip.scene, clip.rate, static_cast<int>(frames.size()), {}, clip.contacts};
  const std::size_t bodies = clip.scene->bodies.size();
  warped.world_from_body.resize(frames.size() * bodies);
  for (std::size_t body = 0; body < bodies; ++body) {
    std::vector<Eigen::Vector3d> places;
    std::vector<Eigen::Quaterniond> rotations;
    for (int frame = 0; frame < clip.frame_count; ++frame) {
      places.push_back(clip.pose(frame, body).translation);
      rotations.push_back(clip.pose(frame, body).rotation);
    }
    const TrackSampler<Eigen::Vector3d> place(std::move(places), Interpolation::kCubic);
    const TrackSampler<Eigen::Quaterniond> rotation(std::move(rotations), Interpolation::kLinear);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      warped.world_from_body[i * bodies + body] = {
          rotation.sample(frames[i].frame, frames[i].share),
          place.sample(frames[i].frame, frames[i].share)};
    }
  }
  for (StatedContact& contact : warped.contacts) {
    const std::vector<char> touches = std::exchange(contact.touches, {});
    for (const auto& [frame, share] : frames) {
      const std::size_t nearest = static_cast<std::size_t>(frame) + (share < 0.5 ? 0 : 1);
      if (!touches.empty())
        contact.touches.push_back(touches[std::min(nearest, touches.size() - 1)]);
    }
  }
  return warped;
}

}  // namespace

Result<std::shared_ptr<const SceneWorld>> human_surroundings(const Plan& plan,
                                                             const Clip& prepared) {
  if (!plan.scene) return std::shared_ptr<const SceneWorld>();
  const bool stretched = plan.time_scale && !plan.time_scale->pace.empty();
  const int frames = stretched ? static_cast<int>(resampled_frame_count(
                                     plan.part.end - plan.part.begin, plan.clip->rate(), plan.rate))
                               : prepared.frame_count();
  const ClipTimes times{plan.clip->rate(), plan.clip->frame_count(), plan.part.begin,
                        prepared.rate(), frames};
  TRY_ASSIGN(SceneClip clip, place_scene(plan.scene, plan.object_tracks, times));
  if (stretched) clip = warp_scene(clip, *plan.time_scale);
  TRY_ASSIGN(SceneWorld world, make_scene_world(std::move(clip)));
  return std::make_shared<const SceneWorld>(std::move(world));
}

}  // namespace retarget
