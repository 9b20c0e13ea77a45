#include "app/plan/surroundings.h"

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "base/try.h"
#include "motion/resample.h"
#include "retarget/resample.h"
#include "retarget/restore_motion.h"
#include "retarget/text.h"
#include "scene/body_mass.h"
#include "scene/change_scene.h"
#include "scene/read_scene.h"

namespace retarget {

namespace {

bool is_same_file(const std::string& a, const std::string& b) {
  std::error_code missing;
  return std::filesystem::equivalent(a, b, missing) && !missing;
}

}  // namespace

Result<void> load_surroundings(const Clip& clip, Plan& plan) {
  const SolveOptions& solve = plan.options.solve;
  if (solve.scene.empty()) return {};
  const Calibration& calibration = plan.human.calibration;
  const bool in_clip_axes = solve.scene_axes == SceneAxes::kClip;
  TRY_ASSIGN(Scene scene,
             load_scene_in_unit(solve.scene, in_clip_axes ? calibration.metres_per_unit : 1.0));
  for (const std::string& spec : solve.object_tracks) {
    TRY_ASSIGN(ObjectTrack track, load_object_track(spec));
    // The user's rate replaces that of the whole file.
    const bool is_of_clip = is_same_file(object_track_file(spec), clip.name());
    if (plan.options.source.source_fps > 0.0 && is_of_clip) track.rate.reset();
    plan.object_tracks.push_back(std::move(track));
  }
  if (in_clip_axes) {
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
    const SceneBody& of_scene = clip.scene->bodies[body];
    const Eigen::Vector3d centre =
        of_scene.moves ? body_mass(of_scene).com : Eigen::Vector3d(Eigen::Vector3d::Zero());
    std::vector<Eigen::Vector3d> places;
    std::vector<Eigen::Quaterniond> rotations;
    for (int frame = 0; frame < clip.frame_count; ++frame) {
      places.push_back(clip.pose(frame, body) * centre);
      rotations.push_back(clip.pose(frame, body).rotation);
    }
    const TrackSampler<Eigen::Vector3d> place(std::move(places), Interpolation::kCubic);
    const TrackSampler<Eigen::Quaterniond> rotation(std::move(rotations), Interpolation::kLinear);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const Eigen::Quaterniond turned = rotation.sample(frames[i].frame, frames[i].share);
      warped.world_from_body[i * bodies + body] = {
          turned, place.sample(frames[i].frame, frames[i].share) - turned * centre};
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

Result<std::shared_ptr<const SceneWorld>> restore_human_scene(const Plan& plan,
                                                              const Clip& prepared) {
  return human_surroundings(plan, prepared);
}

}  // namespace retarget
