#include "solve/fit/held_limits.h"

#include <algorithm>

#include "retarget/kinematic_tree.h"
#include "solve/fit/shorthand.h"

namespace retarget {

HeldLimits::HeldLimits(const FitModel& model, std::size_t frames)
    : model_(model),
      dofs_(model.dof_count()),
      sides_(frames * at(model.dof_count()), BoundSide::kFree) {
  if (!model.base_is_held) return;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    for (int i = 0; i < KinematicTree::kBaseDofs; ++i) {
      sides_[frame * at(dofs_) + at(i)] = BoundSide::kLower;
    }
  }
}

void HeldLimits::clamp(int frame, int dof, double& value) {
  sides_[index(frame, dof)] = clamp_to_bounds(value, model_.lower[at(dof)], model_.upper[at(dof)]);
}

void HeldLimits::move(std::size_t dropped, std::size_t frames) {
  sides_.erase(sides_.begin(), sides_.begin() + static_cast<std::ptrdiff_t>(dropped * at(dofs_)));
  sides_.resize(frames * at(dofs_), BoundSide::kFree);
  constexpr std::size_t kUsual = 8;  // Held variables per frame for which there is room.
  rows_.reserve(kUsual * frames);
  entries_.reserve(kUsual * frames * at(dofs_));
}

void HeldLimits::begin_step() {
  rows_.clear();
  entries_.clear();
}

void HeldLimits::hold(int frame, double* hessian, double* gradient, int stride, double* coupling,
                      std::span<const StepTerm> before, std::span<const StepTerm> after) {
  for (int i = model_.base_is_held ? 0 : KinematicTree::kBaseDofs; i < dofs_; ++i) {
    if (!before.empty() && is_held(frame - 1, i)) coupling[i] = 0.0;
    if (!is_held(frame, i)) continue;
    Row row{frame, i, gradient[i], 0.0, 0.0};
    for (int j = 0; j < dofs_; ++j) {
      entries_.push_back(
          hessian[static_cast<std::ptrdiff_t>(std::max(i, j)) * stride + std::min(i, j)]);
    }
    row.before = before.empty() ? 0.0 : -before[at(i)].weight;
    row.after = after.empty() ? 0.0 : -after[at(i)].weight;
    rows_.push_back(row);
    double* const own = hessian + static_cast<std::ptrdiff_t>(i) * stride;
    std::fill_n(own, i, 0.0);
    for (int j = i + 1; j < dofs_; ++j) hessian[static_cast<std::ptrdiff_t>(j) * stride + i] = 0.0;
    own[i] = 1.0;
    gradient[i] = coupling[i] = 0.0;
  }
}

void HeldLimits::release(const BlockChain& chain) {
  const double* of_row = entries_.data();
  for (const Row& row : rows_) {
    const auto x = chain.solution(row.frame);
    double force = row.gradient;
    for (int j = 0; j < dofs_; ++j) force += *of_row++ * x[at(j)];
    if (row.before != 0.0) force += row.before * chain.solution(row.frame - 1)[at(row.dof)];
    if (row.after != 0.0) force += row.after * chain.solution(row.frame + 1)[at(row.dof)];
    BoundSide& side = sides_[index(row.frame, row.dof)];
    const bool fixed = model_.lower[at(row.dof)] == model_.upper[at(row.dof)];
    if (inward_pull(side, force) > 0.0 && !fixed) side = BoundSide::kFree;
  }
}

}  // namespace retarget
