// Gradients and Hessians of the terms of one frame against finite differences of their costs, on the
// G1 in random configurations.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>
#include <set>

#include "fit/fit_model_test_base.h"
#include "retarget/option_table.h"
#include "retarget/so3.h"
#include "scene/scene_world.h"
#include "solve/fit/clip_fitter.h"
#include "solve/fit/frame_terms.h"
#include "solve/fit/shorthand.h"
#include "solve/fit/task_terms.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

class FrameTermsTest : public FitModelTest {
 protected:
  // Goals at the positions of a configuration, then displaced.
  void set_goals(const std::vector<double>& qpos, double away) {
    TreeState pose(model_.tree);
    pose.update(qpos);
    std::normal_distribution<double> normal;
    const auto noise = [&] {
      return Vector3d(away * Vector3d(normal(random_), normal(random_), normal(random_)));
    };
    targets_.clear();
    for (const FitTask& task : model_.tasks) {
      const Pose& world = pose.world_from_link[static_cast<std::size_t>(task.link)];
      targets_.push_back({world * task.position + noise(), world.rotation * exp_so3(noise())});
    }
    ends_.assign(4, FootEndGoal{});
    anchors_.clear();
    ends_[0] = {0.13, 1.0, 0, true, 0.1};
    ends_[0].lift = 0.4;
    ends_[1] = {0.0, 1.0, 1, false, 0.0};
    ends_[2] = {0.05, 0.7, -1, false, 0.0};
    ends_[3] = {0.02, 2.0, -1, false, 0.0, 2, 0.1, {0.03, -0.02}};
    for (const std::size_t end : {0, 1, 3}) {
      const FitFoot& foot = model_.feet[end / 2];
      const Vector3d middle =
          pose.world_from_link[static_cast<std::size_t>(foot.link)] * foot.ends[end % 2].middle;
      anchors_.emplace_back(middle.head<2>() - ends_[end].slide + noise().head<2>());
    }
    upright_ = {0.6, 0.3};
    // Knees, elbows, hands and seat at their contact positions, some only nearly.
    supports_.assign(model_.supports.size(), {});
    for (std::size_t i = 0; i < model_.supports.size(); i += 2) {
      const SupportBody& body = model_.supports[i];
      supports_[i] = {static_cast<int>(anchors_.size()), noise().head<2>(), i % 4 == 0 ? 1.0 : 0.5};
      anchors_.emplace_back(
          (pose.world_from_link[static_cast<std::size_t>(body.link)] * body.middle).head<2>() -
          supports_[i].slide + noise().head<2>());
    }
    lying_ = {0.7, 0.0};
  }

  double assemble(const std::vector<double>& qpos) {
    FrameTerms terms(model_, options_);
    TreeState pose(model_.tree);
    pose.update(qpos);
    std::vector<std::uint32_t> pairs;
    terms.find_near_pairs(pose, 0.02, pairs);
    gradient_.assign(dofs_, 0.0);
    hessian_.assign(dofs_ * dofs_, 1e30);
    costs_ = {};
    terms.assemble(pose,
                   {targets_, ends_, upright_, anchors_, 1.0, supports_, lying_,
                    scene_ ? &*scene_ : nullptr, 0},
                   pairs, gradient_.data(), hessian_.data(), static_cast<int>(dofs_), costs_);
    return std::accumulate(costs_.begin(), costs_.end(), 0.0);
  }

  // Largest difference between the gradient and finite differences of the cost, relative to the
  // largest entry.
  double gradient_error(const std::vector<double>& qpos) {
    assemble(qpos);
    const std::vector<double> gradient = gradient_;
    constexpr double kStep = 1e-6;
    double largest = 0.0, error = 0.0;
    for (std::size_t i = 0; i < dofs_; ++i) {
      std::vector<double> step(dofs_, 0.0);
      step[i] = kStep;
      const double above = assemble(moved_by_step(model_, qpos, step));
      step[i] = -kStep;
      const double below = assemble(moved_by_step(model_, qpos, step));
      // The cost is the sum of squares, the gradient is that of half the sum.
      error = std::max(error, std::abs(0.25 * (above - below) / kStep - gradient[i]));
      largest = std::max(largest, std::abs(gradient[i]));
    }
    return error / largest;
  }

  std::vector<TaskTarget> targets_;
  std::vector<FootEndGoal> ends_;
  std::vector<double> upright_, lying_;
  std::vector<SupportGoal> supports_;
  std::vector<Eigen::Vector2d> anchors_;
  std::vector<double> gradient_, hessian_;
  std::optional<FitScene> scene_;
  TermCosts costs_{};
};

TEST_F(FrameTermsTest, FeetBelowTheirClearanceHaveALargerWeight) {
  FitOptions options;
  options.tracking = options.floor = options.contact = options.self_collision = false;
  use(options);
  const auto qpos = random_configuration(0.2, 0.75);
  set_goals(qpos, 0.0);
  const auto cost_with_feet_at = [&](double clearance) {
    for (FootEndGoal& end : ends_) end = {clearance, 1.0};
    assemble(qpos);
    return costs_[kTermFootHeight];
  };
  options.foot_height_far = options.foot_height_near;
  use(options);
  // With clearances far above and below all feet, the costs are those of two quadratic functions.
  const double above =
      cost_with_feet_at(-10.0) - 2.0 * cost_with_feet_at(-9.0) + cost_with_feet_at(-8.0);
  const double below =
      cost_with_feet_at(10.0) - 2.0 * cost_with_feet_at(9.0) + cost_with_feet_at(8.0);
  EXPECT_NEAR(below / above, square(options.foot_height_below), 1e-6);
}

TEST_F(FrameTermsTest, GradientMatchesTheCost) {
  FitOptions options;
  options.self_collision = false;
  use(options);
  std::set<int> seen;
  for (int round = 0; round < 12; ++round) {
    const auto qpos = random_configuration(0.4, round % 3 == 0 ? 0.2 : 0.75);
    set_goals(qpos, 0.05);
    EXPECT_LT(gradient_error(qpos), 1e-5) << round;
    for (int term = 0; term < kTermSelfCollision; ++term) {
      if (costs_[static_cast<std::size_t>(term)] > 0.0) seen.insert(term);
    }
  }
  // Every term was checked.
  EXPECT_EQ(seen.size(), static_cast<std::size_t>(kTermSelfCollision));
}

// A tilted box and a ball near the robot, and goals on both for every support body.
std::optional<FitScene> scene_around(const FitModel& model) {
  auto scene = std::make_shared<Scene>();
  SceneShape box, ball;
  box.half_size = {0.3, 0.2, 0.25};
  ball.type = SceneShape::Type::kSphere;
  ball.radius = 0.3;
  scene->bodies = {{"box", {box}, {exp_so3(Vector3d(0.2, 0.5, -0.3)), Vector3d(0.2, 0.1, 0.5)}},
                   {"ball", {ball}, {Eigen::Quaterniond::Identity(), Vector3d(-0.3, 0.0, 0.9)}}};
  SceneClip clip{scene, frame_rate_from_fps(30.0), 1, {}, {}};
  for (const SceneBody& body : scene->bodies) clip.world_from_body.push_back(body.world_from_body);
  auto world = make_scene_world(std::move(clip));
  if (!world) return std::nullopt;
  FitScene fit = make_fit_scene(model, *world, {}, {}, 1.0, 1.0 / 30.0, {});
  for (std::size_t support = 0; support < model.supports.size(); ++support) {
    const double share = support % 2 == 0 ? 1.0 : 0.4;
    fit.goals.push_back({static_cast<int>(support), static_cast<int>(support % 2),
                         Vector3d(0.1, 0.2, 0.6), Vector3d(0.6, 0.0, 0.8), 0.01, share});
    if (support % 2 == 0) fit.goals.back().facing = Vector3d(0.0, -0.8, 0.6);
  }
  fit.first_goal = {0, static_cast<std::uint32_t>(fit.goals.size())};
  return fit;
}

TEST_F(FrameTermsTest, GradientOfTheSceneMatchesTheCost) {
  FitOptions options;
  options.tracking = options.floor = options.foot_height = false;
  options.self_collision = false;
  options.scene_palm_weight = 30.0;
  use(options);
  scene_ = scene_around(model_);
  ASSERT_TRUE(scene_);
  int penetrations = 0;
  for (int round = 0; round < 8; ++round) {
    const auto qpos = random_configuration(0.3, 0.75);
    set_goals(qpos, 0.05);
    EXPECT_LT(gradient_error(qpos), 1e-5) << round;
    EXPECT_GT(costs_[kTermSceneContact], 0.0);
    if (costs_[kTermScene] > 0.0) ++penetrations;
  }
  EXPECT_GT(penetrations, 4);
}

TEST_F(FrameTermsTest, OverlapGradientMatchesTheCost) {
  FitOptions options;
  options.tracking = options.floor = options.contact = options.foot_height = false;
  use(options);
  int overlaps = 0;
  for (int round = 0; round < 12; ++round) {
    const auto qpos = random_configuration(0.35, 0.75);
    set_goals(qpos, 0.05);
    if (assemble(qpos) == 0.0) continue;
    ++overlaps;
    // Nearest points of boxes are found by iteration.
    EXPECT_LT(gradient_error(qpos), 1e-2) << round;
  }
  EXPECT_GT(overlaps, 3);
}

TEST_F(FrameTermsTest, HessianMatchesGradientDifferencesAtZeroResidual) {
  FitOptions options;
  options.floor = options.self_collision = options.foot_height = false;
  options.contact = true;
  use(options);
  const auto qpos = random_configuration(0.3, 1.5);
  set_goals(qpos, 0.0);
  // Height is excluded: it has no zero in this configuration.
  ends_[0].level = false;
  upright_ = {1.0, 1.0};
  options_.body_contact_height_weight = 0.0;
  assemble(qpos);
  const std::vector<double> hessian = hessian_;
  constexpr double kStep = 1e-6;
  for (std::size_t j = 0; j < dofs_; ++j) {
    std::vector<double> step(dofs_, 0.0);
    step[j] = kStep;
    assemble(moved_by_step(model_, qpos, step));
    for (std::size_t i = j; i < dofs_; ++i) {
      EXPECT_NEAR(gradient_[i] / kStep, hessian[i * dofs_ + j], 2.0) << i << " " << j;
    }
  }
}

TEST_F(FrameTermsTest, TermsCanBeDisabled) {
  const auto qpos = random_configuration(0.5, 0.2);
  FitOptions options;
  ASSERT_TRUE(set_terms(
      options,
      std::vector<std::string>{"tracking", "floor", "contact", "self-collision", "foot-height"},
      false));
  use(options);
  set_goals(qpos, 0.05);
  EXPECT_EQ(assemble(qpos), 0.0);
}

TEST_F(FrameTermsTest, ALyingFootRestsOnTheSurfaceBelowIt) {
  FitOptions options;
  options.floor = options.self_collision = options.foot_height = false;
  options.contact = true;
  use(options);
  auto qpos = random_configuration(0.3, 1.5);
  set_goals(qpos, 0.0);
  supports_.assign(supports_.size(), {});
  ends_[0].level = false;
  upright_ = {0.0, 1.0};
  const auto height_cost = [&](double support) {
    for (FootEndGoal& end : ends_) end.support = support;
    assemble(qpos);
    return costs_[kTermContactHeight];
  };
  const double on_floor = height_cost(0.0);
  EXPECT_GT(on_floor, 0.0);
  qpos[2] += 0.4;
  EXPECT_NEAR(height_cost(0.4), on_floor, 1e-9 * on_floor);
}

TEST_F(FrameTermsTest, PosesMatchTheRobot) {
  for (int round = 0; round < 5; ++round) {
    const auto qpos = random_configuration(0.8, 1.0);
    TreeState pose(model_.tree);
    pose.update(qpos);
    std::vector<Pose> bodies(robot_->bodies().size());
    forward_kinematics(*robot_, qpos, bodies);
    for (const FitTask& task : model_.tasks) {
      const Pose& world = pose.world_from_link[static_cast<std::size_t>(task.link)];
      const Pose& body = bodies[static_cast<std::size_t>(robot_->find_body(task.body).value())];
      EXPECT_LT((world * task.position - body.translation).norm(), 1e-12);
      EXPECT_LT(log_so3(world.rotation * task.link_from_body * body.rotation.conjugate()).norm(),
                1e-12);
    }
  }
}

TEST_F(FrameTermsTest, LimitMarginGradientMatchesTheCost) {
  const std::size_t joint = 12;
  const auto address = static_cast<std::size_t>(model_.tree.links()[joint - 5].qpos_address);
  const double lower = model_.lower[joint], range = model_.upper[joint] - lower;
  std::vector<double> qpos = robot_->zero_configuration();
  const auto terms_at = [&](double value, double& gradient, double& curvature) {
    qpos[address] = value;
    std::vector<double> g(dofs_), h(dofs_ * dofs_);
    TermCosts costs{};
    add_limit_margins(model_, options_, qpos, g.data(), h.data(), static_cast<int>(dofs_), costs);
    gradient = g[joint];
    curvature = h[joint * (dofs_ + 1)];
    return costs[kTermLimits];
  };
  double gradient = 0.0, curvature = 0.0, unused = 0.0;
  const double elsewhere = terms_at(lower + 0.5 * range, gradient, curvature);
  EXPECT_EQ(gradient, 0.0);
  EXPECT_EQ(terms_at(lower + 0.031 * range, gradient, curvature), elsewhere);
  const double weight = options_.limit_margin_weight;
  EXPECT_NEAR(terms_at(lower, gradient, curvature) - elsewhere, weight * weight / 2.0, 1e-9);
  constexpr double kStep = 1e-6;
  for (const double share : {0.001, 0.01, 0.028, 0.972, 0.99, 0.999}) {
    SCOPED_TRACE(share);
    const double value = lower + share * range;
    const double more = terms_at(value + kStep, unused, unused);
    const double less = terms_at(value - kStep, unused, unused);
    const double here = terms_at(value, gradient, curvature);
    EXPECT_NEAR(gradient, 0.25 * (more - less) / kStep, 1e-5 * std::abs(gradient) + 1e-6);
    EXPECT_GT(share < 0.5 ? -gradient : gradient, 0.0);
    // The curvature bounds that of the cost.
    EXPECT_GE(curvature, 0.5 * (more - 2.0 * here + less) / (kStep * kStep) - 1.0);
  }
  // The margin is narrow and stiff: a pull that moves a joint to 2 % of its range does not move it
  // to the stop.
  double near_edge = 0.0, near_stop = 0.0;
  (void)terms_at(lower + 0.02 * range, near_edge, curvature);
  (void)terms_at(lower + 0.01 * range, near_stop, curvature);
  EXPECT_NEAR(near_stop / near_edge, 4.0, 1e-9);
}

TEST_F(FrameTermsTest, CostsWithoutHessianEqualThoseOfTheAssembly) {
  const std::vector<double> qpos = random_configuration(0.4, 0.8);
  set_goals(qpos, 0.05);
  ASSERT_GT(assemble(qpos), 0.0);
  FrameTerms terms(model_, options_);
  TreeState pose(model_.tree);
  pose.update(qpos);
  std::vector<std::uint32_t> pairs;
  terms.find_near_pairs(pose, 0.02, pairs);
  TermCosts costs{};
  terms.add_costs(
      pose,
      {targets_, ends_, upright_, anchors_, 1.0, supports_, lying_, scene_ ? &*scene_ : nullptr, 0},
      pairs, costs);
  EXPECT_EQ(costs, costs_);
}

}  // namespace
}  // namespace retarget
