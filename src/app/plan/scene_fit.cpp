#include "app/plan/scene_fit.h"

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "base/try.h"
#include "retarget/human.h"
#include "retarget/human_poser.h"
#include "retarget/text.h"
#include "scene/change_scene.h"
#include "scene/read_scene.h"
#include "scene/scene_shapes.h"
#include "scene/scene_world.h"

namespace retarget {

namespace {

using Eigen::Vector3d;

constexpr double kNear = 0.25;  // Distance of a joint from a body that it touches, metres.
constexpr double kDeep = 0.1;   // Depth of a joint inside a body that it cannot have, metres.
constexpr double kOftenInside = 0.05;  // Share of the frames.
constexpr double kOnTop = 0.15;        // Distance of an ankle from a body below it, metres.
constexpr double kUpward = 0.7;        // Smallest z of the normal of a surface to stand on.
constexpr double kInterval = 0.1;      // Seconds between the checked frames.

constexpr double kMoving = 0.05;  // Speed of a body that moves, m/s.
constexpr double kRides = 0.2;    // Smallest share of the frames with a foot on a moving body.

// Consistency of a scene with the human in it.
struct SceneFit {
  double nearest = std::numeric_limits<double>::infinity();  ///< Metres, over bodies and frames.
  double inside = 0.0;   ///< Share of the frames with a joint inside.
  double deepest = 0.0;  ///< Metres.
  std::string body;      ///< Body with the depth `deepest`.
  double stood = 0.0;    ///< Share of the frames with a foot on a fixed body.
  double carried = 0.0;  ///< Share of the frames with a foot on a body that is moving.
  std::string carrier;   ///< Last such body.

  [[nodiscard]] bool is_good() const { return nearest <= kNear && inside <= kOftenInside; }
  [[nodiscard]] bool carries() const { return carried > kRides; }
};

bool is_moving(const SceneWorld& world, int frame, std::size_t body) {
  const int last = world.clip.frame_count - 1;
  const auto reach = static_cast<int>(kInterval / world.clip.rate.frame_time());
  const int from = std::max(0, frame - reach), to = std::min(last, frame + reach);
  if (from >= to) return false;
  const Vector3d step =
      world.clip.pose(to, body).translation - world.clip.pose(from, body).translation;
  return step.norm() > kMoving * world.clip.rate.frame_time() * (to - from);
}

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
  int frames = 0, inside = 0, stood = 0, carried = 0;
  for (int frame = plan.part.begin; frame < plan.part.end; frame += step) {
    poser.pose(frame, pose);
    double deepest = 0.0;
    bool stands = false, rides = false;
    for (const Bone bone : kMappedBones) {
      if (!poser.info().has(bone)) continue;
      for (std::size_t body = 0; body < world.body_count(); ++body) {
        const SurfaceDistance found =
            world.distance(frame - plan.part.begin, body, pose[bone].translation);
        const double distance = found.distance;
        const bool on_top = limb_bone(bone) == LimbBone::kFoot && std::abs(distance) < kOnTop &&
                            found.normal.z() > kUpward;
        stands = stands || (on_top && world.is_fixed(body));
        if (on_top && !world.is_fixed(body) && is_moving(world, frame - plan.part.begin, body)) {
          rides = true;
          fit.carrier = world.clip.scene->bodies[body].name;
        }
        fit.nearest = std::min(fit.nearest, distance);
        deepest = std::max(deepest, -distance);
        if (-distance > std::max(fit.deepest, kDeep))
          fit.body = world.clip.scene->bodies[body].name;
        fit.deepest = std::max(fit.deepest, -distance);
      }
    }
    ++frames;
    inside += deepest > kDeep ? 1 : 0;
    stood += stands ? 1 : 0;
    carried += rides ? 1 : 0;
  }
  if (frames > 0) {
    fit.inside = static_cast<double>(inside) / frames;
    fit.stood = static_cast<double>(stood) / frames;
    fit.carried = static_cast<double>(carried) / frames;
  }
  return fit;
}

// Largest extent along the axes of the body's frame, metres.
double size_of(const SceneBody& body) {
  Eigen::AlignedBox3d box;
  for (const SceneShape& shape : body.shapes) {
    for (const auto& vertex : mesh_of_shape(shape).vertices) box.extend(vertex);
  }
  return box.isEmpty() ? 0.0 : box.sizes().maxCoeff();
}

// Whether a smaller unit turned a body into a speck, which the human does not notice.
bool has_speck(const Scene& scene, double unit) {
  constexpr double kSpeck = 0.1;  // Metres.
  return std::ranges::any_of(scene.bodies, [&](const SceneBody& body) {
    const double size = size_of(body);
    return size < kSpeck && size >= kSpeck * unit;
  });
}

// How the scene suits the human if its file has the unit and axes of the clip; empty: not at all.
std::optional<SceneFit> fit_in_clip_axes(const Clip& clip, const Plan& plan) {
  const Calibration& calibration = plan.human.calibration;
  Scene scene = *plan.scene;
  std::vector<ObjectTrack> tracks = plan.object_tracks;
  bring_to_world(calibration.human_from_source, calibration.metres_per_unit, scene, tracks);
  if (has_speck(scene, calibration.metres_per_unit)) return {};
  const auto fit = measure_fit(clip, plan, std::make_shared<const Scene>(std::move(scene)), tracks);
  if (!fit || !fit->is_good()) return {};
  return *fit;
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

Result<bool> stands_on_moving_body(const Clip& clip, const Plan& plan) {
  if (!plan.scene || plan.object_tracks.empty()) return false;
  TRY_ASSIGN(const SceneFit fit, measure_fit(clip, plan, plan.scene, plan.object_tracks));
  return fit.carries();
}

Result<void> check_scene_fit(const Clip& clip, Plan& plan) {
  if (!plan.scene || !plan.options.solve.terrain.empty()) return {};
  TRY_ASSIGN(const SceneFit fit, measure_fit(clip, plan, plan.scene, plan.object_tracks));
  if (fit.carries()) {
    plan.clip_doubts.push_back(
        {0, 0,
         fmt::format(
             "feet stand on \"{}\" while its track moves it: retarget holds feet only on the "
             "floor and on bodies at rest, so they may slide on it and sink into it",
             fit.carrier)});
  }
  constexpr double kNever = 0.02, kOften = 0.2;  // Shares of the frames.
  const bool has_ground = !std::ranges::all_of(plan.scene->bodies, &SceneBody::moves);
  if (fit.is_good() && (fit.stood > kNever || !has_ground)) return {};
  const bool in_axes_of_human = plan.options.solve.scene_axes == SceneAxes::kHuman;
  const auto in_clip_axes =
      in_axes_of_human ? fit_in_clip_axes(clip, plan) : std::optional<SceneFit>();
  if (fit.is_good() && !(in_clip_axes && in_clip_axes->stood > kOften)) return {};
  std::string doubt =
      fit.is_good() ? fmt::format("the human stands on no body of the scene {}", plan.scene->name)
                    : doubt_about(fit, plan.scene->name);
  if (in_axes_of_human) {
    doubt += in_clip_axes ? "; it fits with " OPTION("scene-axes") " clip"
                          : "; check its unit (metres), axes (z up) and origin";
  }
  plan.clip_doubts.push_back({0, 0, std::move(doubt)});
  return {};
}

}  // namespace retarget
