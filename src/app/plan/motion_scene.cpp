#include "retarget/motion_scene.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "app/plan/motion_target.h"
#include "base/try.h"
#include "human/gait/source_feet.h"
#include "human/gait/surface_contacts.h"
#include "retarget/contact_plan.h"
#include "retarget/human.h"
#include "retarget/motion_io.h"
#include "retarget/retargeting_config.h"
#include "scene/scene_world.h"
#include "solve/fit/fit_setup.h"
#include "solve/targets/support_bodies.h"
#include "solve/targets/targets.h"

namespace retarget {
namespace {

class LabelMaker {
 public:
  LabelMaker(const Robot& robot, const ResolvedConfig& config, int frame_count,
             const SourceContacts& feet, const SolvedScene* scene)
      : robot_(robot), config_(config), feet_(feet), scene_(scene) {
    labels_.frame_count = frame_count;
  }

  ContactLabels make() {
    add_feet();
    if (scene_ != nullptr) add_parts();
    std::ranges::stable_sort(labels_.touches, {}, [](const SurfaceTouch& touch) {
      return std::tuple(rank(touch.part), touch.surface != kFloorName);
    });
    return std::move(labels_);
  }

 private:
  // Feet before other parts, in the order of their tables.
  static std::size_t rank(const std::string& part) {
    const auto foot = std::ranges::find(kContactNames, part);
    if (foot != kContactNames.end()) return static_cast<std::size_t>(foot - kContactNames.begin());
    return kContactNames.size() +
           static_cast<std::size_t>(std::ranges::find(kSupportNames, part) - kSupportNames.begin());
  }

  [[nodiscard]] std::string surface(int body) const {
    if (body == kFloorBody) return kFloorName;
    return scene_->clip.scene->bodies[static_cast<std::size_t>(body)].name;
  }

  // The body of a foot's sole; empty: the robot has none on this side.
  [[nodiscard]] std::string foot(std::string_view side) const {
    for (const Sole& sole : robot_.profile().soles) {
      if (sole.side == side) return robot_.bodies()[static_cast<std::size_t>(sole.body)].name;
    }
    return {};
  }

  void add(const SurfaceTouch& touch) {
    const int end = std::min(touch.end, labels_.frame_count);
    if (touch.begin >= end) return;
    labels_.touches.push_back(touch);
    labels_.touches.back().end = end;
  }

  void add_feet() {
    for (std::size_t end = 0; end < kContactNames.size(); ++end) {
      const std::string part(kContactNames[end]);
      const std::string link = foot(part.substr(0, part.find('_')));
      if (link.empty()) continue;
      const auto& phases = feet_[end];
      for (std::size_t i = 0; i < phases.size(); ++i) {
        const bool known = scene_ != nullptr && i < scene_->under_feet[end].size();
        add({part, link, surface(known ? scene_->under_feet[end][i] : kFloorBody), phases[i].begin,
             phases[i].end});
      }
    }
  }

  // The fit holds contacts of parts that the robot has.
  void add_parts() {
    for (const SupportBody& body : support_bodies(robot_, config_)) {
      const auto link = static_cast<std::size_t>(body.link);
      const auto of_link = static_cast<std::size_t>(robot_.tree().links()[link].body);
      for (const auto* contacts : {&scene_->on_floor, &scene_->contacts}) {
        for (const SceneContact& contact : *contacts) {
          if (contact.part != kSupportBones[body.support]) continue;
          add({std::string(kSupportNames[body.support]), robot_.bodies()[of_link].name,
               surface(contact.body), contact.begin, contact.end, contact.slides});
        }
      }
    }
  }

  const Robot& robot_;
  const ResolvedConfig& config_;
  const SourceContacts& feet_;
  const SolvedScene* scene_;
  ContactLabels labels_;
};

// Names the contacts of a motion by the robot's bodies: those of feet and, in a scene, of other
// parts.
// @param frame_count  frame count of the motion; contacts end there.
// @param feet  contacts of the human's heels and toes.
// @param scene  null: only the floor, under the feet.
ContactLabels make_contact_labels(const Robot& robot, const ResolvedConfig& config, int frame_count,
                                  const SourceContacts& feet, const SolvedScene* scene) {
  return LabelMaker(robot, config, frame_count, feet, scene).make();
}

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
// @param pace  see QualitySource::pace.
void find_contacts_of_human(const HumanClip& human, double pace, const SceneWorld& world,
                            SourceContacts& of_feet, SolvedScene& solved) {
  const SourceFeet feet = SourceFeet(human, human.frame_count).before_pace(pace);
  const ContactPlan contacts = find_contacts_on_ground(world, feet);
  SurfaceParts parts(human, contacts.scale);
  for (int frame = 0; frame < human.frame_count; ++frame) parts.add(human.frame(frame));
  set_contacts(world, feet, contacts,
               find_surface_contacts(world, parts, contacts, {}, feet.frame_time), solved);
  of_feet = contacts.of_ends();
}

}  // namespace

ContactLabels contact_labels(const Motion& motion) {
  return make_contact_labels(motion.clip.robot(), motion.plan.config, motion.clip.frame_count(),
                             motion.contacts, motion.scene ? &*motion.scene : nullptr);
}

std::optional<MotionScene> motion_scene(const Motion& motion) {
  if (!motion.scene) return std::nullopt;
  MotionScene result{motion.scene->clip, motion.scene->human->clip, motion.scene->scale,
                     contact_labels(motion)};
  if (motion.plan.options.save.normalize_start) {
    WriteMotionOptions moved;
    moved.scene = std::move(result.robot);
    RobotClip clip = motion.clip;
    normalize_start(start_of(motion), clip, moved);
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
  find_contacts_of_human(human, constant_pace(source.time_scale), *world, of_feet, solved);
  result.contacts = make_contact_labels(robot, config, human.frame_count, of_feet, &solved);
  return std::optional(std::move(result));
}

}  // namespace retarget
