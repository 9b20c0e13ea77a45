#include "solve/fit/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "base/faults.h"
#include "base/math/step_bounds.h"
#include "base/option_name.h"
#include "base/try.h"
#include "human/gait/edit_contacts.h"
#include "human/gait/seats.h"
#include "human/gait/source_feet.h"
#include "human/gait/standing_heights.h"
#include "human/gait/surface_contacts.h"
#include "retarget/kinematic_tree.h"
#include "retarget/pose.h"
#include "retarget/so3.h"
#include "retarget/statistics.h"
#include "retarget/text.h"
#include "solve/fit/branch_recovery.h"
#include "solve/fit/clip_fitter.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/fit_report.h"
#include "solve/fit/fit_setup.h"
#include "solve/fit/fit_windows.h"
#include "solve/fit/foot_plan.h"
#include "solve/fit/frame_terms.h"
#include "solve/fit/object_motion.h"
#include "solve/fit/shorthand.h"
#include "solve/fit/start_frames.h"
#include "solve/fit/window_solver.h"
#include "solve/targets/targets.h"

namespace retarget {

namespace {

// A fit of one clip, through all stages.
class Fit {
 public:
  Fit(const Clip& clip, const Calibration& calibration, const std::shared_ptr<const Robot>& robot,
      const ResolvedConfig& config, const LimitSet& limits, const FitOptions& options,
      const FitRun& run)
      : source_(clip),
        calibration_(calibration),
        robot_(robot),
        config_(config),
        limits_(limits),
        options_(options_for(*robot, options)),
        run_(run) {
    if (run.limit_speeds) return;
    constexpr double kAnySpeed = 1e6;  // rad/s.
    options_.speed = false;
    options_.max_joint_speed = options_.max_joint_step = kAnySpeed;
  }

  Result<FitResult> run();

 private:
  bool read_source(const HumanClipInfo& info, HumanPoser& poser, MadeTargets& made);
  double floor_height(const StandingHeights& standing, double scale) const;
  Result<void> solve(const MadeTargets& made, FitResult& result);
  [[nodiscard]] Result<void> check_finite() const;
  Result<void> recover_limbs(FitReport& report);
  void hold_joints();
  Result<void> hold_scene_contacts(const FitWindows& plan, int threads);
  Result<void> follow_hands_of_robot(const FitWindows& plan, int threads, FitResult& result);
  Result<void> solve_again(const FitWindows& plan, int threads);
  void edit_contacts_of(FitResult& result);
  void find_contacts_in_scene(const HumanClipInfo& info, HumanPoser& poser, double scale,
                              FitResult& result);
  void keep_bounds(FitReport& report);

  const Clip& source_;
  const Calibration& calibration_;
  const std::shared_ptr<const Robot>& robot_;
  const ResolvedConfig& config_;
  const LimitSet& limits_;
  FitOptions options_;
  const FitRun& run_;

  SourceSides sides_;
  FitModel model_;
  FitClip clip_;
  SourceFeet feet_;
  std::vector<Eigen::Vector3d> path_;  // One per frame: offset added to the first stage's targets.
};

// Reads the human's poses and makes the targets of all frames.
// @return true if all targets are finite and small enough for the computation.
bool Fit::read_source(const HumanClipInfo& info, HumanPoser& poser, MadeTargets& made) {
  constexpr double kTooLarge = 1e50;  // Metres.
  const PathScales scales = path_scales(made.targets);
  bool usable = true;
  HumanPose bones;
  const std::size_t count = at(made.targets.target_count());
  made.world_from_target.resize(at(info.frame_count) * count);
  feet_ = SourceFeet(info);
  feet_.reserve(info.frame_count);
  path_.reserve(at(info.frame_count));
  clip_.targets.reserve(at(info.frame_count) * model_.tasks.size());
  clip_.frame_time = info.rate.frame_time();
  clip_.frame_count = info.frame_count;
  for (int frame = 0; frame < info.frame_count; ++frame) {
    const auto world_from_target =
        std::span(made.world_from_target).subspan(at(frame) * count, count);
    poser.pose(frame, bones);
    made.targets.build(bones, world_from_target);
    feet_.add(bones);
    // The root travels at the scale of the feet. Otherwise standing feet would slip.
    path_.emplace_back((scales.foot - scales.root) * bones[config_.root_bone].translation);
    append_targets(model_, world_from_target, path_.back(), clip_.targets);
    for (const Pose& pose : world_from_target) {
      usable = usable && pose.rotation.coeffs().allFinite() && pose.translation.allFinite() &&
               pose.translation.cwiseAbs().maxCoeff() < kTooLarge;
    }
  }
  return usable;
}

// Height of the floor, metres: of the robot's soles when its feet are at their standing targets.
double Fit::floor_height(const StandingHeights& standing, double scale) const {
  double sum = 0.0;
  int count = 0;
  for (std::size_t k = 0; k < model_.tasks.size(); ++k) {
    const FitTask& task = model_.tasks[k];
    if (task.foot < 0) continue;
    const int side = source_foot(model_.feet[at(task.foot)]);
    // A foot's target height is the scaled ankle height plus an offset of the configuration. The
    // offset depends on the foot's rotation, hence the median.
    std::vector<double> offsets;
    offsets.reserve(at(clip_.frame_count));
    for (int frame = 0; frame < clip_.frame_count; ++frame) {
      offsets.push_back(clip_.targets[at(frame) * model_.tasks.size() + k].position.z() -
                        scale * feet_.at(frame, side).ankle.z());
    }
    sum += scale * standing.ankle + median(std::move(offsets)) -
           model_.feet[at(task.foot)].body_height;
    ++count;
  }
  return count == 0 ? 0.0 : sum / count;
}

// Runs the first stage and the windows concurrently. A window starts once the first stage has
// solved all frames that the window reads.
Result<void> Fit::solve(const MadeTargets& made, FitResult& result) {
  const FitWindows plan = plan_windows(clip_, options_);
  const int threads = options_.threads > 0 ? options_.threads
                                           : static_cast<int>(std::thread::hardware_concurrency());
  StartFrames starts(model_, path_, options_.floor, clip_);
  WindowSolver windows(model_, options_, plan, clip_, threads, run_.costs);
  SolveFramesOptions options = run_.retarget;
  options.settle = true;
  options.frame_solved = [&](int frame, std::span<const double> qpos) {
    starts.take(frame, qpos);
    windows.starts_are_there(frame + 1);
  };
  TRY_ASSIGN(const auto first,
             solve_frames(made, robot_, config_, first_limits(*robot_, limits_), options));
  result.steps = first.steps;
  windows.starts_are_there(clip_.frame_count);
  if (!windows.finish(run_.keep_going)) return interrupted_failure();
  TRY(hold_scene_contacts(plan, threads));
  TRY(follow_hands_of_robot(plan, threads, result));
  TRY(recover_limbs(result.report));
  TRY(check_finite());
  keep_bounds(result.report);
  const std::vector<TermCosts> costs = windows.costs_now();
  if (run_.costs) report_terms(clip_, windows.costs_before(), costs, result.report);
  report_status(windows.statuses(), windows.costs_before(), costs, result.report);
  return {};
}

// Solves again and holds each sticking scene contact at its mean position in the first solve.
Result<void> Fit::hold_scene_contacts(const FitWindows& plan, int threads) {
  if (!clip_.scene) return {};
  auto held = std::make_shared<FitScene>(*clip_.scene);
  if (!hold_contacts(model_, clip_.qpos, *held)) return {};
  clip_.scene = std::move(held);
  return solve_again(plan, threads);
}

// Moves the objects with the hands that hold them, and solves again with the new object paths.
Result<void> Fit::follow_hands_of_robot(const FitWindows& plan, int threads, FitResult& result) {
  if (!clip_.scene || run_.object_motion != ObjectMotion::kFitted) return {};
  auto followed = std::make_shared<FitScene>(*clip_.scene);
  const std::vector<ObjectMove> moved =
      follow_hands(model_, clip_.qpos, clip_.frame_time, *followed);
  for (const ObjectMove& move : moved) {
    result.report.notes.push_back(fmt::format("the robot displaces {} by up to {:.1f} cm",
                                              printable(move.body), 100.0 * move.farthest));
  }
  if (moved.empty()) return {};
  result.scene->clip = followed->world.clip;
  clip_.scene = std::move(followed);
  return solve_again(plan, threads);
}

Result<void> Fit::solve_again(const FitWindows& plan, int threads) {
  WindowSolver windows(model_, options_, plan, clip_, threads, false);
  windows.starts_are_there(clip_.frame_count);
  if (!windows.finish(run_.keep_going)) return interrupted_failure();
  return {};
}

// The fit applies no step with a non-finite value, so only the first stage can yield such values.
Result<void> Fit::check_finite() const {
  const auto bad = std::ranges::find_if(clip_.qpos, [](double x) { return !std::isfinite(x); });
  if (bad == clip_.qpos.end()) return {};
  const auto frame = (bad - clip_.qpos.begin()) / model_.configuration_size;
  return config_failure(config_.file,
                        fmt::format("frame {}: the fit has values that are not finite", frame));
}

// Moves limbs off wrong branches of their inverse kinematics.
Result<void> Fit::recover_limbs(FitReport& report) {
  if (!run_.recover_limbs) return {};
  const BranchRecovery recovery = recover_branches(
      model_, options_, clip_, [this] { return !run_.keep_going || run_.keep_going(1.0); });
  if (recovery.stopped) return interrupted_failure();
  for (std::string& note : recovery.notes()) report.notes.push_back(std::move(note));
  std::ranges::copy(recovery.failures, std::back_inserter(report.failures));
  return {};
}

// Holds the joints without a target at the positions of run_.hold. Their ranges are the positions of
// the first frame.
void Fit::hold_joints() {
  if (!run_.hold || source_.frame_count() == 0) return;
  clip_.hold = run_.hold;
  std::vector<double> first = robot_->zero_configuration();
  clip_.hold(0, first);
  for (std::size_t link = 1; link < model_.tree.links().size(); ++link) {
    const std::size_t dof = link + KinematicTree::kBaseDofs - 1;
    if (model_.lower[dof] != model_.upper[dof]) continue;
    const KinematicTree::Link& held = model_.tree.links()[link];
    model_.lower[dof] = model_.upper[dof] = first[at(held.qpos_address)];
  }
}

// Projects each joint's positions onto its position and speed limits. Held joints keep their own
// limits, and the range of hold_joints() is their position in the first frame only.
void Fit::keep_bounds(FitReport& report) {
  constexpr double kNoChange = 1e-4;  // Smaller changes are not reported; rad or m.
  std::vector<double> before, now(at(clip_.frame_count));
  for (std::size_t link = 1; link < model_.tree.links().size(); ++link) {
    const std::size_t dof = link + KinematicTree::kBaseDofs - 1;
    if (clip_.hold && model_.lower[dof] == model_.upper[dof]) continue;
    const auto address = at(model_.tree.links()[link].qpos_address);
    for (int t = 0; t < clip_.frame_count; ++t) {
      now[at(t)] = clip_.frame(t, model_.configuration_size)[address];
    }
    before = now;
    double step = model_.speed_limit[dof] * clip_.frame_time;
    if (!model_.tree.links()[link].slides) {
      step = std::min({step, options_.max_joint_speed * clip_.frame_time, options_.max_joint_step});
    }
    const StepBounds bounds =
        bounds_for_printing({model_.lower[dof], model_.upper[dof], step}, options_.decimals,
                            model_.tree.links()[link].slides, run_.printed);
    if (bound_steps(now, bounds.lower, bounds.upper, bounds.step) == 0.0) continue;
    FitBoundReport bound{robot_->joints()[at(model_.tree.links()[link].joint)].name, 0, 0, 0.0};
    for (int t = 0; t < clip_.frame_count; ++t) {
      const double change = std::abs(now[at(t)] - before[at(t)]);
      clip_.frame(t, model_.configuration_size)[address] = now[at(t)];
      if (change > kNoChange) ++bound.frames;
      if (change > bound.largest) {
        bound.largest = change;
        bound.worst_frame = t;
      }
    }
    if (bound.frames > 0) report.bounded.push_back(bound);
  }
}

void Fit::edit_contacts_of(FitResult& result) {
  for (const std::size_t idle : edit_contacts(run_.contact_edits, feet_, result.contacts)) {
    result.report.notes.push_back("contact edit " + std::to_string(idle + 1) +
                                  " changes nothing: " + run_.contact_edits[idle].part);
  }
}

void Fit::find_contacts_in_scene(const HumanClipInfo& info, HumanPoser& poser, double scale,
                                 FitResult& result) {
  const SceneWorld& world = *run_.scene;
  const ContactOptions options = contact_options(options_);
  result.contacts = find_contacts_on_ground(world, feet_.before_pace(run_.pace), options);
  edit_contacts_of(result);
  SurfaceParts parts(info, result.contacts.scale);
  HumanPose bones;
  for (int frame = 0; frame < info.frame_count; ++frame) {
    poser.pose(frame, bones);
    parts.add(bones);
  }
  const std::vector<SurfacePhase> phases =
      find_surface_contacts(world, parts, result.contacts, options, clip_.frame_time / run_.pace);
  auto scene = std::make_shared<FitScene>(
      make_fit_scene(model_, world, parts, phases, scale, clip_.frame_time, clip_.targets));
  SolvedScene& solved = result.scene.emplace();
  solved.clip = scene->world.clip;
  solved.scale = scale;
  set_contacts(world, feet_, result.contacts, phases, solved);
  scene->joint_smoothness =
      smoothness_near_contacts(solved, result.contacts, clip_.frame_count, clip_.frame_time);
  clip_.scene = std::move(scene);
}

Result<FitResult> Fit::run() {
  FitResult result;
  HumanPoser poser(source_, calibration_);
  const HumanClipInfo info = poser.info();
  const HumanPoseSource poses = poses_of(poser);
  TRY_ASSIGN(const TargetBuilder targets,
             make_targets(info, poses, *robot_, config_, run_.retarget.scale, TrunkRule::kLines,
                          &limits_));
  const auto limbs = robot_limbs(*robot_, config_);
  if (limbs) options_ = sized_options(options_, limbs->lengths.leg);
  BoneArray<int> target_of_bone;
  for (const Bone bone : kAllBones) target_of_bone[bone] = targets.target_of(bone);
  sides_ = sides_with_feet(info);
  model_ = make_fit_model(*robot_, config_, limits_, target_of_bone, options_, sides_);
  if (limbs) model_.leg = limbs->lengths.leg;
  if (!run_.limit_speeds) {
    model_.speed_limit.assign(model_.speed_limit.size(), std::numeric_limits<double>::infinity());
  }
  hold_joints();
  FitReport& report = result.report;
  note_missing_feet(*robot_, sides_, report);
  note_dynamics(options_, model_, report);
  if (model_.shapes.empty()) {
    report.notes.emplace_back("the robot has no collision shapes: the fit has no collision term");
  }
  MadeTargets made{targets, info.rate, {}};
  if (!read_source(info, poser, made)) {
    // The error of the first stage names the frame. Only if the first stage accepts the positions
    // does the general error below apply.
    TRY(solve_frames(source_, calibration_, robot_, config_, first_limits(*robot_, limits_),
                     run_.retarget));
    return input_failure(source_.name(), "target positions are too large or not finite",
                         "is " OPTION("unit") " right?");
  }
  const double scale = path_scales(targets).foot;
  if (run_.scene != nullptr && !model_.feet.empty()) {
    find_contacts_in_scene(info, poser, scale, result);
  } else {
    result.contacts = find_contacts(feet_.before_pace(run_.pace), contact_options(options_));
    edit_contacts_of(result);
  }
  if (!model_.feet.empty()) {
    report.floor_found = result.contacts.standing.found;
    report.floor_height = floor_height(result.contacts.standing, scale);
    std::vector<int> source_feet;
    for (const FitFoot& foot : model_.feet) source_feet.push_back(source_foot(foot));
    const std::vector<double> ground =
        run_.scene ? ground_under_feet(*run_.scene, feet_) : std::vector<double>();
    plan_feet(feet_, result.contacts, contact_options(options_), source_feet, scale, ground,
              clip_.feet);
    plan_supports(feet_, result.contacts, model_.supports, clip_.frame_count, scale, clip_.feet);
    ease_contacts(feet_, source_feet, scale, clip_.scene.get(), clip_.feet);
    note_floor(result.contacts.standing, report);
    if (run_.scene == nullptr) {
      note_raised_feet(clip_, report);
      note_seats(find_seats(info, poses_of(poser), result.contacts), clip_,
                 retarget::floor_height(result.contacts), report);
    }
  }
  for (Eigen::Vector3d& path : path_) path.z() -= report.floor_height;
  for (TaskTarget& target : clip_.targets) target.position.z() -= report.floor_height;
  report.contact_phases = static_cast<int>(clip_.feet.phases.size());
  TRY(solve(made, result));
  result.clip = RobotClip(robot_, info.rate, info.frame_count);
  Eigen::Vector4d before = Eigen::Vector4d::UnitX();  // Identity, w first.
  for (int t = 0; t < clip_.frame_count; ++t) {
    const auto now = clip_.frame(t, model_.configuration_size);
    Eigen::Map<Eigen::Vector4d> root(now.data() + 3);
    align_sign(before, root);
    before = root;
    std::ranges::copy(now, result.clip.qpos(t).begin());
  }
  return result;
}

}  // namespace

Result<FitResult> fit(const Clip& clip, const Calibration& calibration,
                      const std::shared_ptr<const Robot>& robot, const ResolvedConfig& config,
                      const LimitSet& limits, const FitOptions& options, const FitRun& run) {
  return located(Fit(clip, calibration, robot, config, limits, options, run).run(), clip.name());
}

}  // namespace retarget
