#include "app/plan/surroundings.h"

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "app/options/scene_options.h"
#include "app/plan/set_up_robot.h"
#include "base/option_name.h"
#include "base/try.h"
#include "human/gait/move_contacts.h"
#include "human/gait/surface_contacts.h"
#include "motion/resample.h"
#include "retarget/human.h"
#include "retarget/human_poser.h"
#include "retarget/resample.h"
#include "retarget/restore_motion.h"
#include "retarget/text.h"
#include "scene/body_mass.h"
#include "scene/change_scene.h"
#include "scene/read_scene.h"
#include "scene/scene_shapes.h"
#include "solve/fit/foot_plan.h"

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

namespace {

// The human in the frames from the end of the lead-in.
struct Walker {
  explicit Walker(const HumanClipInfo& info) : feet(info) {}

  SourceFeet feet;
  std::vector<HumanPose> poses;
  std::vector<Eigen::Vector2d> hips;
};

Walker read_walker(const Clip& clip, const Plan& plan) {
  HumanPoser poser(clip, plan.human.calibration);
  Walker walker(poser.info());
  HumanPose pose;
  for (int frame = plan.lead_in_frames; frame < clip.frame_count(); ++frame) {
    poser.pose(frame, pose);
    walker.feet.add(pose);
    walker.poses.push_back(pose);
    walker.hips.emplace_back(pose[Bone::kHips].translation.head<2>());
  }
  return walker;
}

std::string terrain_text(const Terrain& terrain, const TerrainShape& shape) {
  if (terrain.is_slope()) return "slope under the walk";
  return fmt::format("stairs under the walk: {} of {} m x {} m", count_text(terrain.count, "step"),
                     number_text(shape.rise, 3), number_text(shape.tread, 3));
}

Result<void> add_terrain(const TerrainShape& shape, Clip& clip, Plan& plan) {
  // Ends of the ground: beyond the farthest position of the hips, metres.
  constexpr double kBeyond = 1.5, kAside = 1.5;
  TRY_ASSIGN(const double scale, foot_path_scale(clip, plan));
  const Walker walker = read_walker(clip, plan);
  Terrain terrain;
  terrain.rise = shape.rise / scale;
  terrain.tread = shape.tread / scale;
  terrain.count = shape.count;
  terrain.slope = shape.slope;
  if (walker.feet.foot_count == 0) return input_failure(clip.name(), "the human has no feet");
  const ContactPlan contacts = find_contacts(walker.feet, contact_options(plan.fit));
  const ContactMoves moves = put_on_terrain(walker.hips, walker.feet, contacts, terrain);
  if (moves.empty()) {
    return input_failure(clip.name(), "the human does not walk far enough for " OPTION("terrain"),
                         "choose a clip with a walk of some steps");
  }
  double length = 0.0, aside = 0.0;
  for (const Eigen::Vector2d& place : walker.hips) {
    length = std::max(length, terrain.distance(place));
    const Eigen::Vector2d across(-terrain.along.y(), terrain.along.x());
    aside = std::max(aside, std::abs(across.dot(place - terrain.edge)));
  }
  length = std::max(length, terrain.count * terrain.tread) + kBeyond;
  plan.scene =
      std::make_shared<const Scene>(terrain_scene(terrain, length, 2.0 * (aside + kAside)));
  move_contacts(clip, plan.lead_in_frames, plan.human.calibration, moves);
  plan.config_notes.push_back({"terrain", terrain_text(terrain, shape)});
  return {};
}

Result<SceneClip> placed_scene(const Clip& clip, const Plan& plan) {
  const int count = clip.frame_count() - plan.lead_in_frames;
  return place_scene(plan.scene, plan.object_tracks,
                     {clip.rate(), clip.frame_count(), plan.lead_in_frames, clip.rate(), count});
}

struct SceneChange {
  Vector3d static_scale = Vector3d::Ones(), shift = Vector3d::Zero();
  double object_scale = 1.0;

  [[nodiscard]] bool of_static() const { return static_scale != Vector3d::Ones(); }
  [[nodiscard]] bool of_objects() const { return !shift.isZero(0.0) || object_scale != 1.0; }
};

Result<void> check_change(const SceneChange& change, const Scene& scene) {
  const bool moves = std::ranges::any_of(scene.bodies, &SceneBody::moves);
  if (change.of_objects() && !moves) {
    return usage_failure("no body of the scene moves, so " OPTION("object-shift") " and " OPTION(
                             "object-scale") " change nothing",
                         "add " OPTION("object-track") " [BODY=]FILE");
  }
  if (change.of_static() && moves) {
    return usage_failure(OPTION("terrain-scale") " requires a scene without moving bodies",
                         "the track of a carried object does not match a scaled scene");
  }
  return {};
}

Result<void> change_scene(const SceneChange& change, Clip& clip, Plan& plan) {
  TRY_ASSIGN(SceneClip placed, placed_scene(clip, plan));
  TRY_ASSIGN(const SceneWorld world, make_scene_world(std::move(placed)));
  TRY(check_change(change, *world.clip.scene));
  const Walker walker = read_walker(clip, plan);
  const ContactOptions options = contact_options(plan.fit);
  const ContactPlan contacts = find_contacts_on_ground(world, walker.feet, options);
  SurfaceParts parts(HumanPoser(clip, plan.human.calibration).info(), contacts.scale);
  for (const HumanPose& pose : walker.poses) parts.add(pose);
  const auto phases = find_surface_contacts(world, parts, options, clip.rate().frame_time());

  Scene scene = *world.clip.scene;
  for (ObjectTrack& track : plan.object_tracks) {
    if (!track.body.empty()) continue;
    track.body = std::ranges::find_if(scene.bodies, &SceneBody::moves)->name;
  }
  for (SceneBody& body : scene.bodies) {
    if (change.of_static()) scale_static_body(change.static_scale, body);
  }
  change_objects(change.shift, change.object_scale, world.fields, scene, plan.object_tracks);
  plan.scene = std::make_shared<const Scene>(std::move(scene));
  TRY_ASSIGN(const SceneClip after, placed_scene(clip, plan));
  move_contacts(clip, plan.lead_in_frames, plan.human.calibration,
                moves_with_scene(world, after, change.static_scale, change.object_scale,
                                 walker.feet, contacts, phases));
  return {};
}

void note_change(const SceneChange& change, const SolveOptions& solve, Plan& plan) {
  std::vector<std::string> texts;
  if (change.of_static()) texts.push_back("static bodies scaled by " + solve.terrain_scale);
  if (!change.shift.isZero(0.0)) texts.push_back("objects moved by " + solve.object_shift + " m");
  if (change.object_scale != 1.0) {
    texts.push_back("objects scaled by " + number_text(change.object_scale, 3));
  }
  plan.config_notes.push_back({"", list_names(texts) + "; the human's contacts follow"});
}

}  // namespace

Result<void> vary_scene(Clip& clip, Plan& plan) {
  const SolveOptions& solve = plan.options.solve;
  TRY_ASSIGN(const auto terrain, terrain_from_text(solve.terrain));
  if (terrain && plan.robot.robot->fixed_base()) {
    plan.config_notes.push_back({"terrain", "ignored: the base of the robot is fixed"});
    return {};
  }
  if (terrain) return add_terrain(*terrain, clip, plan);
  if (!plan.scene) return {};
  SceneChange change;
  TRY_ASSIGN(change.static_scale, terrain_scale_from_text(solve.terrain_scale));
  TRY_ASSIGN(change.shift, object_shift_from_text(solve.object_shift));
  change.object_scale = solve.object_scale;
  if (!change.of_static() && !change.of_objects()) return {};
  TRY(change_scene(change, clip, plan));
  note_change(change, solve, plan);
  return {};
}

Result<std::shared_ptr<const SceneWorld>> restore_human_scene(const Plan& plan,
                                                              const Clip& prepared) {
  return human_surroundings(plan, prepared);
}

}  // namespace retarget
