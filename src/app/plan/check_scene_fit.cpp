#include "app/plan/check_scene_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "base/try.h"
#include "human/skeleton/human_clip.h"
#include "retarget/text.h"
#include "scene/change_scene.h"
#include "scene/scene_world.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kNear = 0.25;  // Distance of a joint from a body that it touches, metres.
constexpr double kDeep = 0.1;   // Depth of a joint inside a body that it cannot have, metres.
constexpr double kOftenInside = 0.05;  // Share of the frames.
constexpr double kInterval = 0.1;      // Seconds between the frames that are looked at.

// Consistency of a scene with the human in it.
struct SceneFit {
  double nearest = std::numeric_limits<double>::infinity();  ///< Metres, over bodies and frames.
  double inside = 0.0;                                       ///< Share of the frames.
  double deepest = 0.0;                                      ///< Metres.
  std::string body;                                          ///< Of `deepest`.

  [[nodiscard]] bool is_good() const { return nearest <= kNear && inside <= kOftenInside; }
};

Result<SceneFit> measure_fit(const Clip& clip, const Plan& plan,
                             const std::shared_ptr<const Scene>& scene,
                             const std::vector<ObjectTrack>& tracks) {
  const int count = clip.frame_count() - plan.part.begin;
  TRY_ASSIGN(SceneClip placed,
             place_scene(scene, tracks,
                         {clip.rate(), clip.frame_count(), plan.part.begin, clip.rate(), count}));
  TRY_ASSIGN(const SceneWorld world, make_scene_world(std::move(placed)));
  HumanPoser poser(clip, plan.human.calibration);
  HumanPose pose;
  SceneFit fit;
  const int step = std::max(1, static_cast<int>(kInterval / clip.rate().frame_time()));
  int frames = 0, inside = 0;
  for (int frame = plan.part.begin; frame < plan.part.end; frame += step) {
    poser.pose(frame, pose);
    double deepest = 0.0;
    for (const Bone bone : kMappedBones) {
      if (!poser.info().has(bone)) continue;
      for (std::size_t body = 0; body < world.body_count(); ++body) {
        const double distance =
            world.distance(frame - plan.part.begin, body, pose[bone].translation).distance;
        fit.nearest = std::min(fit.nearest, distance);
        deepest = std::max(deepest, -distance);
        if (-distance > std::max(fit.deepest, kDeep))
          fit.body = world.clip.scene->bodies[body].name;
        fit.deepest = std::max(fit.deepest, -distance);
      }
    }
    ++frames;
    inside += deepest > kDeep ? 1 : 0;
  }
  if (frames > 0) fit.inside = static_cast<double>(inside) / frames;
  return fit;
}

// Whether the scene suits the human if its file has the unit and axes of the clip.
Result<bool> fits_in_clip_axes(const Clip& clip, const Plan& plan) {
  const Calibration& calibration = plan.human.calibration;
  Scene scene = *plan.scene;
  std::vector<ObjectTrack> tracks = plan.object_tracks;
  bring_to_world(calibration.human_from_source, calibration.metres_per_unit, scene, tracks);
  const auto fit = measure_fit(clip, plan, std::make_shared<const Scene>(std::move(scene)), tracks);
  return fit && fit->is_good();
}

std::string doubt_about(const SceneFit& fit, const std::string& scene) {
  if (fit.inside > kOftenInside) {
    return fmt::format(
        "the human is inside \"{}\" of the scene {} in {} % of the frames, at most {} m "
        "deep",
        fit.body, scene, number_text(100.0 * fit.inside, 2), number_text(fit.deepest, 2));
  }
  return fmt::format("the human touches nothing in the scene {}: the nearest body is {} m away",
                     scene, number_text(fit.nearest, 2));
}

}  // namespace

Result<void> check_scene_fit(const Clip& clip, Plan& plan) {
  if (!plan.scene || !plan.options.solve.terrain.empty()) return {};
  TRY_ASSIGN(const SceneFit fit, measure_fit(clip, plan, plan.scene, plan.object_tracks));
  if (fit.is_good()) return {};
  std::string doubt = doubt_about(fit, plan.scene->name);
  if (plan.options.solve.scene_axes == SceneAxes::kHuman) {
    TRY_ASSIGN(const bool of_clip, fits_in_clip_axes(clip, plan));
    doubt += of_clip ? "; it fits with " OPTION("scene-axes") " clip"
                     : "; check its unit (metres), axes (z up) and origin";
  }
  plan.scene_doubts.push_back({0, 0, std::move(doubt)});
  return {};
}

}  // namespace retarget
