#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "app/plan/motion_target.h"
#include "app/plan/surroundings.h"
#include "base/try.h"
#include "human/skeleton/source_hands.h"
#include "retarget/check_options.h"
#include "retarget/clip.h"
#include "retarget/contact_edits.h"
#include "retarget/human.h"
#include "retarget/measure.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/option_table.h"
#include "retarget/plan.h"
#include "retarget/report.h"
#include "retarget/solve.h"
#include "scene/scene_world.h"

namespace retarget {
namespace {

Result<HumanClip> human_of(const Plan& plan, std::shared_ptr<const Clip>& fingers,
                           std::shared_ptr<const SceneWorld>& scene) {
  TRY_ASSIGN(const auto clip, prepare_clip(plan));
  TRY_ASSIGN(scene, human_surroundings(plan, *clip));
  const SourceHands hands = find_source_hands(clip->skeleton(), plan.human.map);
  if (hands[0] || hands[1]) fingers = clip;
  return to_human(*clip, plan.human.calibration);
}

// The source, with its lead-in or without.
QualitySource quality_source(const MeasuredSource& measured, bool lead_in) {
  return {.human = lead_in ? &*measured.human_with_lead_in : &measured.human,
          .config = &measured.config,
          .scale = measured.scale,
          .trunk = measured.trunk,
          .scene = (lead_in ? measured.scene_with_lead_in : measured.scene).get(),
          // Their times count from the end of the lead-in.
          .contact_edits = lead_in ? std::span<const ContactEdit>() : measured.contact_edits,
          .pace = constant_pace(measured.time_scale),
          .up_is_uncertain = measured.up_is_uncertain};
}

QualityReport measure_beside(const RobotClip& motion, const LimitSet& limits,
                             const MeasuredSource& measured, bool lead_in) {
  const QualitySource source = quality_source(measured, lead_in);
  return measure_quality(motion, limits, &source);
}

TrunkRule trunk_rule(const Plan& plan) {
  return plan.options.solve.method == Method::kGmr ? TrunkRule::kBones : TrunkRule::kLines;
}

void skip_frames(HumanClip& human, int frames) {
  human.world_from_bone.erase(human.world_from_bone.begin(),
                              human.world_from_bone.begin() + frames);
  human.frame_count -= frames;
}

std::shared_ptr<const SceneWorld> without_first(SceneWorld world, int frames) {
  SceneClip& clip = world.clip;
  const auto poses = static_cast<std::ptrdiff_t>(clip.scene->bodies.size()) * frames;
  clip.world_from_body.erase(clip.world_from_body.begin(), clip.world_from_body.begin() + poses);
  for (StatedContact& contact : clip.contacts) {
    contact.touches.erase(contact.touches.begin(), contact.touches.begin() + frames);
  }
  clip.frame_count -= frames;
  return std::make_shared<const SceneWorld>(std::move(world));
}

// Mean angle between the limbs of robot and human, degrees.
double limb_angle(const QualityReport& report) {
  const MetricValue* found = report.find("limb_angle_deg");
  return found == nullptr ? HUGE_VAL : found->value;
}

}  // namespace

Result<MeasuredSource> measured_source(Plan plan) {
  MeasuredSource source;
  source.name = std::filesystem::path(plan.clip->name()).filename().string();
  source.rate = plan.rate;
  source.config = plan.config;
  source.config_file = recorded_name(plan.config.file, plan.robot.data_folder);
  source.scale = plan.scale;
  source.trunk = trunk_rule(plan);
  source.travel = plan.travel;
  source.time_scale = plan.time_scale;
  source.contact_edits = plan.contact_edits;
  source.map = plan.human.map;
  source.up_is_uncertain = plan.human.calibration.up_is_uncertain;
  TRY_ASSIGN(source.human, human_of(plan, source.fingers, source.scene));
  // Scaled time starts at the used part, so such a motion has no lead-in.
  if (plan.lead_in_frames == 0 || plan.time_scale) return source;
  plan.part.begin = 0;
  TRY_ASSIGN(source.human_with_lead_in,
             human_of(plan, source.fingers_with_lead_in, source.scene_with_lead_in));
  return source;
}

void skip_frames(MeasuredSource& source, int frames) {
  const int skipped = std::clamp(frames, 0, source.human.frame_count - 1);
  if (skipped == 0) return;
  skip_frames(source.human, skipped);
  if (source.human_with_lead_in) skip_frames(*source.human_with_lead_in, skipped);
  for (auto* fingers : {&source.fingers, &source.fingers_with_lead_in}) {
    if (!*fingers) continue;
    *fingers = std::make_shared<const Clip>(cut(**fingers, skipped, (*fingers)->frame_count()));
  }
  for (auto* scene : {&source.scene, &source.scene_with_lead_in}) {
    if (*scene) *scene = without_first(**scene, skipped);
  }
  const double time = skipped * source.rate.frame_time();
  std::erase_if(source.contact_edits, [&](const ContactEdit& edit) { return edit.end < time; });
  for (ContactEdit& edit : source.contact_edits) {
    edit.start = std::max(edit.start - time, 0.0);
    edit.end -= time;
  }
}

MotionMeasure measure_motion(const RobotClip& motion, const LimitSet& limits,
                             const MeasuredSource* source, bool dynamics) {
  if (source == nullptr) {
    MotionMeasure measure{measure_quality(motion, limits, nullptr)};
    if (dynamics) add_dynamics(motion, measure.report);
    return measure;
  }
  const HumanClip* human = &source->human;
  MotionMeasure measure{measure_beside(motion, limits, *source, false)};
  if (const auto& whole = source->human_with_lead_in) {
    QualityReport with_lead_in = measure_beside(motion, limits, *source, true);
    const bool needs_it = motion.frame_count() > human->frame_count;
    if (limb_angle(with_lead_in) < limb_angle(measure.report) ||
        (needs_it && limb_angle(with_lead_in) == limb_angle(measure.report))) {
      measure.report = std::move(with_lead_in);
      measure.has_lead_in = true;
      human = &*whole;
    }
  }
  const QualitySource used = quality_source(*source, measure.has_lead_in);
  add_limited_joints(motion, limits, used, measure.report);
  if (dynamics) {
    const auto world = robot_world(used, motion.robot());
    add_dynamics(motion, measure.report, world.get());
  }
  const auto& fingers = measure.has_lead_in ? source->fingers_with_lead_in : source->fingers;
  if (fingers) add_hands(motion, *fingers, source->map, measure.report);
  measure.source_frames = human->frame_count;
  measure.report.source = source->name;
  measure.report.travel = source->travel;
  measure.report.time_scale = source->time_scale;
  measure.report.config = source->config_file;
  return measure;
}

Option dynamics_row(bool& dynamics) {
  return option("dynamics", dynamics, kOutputGroup, "",
                "Also compute inverse dynamics: forces that no contact can supply, torques beyond "
                "limits, balance, friction (docs/dynamics.md)",
                {.decides = false});
}

namespace fs = std::filesystem;

namespace {

// The world of a solved robot; empty if it has none.
std::optional<SceneWorld> solved_world(const Motion& motion) {
  if (!motion.scene) return std::nullopt;
  SceneWorld world = scaled_world(*motion.scene->human, motion.scene->scale);
  world.clip = motion.scene->clip;
  return world;
}

// Moves a motion and its world like the motion in the file.
void normalize_start(const StartNormalizer& start, RobotClip& clip,
                     std::optional<SceneWorld>& world) {
  WriteMotionOptions moved;
  if (world) moved.scene = std::move(world->clip);
  normalize_start(start, clip, moved);
  if (world) world->clip = std::move(*moved.scene);
}

// A motion as read back from its coarsest CSV or, without one, from its first file. The nine
// decimals of csv-sonic are not measured.
Result<RobotClip> written_clip(const RobotClip& clip, const Plan& plan) {
  const SaveOptions& save = plan.options.save;
  const std::vector<RobotCsvOptions> layouts = csv_layouts(save, plan.rate);
  if (!layouts.empty()) return printed_clip(clip, layouts.front());
  TrackingOptions tracking;
  tracking.rate = {save.npz_fps, 1};
  return printed_clip(stored_clip(clip, save.formats.front(), tracking), {.precision = 17});
}

}  // namespace

Result<QualityReport> evaluate(const Motion& motion, bool dynamics) {
  const Plan& plan = motion.plan;
  TRY_ASSIGN(const Gates gates, default_gates(plan.robot.data_folder));
  // Measure the values that a file would contain, with their limited precision.
  RobotClip moved = motion.clip;
  std::optional<SceneWorld> world = solved_world(motion);
  if (plan.options.save.normalize_start) normalize_start(start_of(motion), moved, world);
  TRY_ASSIGN(const RobotClip printed, written_clip(moved, plan));
  const HumanClip human = to_human(*motion.source, plan.human.calibration);
  const QualitySource source{.human = &human,
                             .config = &plan.config,
                             .scale = plan.scale,
                             .trunk = trunk_rule(plan),
                             .scene = motion.scene ? motion.scene->human.get() : nullptr,
                             .around_robot = world ? &*world : nullptr,
                             .contact_edits = plan.contact_edits,
                             .pace = constant_pace(plan.time_scale),
                             .up_is_uncertain = plan.human.calibration.up_is_uncertain};
  QualityReport report = measure_quality(printed, plan.limits, &source);
  // Tasks pull towards the human, so the motion must not be moved away from it.
  if (plan.options.save.normalize_start) {
    TRY_ASSIGN(const RobotClip unmoved, written_clip(motion.clip, plan));
    add_limited_joints(unmoved, plan.limits, source, report);
  } else {
    add_limited_joints(printed, plan.limits, source, report);
  }
  add_hands(printed, *motion.source, plan.human.map, report);
  if (dynamics) add_dynamics(printed, report, source.around_robot);
  add_solver_failures(motion.solver_failures, report);
  report.source = fs::path(motion.source->name()).filename().string();
  report.config = recorded_name(plan.config.file, plan.robot.data_folder);
  report.travel = plan.travel;
  report.time_scale = plan.time_scale;
  report.fit = motion.fit;
  gates.judge(report);
  return report;
}

Result<QualityReport> evaluate(const Motion& motion) {
  return evaluate(motion, false);
}

}  // namespace retarget
