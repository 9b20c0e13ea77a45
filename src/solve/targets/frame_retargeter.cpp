#include "retarget/frame_retargeter.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/math/se3.h"
#include "base/try.h"
#include "solve/targets/frame_solver.h"
#include "solve/targets/targets.h"

namespace retarget {
namespace {

constexpr double kMinNorm = 1e-100;  // Smallest norm of a quaternion whose square does not
                                     // underflow.
constexpr int kRootRotation = 3;     // Index of the root's quaternion in a configuration.
constexpr double kFootHeight = 0.1;  // Height above the ground in the published method, metres.

bool is_foot(const std::string& name) {
  return name.find("foot") != std::string::npos || name.find("Foot") != std::string::npos;
}

Result<void> check_options(const FrameRetargeterOptions& options) {
  const double height = options.human_height.value_or(1.0);
  if (!std::isfinite(height) || height <= 0.0) {
    return usage_failure(
        fmt::format("the human's height must be more than 0 metres, found {}", height));
  }
  if (!std::isfinite(options.damping) || options.damping <= 0.0) {
    return usage_failure(fmt::format("the damping must be more than 0, found {}", options.damping));
  }
  if (options.max_extra_steps < 0 || options.max_extra_steps > kMaxExtraSteps) {
    return usage_failure(fmt::format("the number of extra steps must be from 0 to {}, found {}",
                                     kMaxExtraSteps, options.max_extra_steps));
  }
  return {};
}

IkOptions ik_options(const FrameRetargeterOptions& options) {
  IkOptions ik;
  ik.damping = options.damping;
  ik.max_extra_steps = options.max_extra_steps;
  return ik;
}

Result<void> check_pose(const Pose& pose, const std::string& body) {
  const double norm = pose.rotation.norm();
  if (!pose.translation.allFinite()) {
    return input_failure({}, fmt::format("the position of \"{}\" is not finite", body));
  }
  if (!std::isfinite(norm)) {
    return input_failure({}, fmt::format("the rotation of \"{}\" is not finite", body));
  }
  if (norm < kMinNorm) {
    return input_failure({}, fmt::format("the rotation of \"{}\" is a zero quaternion", body));
  }
  return {};
}

}  // namespace

class FrameRetargeter::Impl {
 public:
  Impl(std::shared_ptr<const Robot> robot, HumanConfig config, const LimitSet& limits,
       const FrameRetargeterOptions& options)
      : robot_(std::move(robot)),
        config_(std::move(config)),
        targets_(config_.tables,
                 options.human_height.value_or(config_.tables.human_height_assumption)),
        problem_(make_problem(robot_, config_.tables, targets_, limits)),
        solver_(problem_, options.engine, ik_options(options)),
        made_(static_cast<std::size_t>(targets_.target_count())),
        world_from_target_(made_.size()),
        qpos_(robot_->zero_configuration()),
        before_(qpos_),
        world_from_body_(robot_->bodies().size()) {
    for (const Bone bone : targets_.bones()) target_bodies_.push_back(static_cast<int>(bone));
  }

  [[nodiscard]] const Robot& robot() const { return *robot_; }
  [[nodiscard]] const std::vector<std::string>& human_bodies() const { return config_.bodies; }
  [[nodiscard]] const std::vector<int>& target_bodies() const { return target_bodies_; }
  [[nodiscard]] std::span<const double> qpos() const { return qpos_; }
  [[nodiscard]] std::span<const Pose> world_from_target() const {
    return std::span(world_from_target_).first(has_targets_ ? world_from_target_.size() : 0);
  }

  Result<void> update_targets(std::span<const Pose> world_from_body, const TargetShift& shift) {
    if (world_from_body.size() != config_.bodies.size()) {
      return usage_failure(fmt::format("expected poses of {} bodies, found {}",
                                       config_.bodies.size(), world_from_body.size()));
    }
    for (const int body : target_bodies_) {
      TRY(check_pose(world_from_body[body], config_.bodies[body]));
    }
    std::ranges::copy(world_from_body, human_.begin());
    targets_.build(human_, made_);
    for (Pose& pose : made_) pose.translation.z() -= shift.down;
    if (shift.to_ground) TRY(bring_to_ground());
    world_from_target_.swap(made_);
    has_targets_ = true;
    return {};
  }

  Result<void> solve() {
    TRY(check_targets());
    std::ranges::copy(qpos_, before_.begin());
    auto solved = solver_.solve(world_from_target_, qpos_, config_.tables.file);
    if (!solved) {
      std::ranges::copy(before_, qpos_.begin());
      return failure(std::move(solved.error()));
    }
    return {};
  }

  Result<void> set_qpos(std::span<const double> qpos) {
    if (qpos.size() != qpos_.size()) {
      return usage_failure(fmt::format("expected a configuration of {} values, found {}",
                                       qpos_.size(), qpos.size()));
    }
    if (!std::ranges::all_of(qpos, [](double value) { return std::isfinite(value); })) {
      return usage_failure("the configuration has values that are not finite");
    }
    const Eigen::Map<const Eigen::Vector4d> rotation(qpos.data() + kRootRotation);
    const double norm = rotation.norm();
    if (norm < kMinNorm || !std::isfinite(norm)) {
      return usage_failure("the root quaternion in the configuration is zero");
    }
    std::ranges::copy(qpos, qpos_.begin());
    // Does not normalise a quaternion of unit length, so that a result that is set as the start
    // stays bitwise the same.
    constexpr double kUnit = 1e-12;
    if (std::abs(norm - 1.0) > kUnit) {
      for (int i = 0; i < 4; ++i) qpos_[kRootRotation + i] /= norm;
    }
    return {};
  }

  Result<double> error(int table) {
    TRY(check_targets());
    const IkPass* const pass = pass_of(table);
    if (pass == nullptr) return usage_failure(fmt::format("table {} is not used", table));
    forward_kinematics(*robot_, qpos_, world_from_body_);
    double sum = 0.0;
    for (const FrameTask& task : *pass) {
      const Pose target_from_world = world_from_target_[task.target].inverse();
      sum += log_se3(target_from_world * world_from_body_[task.body]).squaredNorm();
    }
    return std::sqrt(sum);
  }

 private:
  Result<void> check_targets() const {
    if (has_targets_) return {};
    return usage_failure("no targets yet: call update_targets first");
  }

  Result<void> bring_to_ground() {
    double lowest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < made_.size(); ++i) {
      if (!is_foot(config_.bodies[target_bodies_[i]])) continue;
      lowest = std::min(lowest, made_[i].translation.z());
    }
    if (!std::isfinite(lowest)) {
      return input_failure({},
                           "cannot move the targets to the ground: no body of the tables has "
                           "\"foot\" or \"Foot\" in its name");
    }
    for (Pose& pose : made_) {
      pose.translation.z() = pose.translation.z() - lowest + kFootHeight;
    }
    return {};
  }

  [[nodiscard]] const IkPass* pass_of(int table) const {
    int pass = 0;
    for (int i = 1; i <= static_cast<int>(config_.tables.match_tables.size()); ++i) {
      const bool used = config_.tables.match_tables[i - 1].used;
      if (i == table) return used ? &problem_->passes[pass] : nullptr;
      pass += used ? 1 : 0;
    }
    return nullptr;
  }

  std::shared_ptr<const Robot> robot_;
  HumanConfig config_;
  TargetBuilder targets_;
  std::shared_ptr<const IkProblem> problem_;
  FrameSolver solver_;
  std::vector<int> target_bodies_;
  HumanPose human_;
  std::vector<Pose> made_, world_from_target_;
  bool has_targets_ = false;
  std::vector<double> qpos_, before_;
  std::vector<Pose> world_from_body_;  // Of the robot.
};

Result<FrameRetargeter> FrameRetargeter::make(std::shared_ptr<const Robot> robot,
                                              HumanConfig config, const LimitSet& limits,
                                              const FrameRetargeterOptions& options) {
  TRY(check_options(options));
  if (config.bodies.size() > kBoneCount) {
    return usage_failure(
        fmt::format("a human has at most {} bodies, found {}", kBoneCount, config.bodies.size()));
  }
  for (const Bone bone : TargetBuilder(config.tables, 1.0).bones()) {
    if (static_cast<std::size_t>(bone) < config.bodies.size()) continue;
    return usage_failure("the tables use more bodies than the human has names");
  }
  return FrameRetargeter(
      std::make_unique<Impl>(std::move(robot), std::move(config), limits, options));
}

FrameRetargeter::FrameRetargeter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FrameRetargeter::~FrameRetargeter() = default;
FrameRetargeter::FrameRetargeter(FrameRetargeter&&) noexcept = default;
FrameRetargeter& FrameRetargeter::operator=(FrameRetargeter&&) noexcept = default;

const Robot& FrameRetargeter::robot() const {
  return impl_->robot();
}
const std::vector<std::string>& FrameRetargeter::human_bodies() const {
  return impl_->human_bodies();
}
const std::vector<int>& FrameRetargeter::target_bodies() const {
  return impl_->target_bodies();
}
Result<void> FrameRetargeter::update_targets(std::span<const Pose> world_from_body,
                                             const TargetShift& shift) {
  return impl_->update_targets(world_from_body, shift);
}
std::span<const Pose> FrameRetargeter::world_from_target() const {
  return impl_->world_from_target();
}
Result<void> FrameRetargeter::solve() {
  return impl_->solve();
}
std::span<const double> FrameRetargeter::qpos() const {
  return impl_->qpos();
}
Result<void> FrameRetargeter::set_qpos(std::span<const double> qpos) {
  return impl_->set_qpos(qpos);
}
Result<double> FrameRetargeter::error(int table) {
  return impl_->error(table);
}

}  // namespace retarget
