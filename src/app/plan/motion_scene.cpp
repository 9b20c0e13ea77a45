#include "retarget/motion_scene.h"

#include <vector>

#include "app/plan/contact_labels.h"
#include "app/plan/motion_target.h"
#include "base/try.h"
#include "human/gait/source_feet.h"
#include "human/gait/surface_contacts.h"
#include "human/skeleton/human_clip.h"
#include "retarget/retargeting_config.h"
#include "scene/scene_world.h"
#include "solve/fit/fit_setup.h"
#include "solve/targets/targets.h"

namespace retarget {
namespace {

// The configuration without the tasks of bones that the human lacks.
Result<ResolvedConfig> config_for_bones(const MeasuredSource& source, const HumanClip& human) {
  std::vector<Bone> missing;
  for (const Bone bone : kAllBones) {
    if (!human.has(bone)) missing.push_back(bone);
  }
  ResolvedConfig config = source.config;
  TRY(leave_out_bones(config, missing));
  return config;
}

// The contacts that a fit with default options would hold.
void find_contacts_of_human(const HumanClip& human, const SourceFeet& feet, const SceneWorld& world,
                            SourceContacts& of_feet, SolvedScene& solved) {
  const ContactPlan contacts = find_contacts_on_ground(world, feet);
  SurfaceParts parts(human, contacts.scale);
  for (int frame = 0; frame < human.frame_count; ++frame) parts.add(human.frame(frame));
  set_contacts(world, feet, contacts,
               find_surface_contacts(world, parts, {}, human.rate.frame_time()), solved);
  of_feet = contacts.of_ends();
}

}  // namespace

std::optional<MotionScene> motion_scene(const Motion& motion) {
  if (!motion.scene) return std::nullopt;
  MotionScene result{motion.scene->clip, motion.scene->human->clip, motion.scene->scale,
                     contact_labels(motion)};
  if (motion.plan.options.save.normalize_start) {
    WriteMotionOptions moved;
    moved.scene = std::move(result.robot);
    RobotClip clip = motion.clip;
    normalize_start(clip, moved);
    result.robot = std::move(*moved.scene);
  }
  return result;
}

Result<std::optional<MotionScene>> motion_scene(const MeasuredSource& source, bool lead_in,
                                                const Robot& robot) {
  const auto& world = lead_in ? source.scene_with_lead_in : source.scene;
  const HumanClip& human = lead_in ? *source.human_with_lead_in : source.human;
  if (!world) return std::optional<MotionScene>();
  TRY_ASSIGN(const ResolvedConfig config, config_for_bones(source, human));
  TRY_ASSIGN(const TargetBuilder targets,
             make_targets(human, poses_of(human), robot, config, source.scale));
  MotionScene result;
  result.scale = path_scales(targets).foot;
  result.robot = scaled_world(*world, result.scale).clip;
  result.human = world->clip;
  SolvedScene solved;
  solved.clip = result.robot;
  SourceContacts of_feet;
  const SourceFeet feet(human, human.frame_count);
  find_contacts_of_human(human, feet, *world, of_feet, solved);
  result.contacts = make_contact_labels(robot, config, human.frame_count, of_feet, &solved);
  return std::optional(std::move(result));
}

}  // namespace retarget
