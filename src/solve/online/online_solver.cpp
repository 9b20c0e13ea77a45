#include "retarget/online_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "retarget/try.h"
#include "solve/online/floor_and_feet.h"
#include "solve/online/lag_fit.h"

namespace retarget {

class OnlineSolver::Impl {
 public:
  Impl(std::unique_ptr<OnlineTargets> targets, const OnlineOptions& options)
      : options_(options),
        targets_(std::move(targets)),
        feet_(tracked_feet(targets_->model(), options.frame_time)),
        floor_(targets_->options(), options.frame_time),
        holder_(targets_->model(), targets_->options(), options.frame_time, feet_.size()),
        qpos_(robot().zero_configuration()) {
    if (!options.lag_s) return;
    const auto frames = static_cast<int>(std::lround(*options.lag_s / options.frame_time));
    lag_.emplace(*targets_, options.frame_time, frames);
  }

  Outcome push(const HumanPose& human);
  bool take_rest();
  void restart(bool from_several_starts);
  void reset() {
    restart(true);
    floor_.restart();
  }

  [[nodiscard]] std::span<const double> qpos() const { return qpos_; }
  [[nodiscard]] int window_frames() const { return lag_ ? lag_->lag_frames() + 1 : 0; }
  [[nodiscard]] int take_failed_steps() { return lag_ ? lag_->take_failed_steps() : 0; }
  [[nodiscard]] const Robot& robot() const { return targets_->robot(); }

 private:
  Outcome take_next();
  [[nodiscard]] double lowest_part(double path_height) const;
  [[nodiscard]] double root_height(double path_height) const;

  OnlineOptions options_;
  std::unique_ptr<OnlineTargets> targets_;
  std::vector<TrackedFoot> feet_;
  FloorFinder floor_;
  FootHolder holder_;
  std::optional<LagFit> lag_;
  std::vector<double> qpos_;
};

OnlineSolver::Outcome OnlineSolver::Impl::push(const HumanPose& human) {
  targets_->build(human);
  const Eigen::Vector3d path = targets_->path();
  for (TrackedFoot& foot : feet_) foot.add(human, targets_->world_from_target(), path);
  const double floor = lag_ || options_.floor
                           ? floor_.add(feet_, lowest_part(path.z()), root_height(path.z()))
                           : 0.0;
  if (!lag_ && options_.hold_feet) {
    holder_.hold(feet_, floor, path, targets_->world_from_target());
  }
  if (!targets_->solve()) return Outcome::kFailed;
  if (lag_) {
    lag_->push(human, targets_->world_from_target(), targets_->qpos(), path, floor);
    return take_next();
  }
  std::ranges::copy(targets_->qpos(), qpos_.begin());
  for (std::size_t k = 0; k < 3; ++k) qpos_[k] += path[static_cast<int>(k)];
  qpos_[2] -= floor;
  if (options_.floor && !robot().fixed_base()) holder_.stand(feet_, qpos_);
  return Outcome::kSolved;
}

// Height of the lowest target of a body that is not a foot.
double OnlineSolver::Impl::lowest_part(double path_height) const {
  double lowest = HUGE_VAL;
  for (const FitTask& task : targets_->model().tasks) {
    if (task.foot >= 0) continue;
    const Pose& target = targets_->world_from_target()[static_cast<std::size_t>(task.target)];
    lowest = std::min(lowest, target.translation.z() + path_height);
  }
  return lowest;
}

// Height of the target of the body nearest to the root of the tree.
double OnlineSolver::Impl::root_height(double path_height) const {
  const auto& tasks = targets_->model().tasks;
  if (tasks.empty()) return path_height;
  const auto root = std::ranges::min_element(tasks, {}, &FitTask::link);
  return targets_->world_from_target()[static_cast<std::size_t>(root->target)].translation.z() +
         path_height;
}

OnlineSolver::Outcome OnlineSolver::Impl::take_next() {
  if (!lag_->has_next()) return Outcome::kFilling;
  std::ranges::copy(lag_->next(), qpos_.begin());
  return Outcome::kSolved;
}

bool OnlineSolver::Impl::take_rest() {
  if (!lag_) return false;
  if (!lag_->is_finished()) lag_->finish();
  return take_next() == Outcome::kSolved;
}

void OnlineSolver::Impl::restart(bool from_several_starts) {
  if (from_several_starts) targets_->settle_next();
  for (TrackedFoot& foot : feet_) foot.restart();
  floor_.interrupt();
  holder_.restart();
  if (lag_) lag_->restart();
}

Result<OnlineSolver> OnlineSolver::make(const Plan& plan, const OnlineOptions& options) {
  RETARGET_TRY_ASSIGN(auto targets, OnlineTargets::make(plan));
  return OnlineSolver(std::make_unique<Impl>(std::move(targets), options));
}

OnlineSolver::OnlineSolver(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
OnlineSolver::~OnlineSolver() = default;
OnlineSolver::OnlineSolver(OnlineSolver&&) noexcept = default;
OnlineSolver& OnlineSolver::operator=(OnlineSolver&&) noexcept = default;

OnlineSolver::Outcome OnlineSolver::push(const HumanPose& world_from_bone) {
  return impl_->push(world_from_bone);
}
bool OnlineSolver::take_rest() {
  return impl_->take_rest();
}
std::span<const double> OnlineSolver::qpos() const {
  return impl_->qpos();
}
void OnlineSolver::restart(bool from_several_starts) {
  impl_->restart(from_several_starts);
}
void OnlineSolver::reset() {
  impl_->reset();
}
int OnlineSolver::window_frames() const {
  return impl_->window_frames();
}
int OnlineSolver::take_failed_steps() {
  return impl_->take_failed_steps();
}
const Robot& OnlineSolver::robot() const {
  return impl_->robot();
}

}  // namespace retarget
