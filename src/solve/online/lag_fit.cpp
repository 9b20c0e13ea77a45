#include "solve/online/lag_fit.h"

#include <algorithm>
#include <cstddef>

#include "retarget/try.h"
#include "solve/fit/foot_plan.h"
#include "solve/fit/frame_costs.h"
#include "solve/fit/shorthand.h"
#include "solve/fit/start_frames.h"
#include "solve/ik/ik_solver.h"
#include "solve/targets/limb_lengths.h"
#include "solve/targets/solve_frames.h"

namespace retarget {

Result<std::unique_ptr<OnlineTargets>> OnlineTargets::make(const Plan& plan) {
  HumanPoser poser(*plan.clip, plan.human.calibration);
  const HumanClipInfo human = poser.info();
  const bool as_fit = plan.options.solve.method == Method::kFit;
  RETARGET_TRY_ASSIGN(TargetBuilder targets,
                      make_targets(human, poses_of(poser), *plan.robot.robot, plan.config,
                                   plan.scale, as_fit ? TrunkRule::kLines : TrunkRule::kBones,
                                   as_fit ? &plan.limits : nullptr));
  return std::unique_ptr<OnlineTargets>(new OnlineTargets(plan, human, std::move(targets)));
}

OnlineTargets::OnlineTargets(const Plan& plan, const HumanClipInfo& human, TargetBuilder targets)
    : as_fit_(plan.options.solve.method == Method::kFit),
      engine_(plan.options.solve.engine),
      robot_(plan.robot.robot),
      config_(plan.config),
      limits_(plan.limits),
      solver_limits_(as_fit_ ? first_limits(*robot_, limits_) : limits_),
      human_(human),
      targets_(std::move(targets)),
      options_(options_for(*plan.robot.robot, plan.fit)),
      solver_(make_problem(robot_, config_, targets_, solver_limits_), engine_, IkOptions()),
      world_from_target_(static_cast<std::size_t>(targets_.target_count())),
      qpos_(robot_->zero_configuration()),
      before_(qpos_),
      settles_(as_fit_) {
  const auto limbs = robot_limbs(*robot_, config_);
  if (limbs) options_ = sized_options(options_, limbs->lengths.leg);
  // Streams are not cleaned, and most trackers are noisier than recordings.
  constexpr double kLiveNoise = 0.6;
  options_ = options_for_noise(options_, kLiveNoise);
  // The dynamics require future frames.
  options_.dynamics = false;
  BoneArray<int> target_of_bone;
  for (const Bone bone : kAllBones) target_of_bone[bone] = targets_.target_of(bone);
  model_ =
      make_fit_model(*robot_, config_, limits_, target_of_bone, options_, sides_with_feet(human_));
  if (limbs) model_.leg = limbs->lengths.leg;
  scales_ = path_scales(targets_);
}

void OnlineTargets::build(const HumanPose& world_from_bone) {
  targets_.build(world_from_bone, world_from_target_);
  if (!as_fit_) return;
  path_ = (scales_.foot - scales_.root) * world_from_bone[config_.root_bone].translation;
}

bool OnlineTargets::solve() {
  std::ranges::copy(qpos_, before_.begin());
  const bool solved = std::exchange(settles_, false)
                          ? settle()
                          : solver_.solve(world_from_target_, qpos_, config_.file).has_value();
  if (!solved) std::ranges::copy(before_, qpos_.begin());
  return solved;
}

bool OnlineTargets::settle() {
  const MadeTargets made{targets_, FrameRate{}, world_from_target_};
  SolveFramesOptions options;
  options.engine = engine_;
  options.settle = true;
  const auto solved = solve_frames(made, robot_, config_, solver_limits_, options);
  if (!solved) return false;
  std::ranges::copy(solved->clip.qpos(0), qpos_.begin());
  return true;
}

namespace {

constexpr double kKeptTime = 6.0;  // Time of sent frames that contact detection uses, seconds.
constexpr int kMostAtATime = 50;   // Longest window that takes steps in every frame, frames.
// Time of later frames from which they determine how the motion of a frame continues, seconds.
constexpr double kEnoughLater = 0.02;
// Length from which a window has the smoothness of a clip, seconds.
constexpr double kFullWindow = 0.04;

// The options for a window of a frame and `later` following ones. Without enough later frames, a
// cost on changes of acceleration continues every swing of a limb, so that it oscillates at its
// speed limit; a cost on accelerations makes limbs lag and overshoot.
FitOptions options_of_window(FitOptions options, int later, double frame_time) {
  constexpr double kRounding = 0.999;
  if (later * frame_time > kRounding * kEnoughLater) return options;
  options.limb_smoothing_time = 0.0;
  options.smoothing_time *= std::min(1.0, (later + 1) * frame_time / kFullWindow);
  return options;
}

template <typename Value>
void erase_first(std::vector<Value>& values, std::size_t count) {
  values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
}

}  // namespace

LagFit::LagFit(const OnlineTargets& stage, double frame_time, int lag_frames)
    : stage_(stage),
      model_(stage.model()),
      options_(options_of_window(stage.options(), lag_frames, frame_time)),
      lag_frames_(lag_frames),
      kept_frames_(
          std::max(static_cast<int>(kKeptTime / frame_time), smoothing_context(frame_time) + 1)),
      feet_(stage.human()),
      pose_(model_.tree) {
  const int window = lag_frames + 1;
  steps_ = std::max(1, (options_.iterations + window - 1) / window);
  turn_ = (window + kMostAtATime - 1) / kMostAtATime;
  clip_.frame_time = frame_time;
  feet_.frame_time = frame_time;
  for (const FitFoot& foot : model_.feet) source_feet_.push_back(source_foot(foot));
  reserve();
  fit_ = make_moving_fit(model_, options_, clip_, smoothing_context(frame_time));
}

// Reserves memory for a stream of any length.
void LagFit::reserve() {
  const int frames = 2 * kept_frames_ + lag_frames_ + 2;
  const std::size_t feet = model_.feet.size(), bodies = model_.supports.size();
  clip_.targets.reserve(at(frames) * model_.tasks.size());
  clip_.qpos.reserve(at(frames) * at(model_.configuration_size));
  clip_.feet.reserve(frames, feet, bodies);
  const std::size_t phases = clip_.feet.phases.capacity();
  clip_.anchors.reserve(phases);
  old_phases_.reserve(phases);
  old_anchors_.reserve(phases);
  old_supports_.reserve(at(frames) * bodies);
  feet_.reserve(frames);
  planner_.reserve(frames);
}

void LagFit::restart() {
  const double frame_time = clip_.frame_time;
  feet_.forget(clip_.frame_count);
  clip_ = FitClip();
  clip_.frame_time = frame_time;
  sent_ = forgotten_ = wait_ = 0;
  finished_ = false;
  reserve();
  fit_ = make_moving_fit(model_, options_, clip_, smoothing_context(frame_time));
}

void LagFit::push(const HumanPose& world_from_bone, std::span<const Pose> world_from_target,
                  std::span<const double> qpos, const Eigen::Vector3d& path, double floor) {
  if (sent_ >= 2 * kept_frames_) forget_old_frames();
  if (clip_.frame_count == 0) floor_ = floor;
  append_targets(model_, world_from_target, path - Eigen::Vector3d(0.0, 0.0, floor_),
                 clip_.targets);
  feet_.add(world_from_bone);
  ++clip_.frame_count;
  lower_targets(floor);
  start_frame(qpos, path);
  plan_contacts();
  fit_->move(window_begin(), std::exchange(forgotten_, 0));
  if (++wait_ < turn_) return;
  wait_ = 0;
  take_steps(steps_);
}

void LagFit::finish() {
  finished_ = true;
  if (clip_.frame_count <= sent_) return;
  plan_contacts();
  fit_->move(window_begin(), std::exchange(forgotten_, 0));
  take_steps(options_.iterations);
}

void LagFit::take_steps(int count) {
  for (int i = 0; i < count; ++i) {
    if (!fit_->step()) ++failed_steps_;
  }
}

std::span<const double> LagFit::next() {
  return std::as_const(clip_).frame(sent_++, model_.configuration_size);
}

void LagFit::forget_old_frames() {
  const int count = sent_ - kept_frames_;
  erase_first(clip_.targets, at(count) * model_.tasks.size());
  erase_first(clip_.qpos, at(count) * at(model_.configuration_size));
  feet_.forget(count);
  erase_first(clip_.feet.supports, at(count * clip_.feet.support_count));
  for (PlantedPhase& phase : clip_.feet.phases) {
    phase.begin -= count;
    phase.end -= count;
  }
  clip_.frame_count -= count;
  sent_ -= count;
  forgotten_ += count;
}

// Shifts the targets of the window to a new floor height.
void LagFit::lower_targets(double floor) {
  const double lower = floor - std::exchange(floor_, floor);
  const std::size_t tasks = model_.tasks.size();
  for (std::size_t i = at(window_begin()) * tasks; i < clip_.targets.size(); ++i) {
    clip_.targets[i].position.z() -= lower;
  }
}

void LagFit::start_frame(std::span<const double> qpos, const Eigen::Vector3d& path) {
  clip_.qpos.insert(clip_.qpos.end(), qpos.begin(), qpos.end());
  const auto now = clip_.frame(clip_.frame_count - 1, model_.configuration_size);
  for (std::size_t k = 0; k < 3; ++k) now[k] += path[static_cast<int>(k)];
  now[2] -= floor_;
  if (!options_.floor) return;
  pose_.update(now);
  now[2] -= lowest_below_floor(model_, pose_);
}

void LagFit::plan_contacts() {
  if (model_.feet.empty()) return;
  ContactOptions options = contact_options(options_);
  options.goes_on = !finished_;
  const ContactPlan& contacts = planner_.plan(feet_, options);
  std::swap(old_phases_, clip_.feet.phases);
  std::swap(old_anchors_, clip_.anchors);
  std::swap(old_supports_, clip_.feet.supports);  // plan_feet clears them.
  plan_feet(feet_, contacts, options, source_feet_, stage_.foot_scale(), {}, clip_.feet);
  plan_supports(feet_, contacts, model_.supports, clip_.frame_count, stage_.foot_scale(),
                clip_.feet);
  keep_anchors();
}

// Gives each phase of the new contact plan the anchor of the old phase with the largest overlap.
void LagFit::keep_anchors() {
  clip_.anchors.clear();
  for (const PlantedPhase& phase : clip_.feet.phases) {
    int best = -1, longest = 0;
    for (std::size_t i = 0; i < old_phases_.size(); ++i) {
      const PlantedPhase& old = old_phases_[i];
      if (old.foot != phase.foot || old.foot_end != phase.foot_end) continue;
      if (old.support != phase.support) continue;
      const int shared = std::min(old.end, phase.end) - std::max(old.begin, phase.begin);
      if (shared <= longest) continue;
      longest = shared;
      best = static_cast<int>(i);
    }
    clip_.anchors.push_back(best >= 0 ? kept_anchor(best, phase) : place_of(phase));
  }
}

// The anchor of an old phase for the phase that replaces it. Slides are relative to the begin of a
// phase, which may differ, so the anchor is corrected for an equal position in the first common
// frame.
Eigen::Vector2d LagFit::kept_anchor(int old_index, const PlantedPhase& phase) const {
  const PlantedPhase& old = old_phases_[at(old_index)];
  const Eigen::Vector2d& anchor = old_anchors_[at(old_index)];
  if (phase.support < 0) return anchor;
  const int frame = std::max({old.first(), phase.first(), 0});
  if (frame >= std::min(old.last(), phase.last())) return anchor;
  const auto goal = at(frame * clip_.feet.support_count + phase.support);
  return anchor + old_supports_[goal].slide - clip_.feet.supports[goal].slide;
}

// The anchor of a new phase: the mean position of the foot end or body over the phase. If the phase
// begins before the window, the position in the phase's last frame before the window.
Eigen::Vector2d LagFit::place_of(const PlantedPhase& phase) {
  int begin = std::max(phase.first(), window_begin()), end = phase.last();
  if (phase.first() < window_begin()) {
    begin = std::min(phase.last(), window_begin()) - 1;
    end = begin + 1;
  }
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int frame = begin; frame < end; ++frame) {
    pose_.update(clip_.frame(frame, model_.configuration_size));
    sum += planted_place(model_, phase, pose_);
    if (phase.support < 0) continue;
    sum -= clip_.feet.supports_of(frame)[at(phase.support)].slide;
  }
  return sum / std::max(1, end - begin);
}

}  // namespace retarget
