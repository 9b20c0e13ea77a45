// The smoothness and speed terms of the steps between frames, also in scenes, against dense solutions of the same
// least-squares problems, on the G1 in random configurations.

#include "solve/fit/joint_speeds.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <random>
#include <span>
#include <string_view>
#include <vector>

#include "fit/fit_model_test_base.h"
#include "solve/fit/fit_scene.h"
#include "solve/fit/root_reference.h"

namespace retarget {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kTime = 0.013;  // Seconds; the time constant of all other joints.
constexpr double kLimbTime = 0.019;

// Contacts of a limb by frame, including its margin; empty: none.
using Contacts = std::vector<bool>;

// The matrix K of a smoothing: s minimises |v - s|^2 + s'K s.
MatrixXd first_differences(Index count, double time, double fps) {
  MatrixXd d = MatrixXd::Zero(count - 1, count);
  for (Index i = 0; i + 1 < count; ++i) {
    d(i, i) = -1.0;
    d(i, i + 1) = 1.0;
  }
  return std::pow(time * fps, 2) * d.transpose() * d;
}

MatrixXd limb_smoothing(Index count, double fps, const Contacts& contacts = {}) {
  const auto carries = [&](Index frame) {
    return !contacts.empty() && contacts[static_cast<std::size_t>(frame)];
  };
  MatrixXd k = MatrixXd::Zero(count, count);
  for (Index i = 1; i < count; ++i) {
    VectorXd row = VectorXd::Zero(count);
    if (carries(i)) {
      row.segment(i - 1, 2) << -1.0, 1.0;
      k += std::pow(kTime * fps, 2) * row * row.transpose();
    } else if (i > 1 && !carries(i - 1)) {
      row.segment(i - 2, 3) << 1.0, -2.0, 1.0;
      k += std::pow(kLimbTime * fps, 4) * row * row.transpose();
    }
  }
  return k;
}

// F - F (F + K)^-1 F: the smoothness term's matrix, without its weight, after s follows v.
MatrixXd remaining(const MatrixXd& k, const VectorXd& factors) {
  const MatrixXd f = factors.asDiagonal();
  return f - f * (f + k).inverse() * f;
}

class JointSpeedsTest : public FitModelTest {
 protected:
  // A clip of random configurations without contacts.
  void make_clip(int frames, double fps) {
    clip_ = {};
    clip_.frame_count = frames;
    clip_.frame_time = 1.0 / fps;
    std::normal_distribution<double> normal;
    for (int frame = 0; frame < frames; ++frame) {
      const std::vector<double> qpos = random_configuration(0.2, 0.8);
      clip_.qpos.insert(clip_.qpos.end(), qpos.begin(), qpos.end());
      for (std::size_t i = 0; i < model_.tasks.size(); ++i) {
        clip_.targets.push_back({0.3 * Vector3d(normal(random_), normal(random_), normal(random_)),
                                 Eigen::Quaterniond::Identity()});
      }
    }
    clip_.feet.foot_count = static_cast<int>(model_.feet.size());
    clip_.feet.ends.resize(2 * model_.feet.size() * static_cast<std::size_t>(frames));
    clip_.feet.support_count = static_cast<int>(model_.supports.size());
    clip_.feet.supports.resize(model_.supports.size() * static_cast<std::size_t>(frames));
  }

  [[nodiscard]] JointSpeeds speeds() const {
    JointSpeeds speeds(model_, options_, clip_);
    speeds.update(model_, clip_, 0, clip_.frame_count);
    return speeds;
  }

  [[nodiscard]] std::size_t dof_of(std::string_view joint) const {
    for (std::size_t link = 1; link < model_.tree.links().size(); ++link) {
      const int index = model_.tree.links()[link].joint;
      if (robot_->joints()[static_cast<std::size_t>(index)].name == joint) return 5 + link;
    }
    ADD_FAILURE() << joint;
    return 0;
  }

  // Steps of a degree of freedom after one of its values has changed; for the root's position
  // relative to the reference.
  [[nodiscard]] VectorXd steps_of(std::size_t dof, int changed = 0, double change = 0.0) const {
    const auto address =
        dof < 6 ? dof : static_cast<std::size_t>(model_.tree.links()[dof - 5].qpos_address);
    const RootReference reference(model_, clip_.frame_time);
    VectorXd v(clip_.frame_count - 1);
    for (int t = 0; t + 1 < clip_.frame_count; ++t) {
      const auto value = [&](int frame) {
        return clip_.frame(frame, model_.configuration_size)[address] +
               (frame == changed ? change : 0.0);
      };
      v[t] = value(t + 1) - value(t);
      if (dof < 3) v[t] -= reference.step(clip_, t)[static_cast<Index>(dof)];
    }
    return v;
  }

  // Factors of the scene by step.
  [[nodiscard]] VectorXd factors(std::size_t dof) const {
    VectorXd found = VectorXd::Ones(clip_.frame_count - 1);
    if (dof < 6 || clip_.scene == nullptr) return found;
    const std::vector<double>& frames = clip_.scene->joint_smoothness;
    for (Index i = 0; i < found.size(); ++i) {
      const auto frame = static_cast<std::size_t>(i);
      found[i] = std::max(frames[frame], frames[frame + 1]);
    }
    return found;
  }

  // Compares the forces on all steps of a joint with those of a dense solution.
  void expect_forces(std::size_t dof, const MatrixXd& k) const {
    const VectorXd wanted = std::pow(model_.smoothness[dof] / clip_.frame_time, 2) *
                            remaining(k, factors(dof)) * steps_of(dof);
    const JointSpeeds found = speeds();
    std::vector<StepTerm> terms(dofs_);
    for (int t = 0; t + 1 < clip_.frame_count; ++t) {
      found.terms(t, terms);
      EXPECT_NEAR(terms[dof].force, wanted[t], 1e-9 * wanted.norm()) << t;
    }
  }

  // Expects the diagonal matrix of all steps' weights to bound the term's matrix from above.
  void expect_bound(std::size_t dof, const MatrixXd& k) const {
    const MatrixXd curvature =
        std::pow(model_.smoothness[dof] / clip_.frame_time, 2) * remaining(k, factors(dof));
    const JointSpeeds found = speeds();
    std::vector<StepTerm> terms(dofs_);
    VectorXd weights(curvature.rows());
    for (int t = 0; t + 1 < clip_.frame_count; ++t) {
      found.terms(t, terms);
      weights[t] = terms[dof].weight;
    }
    const MatrixXd gap = MatrixXd(weights.asDiagonal()) - curvature;
    const double least = Eigen::SelfAdjointEigenSolver<MatrixXd>(gap).eigenvalues().minCoeff();
    EXPECT_GE(least, -1e-9 * weights.maxCoeff());
    // The bound is tight enough: steps must not be too short.
    EXPECT_LT(least, 0.15 * weights.maxCoeff());
  }

  FitClip clip_;
};

TEST_F(JointSpeedsTest, HeldJointsCostNothing) {
  make_clip(9, 60.0);
  const std::size_t dof = dof_of("left_elbow_joint");
  const auto costs = [&] {
    TermCosts sum{};
    const JointSpeeds found = speeds();
    for (int t = 0; t + 1 < clip_.frame_count; ++t) found.add_costs(t, sum);
    return sum;
  };
  const TermCosts all = costs();
  model_.lower[dof] = model_.upper[dof] = 0.0;
  clip_.hold = [](int, std::span<double>) {};
  const TermCosts others = costs();
  EXPECT_LT(others[kTermSmoothness], all[kTermSmoothness]);
  EXPECT_LT(others[kTermSpeed], all[kTermSpeed]);
  const JointSpeeds found = speeds();
  std::vector<StepTerm> terms(dofs_);
  for (int t = 0; t + 1 < clip_.frame_count; ++t) {
    found.terms(t, terms);
    EXPECT_EQ(terms[dof].weight, 0.0);
    EXPECT_EQ(terms[dof].force, 0.0);
  }
  // The costs of the others are those without the joint's movement.
  const auto address = static_cast<std::size_t>(model_.tree.links()[dof - 5].qpos_address);
  for (int t = 0; t < clip_.frame_count; ++t) {
    clip_.frame(t, model_.configuration_size)[address] = 0.0;
  }
  const TermCosts still = costs();
  EXPECT_DOUBLE_EQ(others[kTermSmoothness], still[kTermSmoothness]);
  EXPECT_DOUBLE_EQ(others[kTermSpeed], still[kTermSpeed]);
}

TEST_F(JointSpeedsTest, GradientMatchesTheCost) {
  make_clip(9, 60.0);
  constexpr int kFrame = 4;
  const Index count = clip_.frame_count - 1;
  const struct {
    std::size_t dof;
    MatrixXd k;
  } cases[] = {
      {2U, first_differences(count, kTime, 60.0)},
      {dof_of("waist_yaw_joint"), first_differences(count, kTime, 60.0)},
      {dof_of("left_elbow_joint"), limb_smoothing(count, 60.0)},
      {dof_of("right_knee_joint"), limb_smoothing(count, 60.0)},
  };
  const JointSpeeds found = speeds();
  for (const auto& [dof, k] : cases) {
    SCOPED_TRACE(dof);
    std::vector<StepTerm> terms(dofs_);
    found.terms(kFrame - 1, terms);
    double gradient = terms[dof].force;
    found.terms(kFrame, terms);
    gradient -= terms[dof].force;
    // The smoothed steps count as constant: the gradient of the minimised cost is the same.
    const auto total = [&](double change) {
      const VectorXd v = steps_of(dof, kFrame, change);
      const VectorXd s = (MatrixXd::Identity(count, count) + k).inverse() * v;
      const double weight = model_.smoothness[dof] / clip_.frame_time;
      double sum = weight * weight * ((v - s).squaredNorm() + s.dot(k * s));
      for (const double step : v) {
        const double soft = options_.soft_joint_speed * clip_.frame_time;
        const double excess = dof < 6 ? 0.0 : std::max(0.0, std::abs(step) - soft);
        sum += std::pow(options_.speed_weight * excess / clip_.frame_time, 2);
      }
      return sum;
    };
    constexpr double kStep = 1e-6;
    EXPECT_NEAR(0.25 * (total(kStep) - total(-kStep)) / kStep, gradient,
                1e-4 * std::abs(gradient) + 1e-3);
  }
}

TEST_F(JointSpeedsTest, HessianMajorisesTheCost) {
  FitOptions options;
  options.speed = false;
  use(options);
  for (const double fps : {24.0, 30.0, 120.0}) {
    SCOPED_TRACE(fps);
    make_clip(30, fps);
    const Index count = clip_.frame_count - 1;
    expect_bound(dof_of("waist_yaw_joint"), first_differences(count, kTime, fps));
    expect_bound(dof_of("left_elbow_joint"), limb_smoothing(count, fps));
    expect_bound(dof_of("right_knee_joint"), limb_smoothing(count, fps));
  }
}

// With weights above half of the bound, steps still converge; with smaller ones, slow displacements
// of the root take fewer of them.
TEST_F(JointSpeedsTest, RootIsOverRelaxed) {
  make_clip(30, 30.0);
  const Index count = clip_.frame_count - 1;
  const MatrixXd curvature = std::pow(model_.smoothness[2] / clip_.frame_time, 2) *
                             remaining(first_differences(count, kTime, 30.0), factors(2));
  const double largest =
      Eigen::SelfAdjointEigenSolver<MatrixXd>(curvature).eigenvalues().maxCoeff();
  const JointSpeeds found = speeds();
  std::vector<StepTerm> terms(dofs_);
  for (int t = 0; t < count; ++t) {
    found.terms(t, terms);
    EXPECT_GT(terms[2].weight, 0.55 * largest) << t;
    EXPECT_LT(terms[2].weight, 0.65 * largest) << t;
  }
}

TEST_F(JointSpeedsTest, LimbsInContactAreSmoothedByFirstDifferences) {
  FitOptions options;
  options.speed = false;
  use(options);
  make_clip(60, 30.0);
  const Index count = clip_.frame_count - 1;
  // The left hand is on the floor in frames 20 to 24, the right toe in frames 10 to 14.
  for (int frame = 0; frame < clip_.frame_count; ++frame) {
    for (std::size_t i = 0; i < model_.supports.size(); ++i) {
      if (kSupportBones[model_.supports[i].support] != Bone::kLeftHand) continue;
      auto& goal =
          clip_.feet.supports[static_cast<std::size_t>(frame) * model_.supports.size() + i];
      goal.phase = frame >= 20 && frame < 25 ? 0 : -1;
    }
    for (std::size_t i = 0; i < model_.feet.size(); ++i) {
      if (model_.feet[i].left) continue;
      auto& goal =
          clip_.feet.ends[2 * (static_cast<std::size_t>(frame) * model_.feet.size() + i) + kToeEnd];
      goal.phase = frame >= 10 && frame < 15 ? 1 : -1;
    }
  }
  Contacts arm(60, false), leg(60, false);
  // An arm also counts as in contact 0.3 s before and after.
  for (std::size_t frame = 11; frame < 34; ++frame) arm[frame] = true;
  for (std::size_t frame = 10; frame < 15; ++frame) leg[frame] = true;
  for (const char* joint : {"left_shoulder_pitch_joint", "left_wrist_yaw_joint"}) {
    SCOPED_TRACE(joint);
    const MatrixXd k = limb_smoothing(count, 30.0, arm);
    expect_forces(dof_of(joint), k);
    expect_bound(dof_of(joint), k);
  }
  expect_forces(dof_of("right_elbow_joint"), limb_smoothing(count, 30.0));
  expect_forces(dof_of("left_knee_joint"), limb_smoothing(count, 30.0));
  const MatrixXd k = limb_smoothing(count, 30.0, leg);
  expect_forces(dof_of("right_ankle_roll_joint"), k);
  expect_bound(dof_of("right_ankle_roll_joint"), k);
}

// Two contacts: the factor rises from 1 to 6, falls to 1, and rises again at the end.
TEST_F(JointSpeedsTest, JointsAreSmootherNearContactsWithAScene) {
  FitOptions options;
  options.speed = false;
  for (const double limb_time : {kLimbTime, 0.0}) {
    SCOPED_TRACE(limb_time);
    options.limb_smoothing_time = limb_time;
    use(options);
    make_clip(40, 30.0);
    auto scene = std::make_shared<FitScene>();
    scene->joint_smoothness.assign(40, 1.0);
    const auto set = [&](std::size_t frame, double factor) {
      scene->joint_smoothness[frame] = factor;
    };
    for (std::size_t frame = 10; frame < 16; ++frame) set(frame, 6.0);
    for (const std::size_t frame : {9U, 16U, 38U}) set(frame, 2.5);
    for (const std::size_t frame : {8U, 17U}) set(frame, 1.2);
    set(39, 6.0);
    clip_.scene = scene;
    const Index count = clip_.frame_count - 1;
    const VectorXd f = factors(dof_of("left_elbow_joint"));
    MatrixXd limb = MatrixXd::Zero(count, count), others = limb;
    for (Index i = 1; i < count; ++i) {
      VectorXd row = VectorXd::Zero(count);
      row.segment(i - 1, 2) << -1.0, 1.0;
      const MatrixXd first =
          std::min(f[i - 1], f[i]) * std::pow(kTime * 30.0, 2) * row * row.transpose();
      others += first;
      const bool near = f[i - 1] > 1.0 || f[i] > 1.0;
      if (near || limb_time == 0.0) {
        limb += first;
      } else if (i > 1 && f[i - 2] == 1.0) {
        row.setZero();
        row.segment(i - 2, 3) << 1.0, -2.0, 1.0;
        limb += std::pow(kLimbTime * 30.0, 4) * row * row.transpose();
      }
    }
    for (const char* joint : {"left_elbow_joint", "right_wrist_yaw_joint", "right_knee_joint"}) {
      SCOPED_TRACE(joint);
      expect_forces(dof_of(joint), limb);
      expect_bound(dof_of(joint), limb);
    }
    expect_forces(dof_of("waist_yaw_joint"), others);
    expect_bound(dof_of("waist_yaw_joint"), others);
    // The root has the usual smoothness.
    expect_forces(2, first_differences(count, kTime, 30.0));
  }
}

TEST_F(JointSpeedsTest, KeepTheStepsOfTargetsThatStay) {
  make_clip(12, 30.0);
  JointSpeeds kept(model_, options_, clip_, true);
  std::vector<StepTerm> terms(dofs_), wanted(dofs_);
  for (int i = 0; i < 2; ++i) {
    kept.update(model_, clip_, 0, clip_.frame_count);
    const JointSpeeds read_again = speeds();
    for (int t = 0; t + 1 < clip_.frame_count; ++t) {
      kept.terms(t, terms);
      read_again.terms(t, wanted);
      for (std::size_t dof = 0; dof < dofs_; ++dof) EXPECT_EQ(terms[dof].force, wanted[dof].force);
    }
    for (double& value : clip_.frame(5, model_.configuration_size)) value *= 0.5;
  }
}

}  // namespace
}  // namespace retarget
