#include "retarget/solve.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "app/plan/hand_choice.h"
#include "app/plan/motion_target.h"
#include "app/plan/scale_time.h"
#include "app/plan/surroundings.h"
#include "base/faults.h"
#include "base/math/step_bounds.h"
#include "base/option_name.h"
#include "base/try.h"
#include "motion/resample.h"
#include "retarget/machine.h"
#include "retarget/resample.h"
#include "retarget/text.h"
#include "scene/scene_world.h"
#include "solve/fit/fit.h"
#include "solve/hands/hand_track.h"
#include "solve/targets/solve_frames.h"

namespace retarget {
namespace {

// Rejects a motion too far from the origin: readers of robot motions reject it, and its written
// values do not resolve single steps.
Result<void> check_place(const Clip& clip, const Plan& plan) {
  const double metres_per_unit = plan.human.calibration.metres_per_unit;
  const double max = plan.options.save.centimetres ? 5e3 : 5e5;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const bool far = std::ranges::any_of(clip.translations(frame), [&](const auto& place) {
      return !(place.cwiseAbs().maxCoeff() * metres_per_unit <= max);
    });
    if (!far) continue;
    return input_failure(
        clip.name(),
        "in frame " + std::to_string(frame) + " the body is more than " +
            number_text(max / 1000.0, 0) + " km away from the origin",
        "move the motion to the origin first, or set its unit with " OPTION("unit"));
  }
  return {};
}

SolveFramesOptions pass_options(const Plan& plan, const SolveControl& control, int frames) {
  SolveFramesOptions options;
  options.engine = plan.options.solve.engine;
  options.targets_ahead = control.threads != 1;
  options.scale = plan.scale;
  if (control.keep_going) {
    options.keep_going = [&control, frames](int frame) {
      return control.keep_going({Stage::kFrames, frame, frames});
    };
  }
  return options;
}

// Units in which the CSVs of a motion print joint positions; SI units without CSVs.
std::vector<PrintedUnits> printed_units(const Plan& plan) {
  std::vector<PrintedUnits> units;
  for (const RobotCsvOptions& csv : csv_layouts(plan.options.save, plan.rate)) {
    units.push_back({csv.degrees ? PrintedUnits::kDegrees : 1.0,
                     csv.centimetres ? PrintedUnits::kCentimetres : 1.0});
  }
  if (units.empty()) units.emplace_back();
  return units;
}

// Motion of the robot's fingers, which the body's solvers do not move.
HandTrack hand_track(const Plan& plan, const Clip& source, const SourceHands& followed) {
  const SolveOptions& solve = plan.options.solve;
  const HandsRule rule = hands_rule(solve.hands, solve.method);
  if (rule == HandsRule::kOff) return {};
  const Robot& robot = *plan.robot.robot;
  const RobotHands hands = find_hands(robot);
  const FitOptions& fit = plan.fit;
  return {
      source,      followed,
      robot,       hands,
      plan.limits, {fit.max_joint_speed, fit.max_joint_step, fit.decimals, printed_units(plan)}};
}

void write_hands(const HandTrack& hands, Motion& motion) {
  if (hands.empty()) return;
  for (int frame = 0; frame < motion.clip.frame_count(); ++frame) {
    hands.write(frame, motion.clip.qpos(frame));
  }
  std::ranges::copy(hands.failures(), std::back_inserter(motion.solver_failures));
}

Result<void> solve_fit(const Plan& plan, const std::shared_ptr<const SceneWorld>& scene,
                       const SolveControl& control, bool limit_speeds, const SourceHands& followed,
                       Motion& motion) {
  FitOptions options = plan.fit;
  if (options.threads == 0) {
    options.threads = control.threads > 0 ? control.threads : usable_cores();
  }
  FitRun run;
  run.retarget = pass_options(plan, control, motion.source->frame_count());
  if (control.keep_going) {
    run.keep_going = [&control](double done) {
      return control.keep_going({Stage::kFit, static_cast<int>(100.0 * done), 100});
    };
  }
  run.scene = scene.get();
  run.contact_edits = plan.contact_edits;
  run.pace = constant_pace(plan.time_scale);
  run.object_motion = plan.options.solve.object_motion;
  run.limit_speeds = limit_speeds;
  run.printed = printed_units(plan);
  run.costs = control.fit_costs;
  const HandTrack hands = hand_track(plan, *motion.source, followed);
  if (!hands.empty()) {
    run.hold = [&hands](int frame, std::span<double> qpos) { hands.write(frame, qpos); };
  }
  TRY_ASSIGN(FitResult fitted, fit(*motion.source, plan.human.calibration, plan.robot.robot,
                                   plan.config, plan.limits, options, run));
  motion.clip = std::move(fitted.clip);
  motion.ik_steps = fitted.steps;
  motion.fit = std::move(fitted.report);
  if (!plan.robot.robot->fixed_base()) motion.contacts = fitted.contacts.of_ends();
  motion.scene = std::move(fitted.scene);
  if (motion.scene) motion.scene->human = scene;
  motion.solver_failures = motion.fit->failures;
  write_hands(hands, motion);
  if (!control.frame_solved) return {};
  for (int frame = 0; frame < motion.clip.frame_count(); ++frame) {
    control.frame_solved(frame, std::as_const(motion.clip).qpos(frame));
  }
  return {};
}

Result<void> solve_frames(const Plan& plan, const SolveControl& control,
                          const SourceHands& followed, Motion& motion) {
  SolveFramesOptions options = pass_options(plan, control, motion.source->frame_count());
  const HandTrack hands = hand_track(plan, *motion.source, followed);
  std::vector<double> with_hands;
  options.frame_solved = control.frame_solved;
  if (!hands.empty() && control.frame_solved) {
    options.frame_solved = [&](int frame, std::span<const double> qpos) {
      with_hands.assign(qpos.begin(), qpos.end());
      hands.write(frame, with_hands);
      control.frame_solved(frame, with_hands);
    };
  }
  TRY_ASSIGN(SolvedFrames result,
             solve_frames(*motion.source, plan.human.calibration, plan.robot.robot, plan.config,
                          plan.limits, options));
  motion.clip = std::move(result.clip);
  motion.ik_steps = result.steps;
  write_hands(hands, motion);
  return {};
}

}  // namespace

Result<std::shared_ptr<const Clip>> prepare_clip(const Plan& plan) {
  std::shared_ptr<const Clip> clip = plan.clip;
  const bool whole = plan.part == FrameRange{0, clip->frame_count()};
  const bool at_rate = plan.rate == clip->rate();
  if (!whole || !at_rate) {
    Clip part = whole ? *clip : cut(*clip, plan.part.begin, plan.part.end);
    if (!at_rate) {
      const TimeOptions& time = plan.options.time;
      TRY_ASSIGN(part, located(resample(std::move(part), plan.rate,
                                        {time.interpolation, !time.no_antialias}),
                               clip->name()));
    }
    clip = std::make_shared<const Clip>(std::move(part));
  }
  if (plan.time_scale && !plan.time_scale->pace.empty()) {
    clip = std::make_shared<const Clip>(warp_time(*clip, *plan.time_scale));
  }
  TRY(check_place(*clip, plan));
  return clip;
}

Result<Motion> solve(Plan plan, const SolveControl& control) {
  TRY_ASSIGN(plan, decide_time_scale(std::move(plan), control));
  return solve_in_time(std::move(plan), control, true);
}

Result<Motion> solve_in_time(Plan plan, const SolveControl& control, bool limit_speeds) {
  Motion motion;
  TRY_ASSIGN(motion.source, prepare_clip(plan));
  TRY_ASSIGN(const auto scene, human_surroundings(plan, *motion.source));
  const SourceHands followed = choose_hands(*plan.clip, plan);
  // The original clip is not needed any more; release its memory.
  plan.clip = nullptr;
  const bool is_fit = plan.options.solve.method == Method::kFit;
  TRY(is_fit ? solve_fit(plan, scene, control, limit_speeds, followed, motion)
             : solve_frames(plan, control, followed, motion));
  motion.plan = std::move(plan);
  return motion;
}

}  // namespace retarget
