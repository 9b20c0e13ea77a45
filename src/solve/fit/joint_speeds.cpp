#include "solve/fit/joint_speeds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "retarget/kinematic_tree.h"
#include "retarget/so3.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

// Share of a speed limit at which the speed term sets in. Motions then rarely reach the limit.
constexpr double kLimitShare = 0.9;
// Factor for the smoothness weight of the root's position if there is no RootReference: the term
// then penalises the accelerations themselves.
constexpr double kWithoutReference = 0.4;
// Divisor of the upper bound of the root position's term (over-relaxation). With the bound itself,
// ten steps move the root by only a part of a slow displacement, such as a crouch. With any divisor
// below 2, every step still lowers the quadratic model of the cost.
constexpr double kRootRelaxation = 1.7;
// Seconds before and after a contact of an arm in which it counts as in contact. A hand that
// approaches the floor with changing acceleration moves the whole body.
constexpr double kArmMargin = 0.3;

// Largest eigenvalue of K (1 + K)^-1 if that of K is `largest`.
double majorant(double largest) {
  return largest / (1.0 + largest);
}

// The change from one configuration to the next, by degree of freedom: root translation in metres,
// rotation vector in the root's axes, joint positions.
void configuration_step(const FitModel& model, std::span<const double> from,
                        std::span<const double> to, double* step) {
  for (std::size_t k = 0; k < 3; ++k) step[k] = to[k] - from[k];
  const Eigen::Quaterniond a(from[3], from[4], from[5], from[6]), b(to[3], to[4], to[5], to[6]);
  const Eigen::Vector3d turn = log_so3(a.conjugate() * b);
  for (int k = 0; k < 3; ++k) step[3 + k] = turn[k];
  for (std::size_t link = 1; link < model.tree.links().size(); ++link) {
    const auto address = static_cast<std::size_t>(model.tree.links()[link].qpos_address);
    step[KinematicTree::kBaseDofs - 1 + link] = to[address] - from[address];
  }
}

}  // namespace

JointSpeeds::JointSpeeds(const FitModel& model, const FitOptions& options, const FitClip& clip,
                         bool targets_stay)
    : root_(model, clip.frame_time),
      targets_stay_(targets_stay),
      root_share_(root_.exists() ? options.smoothness_root_reference : 0.0),
      speed_weight_(options.speed ? square(options.speed_weight / clip.frame_time) : 0.0),
      smoothing_(square(options.smoothing_time / clip.frame_time)),
      stiffness_(majorant(4.0 * smoothing_)),
      root_stiffness_(stiffness_ / kRootRelaxation),
      limb_smoothing_(square(square(options.limb_smoothing_time / clip.frame_time))) {
  for (std::size_t i = 0; i < model.smoothness.size(); ++i) {
    const double share = i < 3 && !root_.exists() ? kWithoutReference : 1.0;
    const double weight = share * model.smoothness[i] / clip.frame_time;
    smooth_weight_.push_back(options.smoothness ? square(weight) : 0.0);
    const bool hinge = i >= KinematicTree::kBaseDofs &&
                       !model.tree.links()[i - KinematicTree::kBaseDofs + 1].slides;
    const double own = kLimitShare * model.speed_limit[i];
    const double soft = hinge ? std::min(own, options.soft_joint_speed) : own;
    soft_step_.push_back(soft * clip.frame_time);
    if (hinge)
      soft_step_.back() = std::min(soft_step_.back(), kLimitShare * options.max_joint_step);
    // No step of the fit reduces the costs of held joints.
    if (clip.hold && model.lower[i] == model.upper[i]) {
      smooth_weight_.back() = 0.0;
      soft_step_.back() = std::numeric_limits<double>::infinity();
    }
  }
  const bool second_order = limb_smoothing_ > 0.0;
  if (!second_order && clip.scene == nullptr) return;
  for (const FitLimb& limb : find_limbs(model)) {
    limbs_.push_back(limb_of(model, limb, clip.frame_time));
    limbs_.back().second_order = second_order;
  }
  if (clip.scene != nullptr) add_joints_of_no_limb(model);
}

void JointSpeeds::add_joints_of_no_limb(const FitModel& model) {
  Limb others;
  for (std::size_t link = 1; link < model.tree.links().size(); ++link) {
    const int dof = KinematicTree::dof_of(static_cast<int>(link));
    const bool in_limb = std::ranges::any_of(limbs_, [dof](const Limb& limb) {
      return std::ranges::find(limb.dofs, dof) != limb.dofs.end();
    });
    if (!in_limb) others.dofs.push_back(dof);
  }
  limbs_.push_back(std::move(others));
}

JointSpeeds::Limb JointSpeeds::limb_of(const FitModel& model, const FitLimb& limb,
                                       double frame_time) {
  Limb found;
  for (const int link : limb.links) found.dofs.push_back(KinematicTree::dof_of(link));
  for (std::size_t i = 0; i < model.feet.size(); ++i) {
    if (model.tree.carries(limb.link, model.feet[i].link)) found.feet.push_back(i);
  }
  for (std::size_t i = 0; i < model.supports.size(); ++i) {
    if (model.tree.carries(limb.link, model.supports[i].link)) found.supports.push_back(i);
  }
  found.margin = limb.is_arm ? static_cast<int>(std::lround(kArmMargin / frame_time)) : 0;
  return found;
}

void JointSpeeds::update(const FitModel& model, const FitClip& clip, int first, int last) {
  first_ = first;
  const int count = last - 1 - first;
  if (count < 1) return;
  const std::size_t dofs = smooth_weight_.size();
  steps_.resize(static_cast<std::size_t>(count) * dofs);
  smooth_.resize(steps_.size());
  factors_.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    configuration_step(model, clip.frame(first + i, model.configuration_size),
                       clip.frame(first + i + 1, model.configuration_size),
                       steps_.data() + static_cast<std::size_t>(i) * dofs);
  }
  if (root_share_ > 0.0) subtract_root_reference(clip, count);
  // The tridiagonal matrix is the same for every degree of freedom.
  for (int i = 0; i < count; ++i) {
    const double diagonal = 1.0 + smoothing_ * ((i > 0 ? 1 : 0) + (i < count - 1 ? 1 : 0));
    const double before = i > 0 ? factors_[static_cast<std::size_t>(i) - 1] : 0.0;
    const double inverse = 1.0 / (diagonal + smoothing_ * before);
    factors_[static_cast<std::size_t>(i)] = -smoothing_ * inverse;
    double* const s = smooth_.data() + static_cast<std::size_t>(i) * dofs;
    const double* const v = steps_.data() + static_cast<std::size_t>(i) * dofs;
    for (std::size_t j = 0; j < dofs; ++j) {
      s[j] = (v[j] + (i > 0 ? smoothing_ * *(s + j - dofs) : 0.0)) * inverse;
    }
  }
  for (int i = count - 2; i >= 0; --i) {
    double* const s = smooth_.data() + static_cast<std::size_t>(i) * dofs;
    const double factor = factors_[static_cast<std::size_t>(i)];
    for (std::size_t j = 0; j < dofs; ++j) s[j] -= factor * s[j + dofs];
  }
  if (clip.scene != nullptr) update_factors(*clip.scene, count);
  for (Limb& limb : limbs_) smooth(limb, clip, count);
}

void JointSpeeds::subtract_root_reference(const FitClip& clip, int count) {
  if (!targets_stay_ || root_steps_.empty()) {
    root_steps_.clear();
    for (int i = 0; i < count; ++i) root_steps_.push_back(root_.step(clip, first_ + i));
  }
  for (std::size_t i = 0; i < root_steps_.size(); ++i) {
    Eigen::Map<Eigen::Vector3d>(steps_.data() + i * smooth_weight_.size()) -=
        root_share_ * root_steps_[i];
  }
}

bool JointSpeeds::touches(const Limb& limb, const FitClip& clip, int frame) {
  const auto ends = clip.feet.ends_of(frame);
  for (const std::size_t foot : limb.feet) {
    if (2 * foot + 1 >= ends.size()) continue;
    if (ends[2 * foot + kHeelEnd].phase >= 0 || ends[2 * foot + kToeEnd].phase >= 0) return true;
  }
  const auto goals = clip.feet.supports_of(frame);
  return std::ranges::any_of(limb.supports, [&](std::size_t support) {
    return support < goals.size() && goals[support].phase >= 0;
  });
}

void JointSpeeds::update_factors(const FitScene& scene, int count) {
  const std::size_t dofs = smooth_weight_.size();
  scene_factors_.resize(at(count));
  factored_steps_ = steps_;
  for (int i = 0; i < count; ++i) {
    scene_factors_[at(i)] = std::max(scene.joint_smoothness[at(first_ + i)],
                                     scene.joint_smoothness[at(first_ + i + 1)]);
    for (std::size_t j = 0; j < dofs; ++j) factored_steps_[at(i) * dofs + j] *= factor(i);
  }
}

void JointSpeeds::add_differences(const Limb& limb, const FitClip& clip, int count) {
  bool was_in_contact = false;
  // The next frame to look at, and the last one that touches.
  int next = std::max(0, first_ + 1 - limb.margin), last_touch = next - limb.margin - 1;
  // The difference of steps i - 1 and i is the acceleration in this frame.
  for (int i = 1; i < count; ++i) {
    const int frame = first_ + i;
    for (; next < clip.frame_count && next <= frame + limb.margin; ++next) {
      if (touches(limb, clip, next)) last_touch = next;
    }
    const auto [least, most] = std::minmax({factor(i - 1), factor(i)});
    const bool in_contact = !limb.second_order || last_touch >= frame - limb.margin || most > 1.0;
    if (in_contact) {
      smoothness_.add_difference(at(i - 1), least * smoothing_);
    } else if (i > 1 && !was_in_contact) {
      smoothness_.add_second_difference(at(i - 2), limb_smoothing_);
    }
    was_in_contact = in_contact;
  }
}

void JointSpeeds::smooth(Limb& limb, const FitClip& clip, int count) {
  smoothness_.begin(at(count));
  add_differences(limb, clip, count);
  limb.stiffness.resize(at(count));
  for (int i = 0; i < count; ++i) {
    limb.stiffness[at(i)] = factor(i) * majorant(smoothness_.absolute_row_sum(at(i)) / factor(i));
  }
  for (int i = 0; i < count; ++i) smoothness_.add_value(at(i), factor(i));
  smoothness_.factorise();
  const std::vector<double>& right = scene_factors_.empty() ? steps_ : factored_steps_;
  smoothness_.solve(right.data(), smooth_.data(), smooth_weight_.size(), limb.dofs);
}

void JointSpeeds::terms(int frame, std::span<StepTerm> terms) const {
  const double *v = row(steps_, frame), *s = row(smooth_, frame);
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const double stiffness = i < 3 ? root_stiffness_ : stiffness_;
    terms[i] = {stiffness * smooth_weight_[i], smooth_weight_[i] * (v[i] - s[i])};
  }
  for (const Limb& limb : limbs_) {
    const double stiffness = limb.stiffness[at(frame - first_)];
    for (const int dof : limb.dofs) terms[at(dof)].weight = stiffness * smooth_weight_[at(dof)];
  }
  if (!scene_factors_.empty()) {
    for (StepTerm& joint : terms.subspan(KinematicTree::kBaseDofs)) {
      joint.force *= factor(frame - first_);
    }
  }
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const double soft = soft_step_[i];
    if (std::abs(v[i]) <= soft) continue;
    terms[i].weight += speed_weight_;
    terms[i].force += speed_weight_ * (v[i] > 0.0 ? v[i] - soft : v[i] + soft);
  }
}

void JointSpeeds::add_costs(int frame, TermCosts& costs) const {
  const double *v = row(steps_, frame), *s = row(smooth_, frame);
  for (std::size_t i = 0; i < smooth_weight_.size(); ++i) {
    const double weight =
        smooth_weight_[i] * (i < KinematicTree::kBaseDofs ? 1.0 : factor(frame - first_));
    costs[kTermSmoothness] += weight * square(v[i] - s[i]);
    costs[kTermSpeed] += speed_weight_ * square(std::max(0.0, std::abs(v[i]) - soft_step_[i]));
  }
}

}  // namespace retarget
