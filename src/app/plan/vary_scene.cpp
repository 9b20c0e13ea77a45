#include "app/plan/vary_scene.h"

#include <fmt/format.h>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/options/scene_options.h"
#include "app/plan/set_up_robot.h"
#include "base/option_name.h"
#include "base/try.h"
#include "human/gait/move_contacts.h"
#include "human/gait/surface_contacts.h"
#include "retarget/human_poser.h"
#include "retarget/text.h"
#include "scene/change_scene.h"
#include "scene/read_scene.h"
#include "solve/fit/foot_plan.h"

namespace retarget {

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
  Eigen::Vector3d static_scale = Eigen::Vector3d::Ones(), shift = Eigen::Vector3d::Zero();
  double object_scale = 1.0;

  [[nodiscard]] bool of_static() const { return static_scale != Eigen::Vector3d::Ones(); }
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
  const auto phases =
      find_surface_contacts(world, parts, contacts, options, clip.rate().frame_time());

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

}  // namespace retarget
