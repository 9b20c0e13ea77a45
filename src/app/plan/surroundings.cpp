#include "app/plan/surroundings.h"

#include <fmt/format.h>

#include <utility>

#include "base/try.h"
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

Result<std::shared_ptr<const SceneWorld>> human_surroundings(const Plan& plan,
                                                             const Clip& prepared) {
  if (!plan.scene) return std::shared_ptr<const SceneWorld>();
  const ClipTimes times{plan.clip->rate(), plan.clip->frame_count(), plan.part.begin,
                        prepared.rate(), prepared.frame_count()};
  TRY_ASSIGN(SceneClip clip, place_scene(plan.scene, plan.object_tracks, times));
  TRY_ASSIGN(SceneWorld world, make_scene_world(std::move(clip)));
  return std::make_shared<const SceneWorld>(std::move(world));
}

}  // namespace retarget
