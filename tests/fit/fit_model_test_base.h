#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <random>
#include <vector>

#include "retarget/human.h"
#include "retarget/options.h"
#include "retarget/so3.h"
#include "solve/fit/fit_model.h"
#include "solve/targets/targets.h"
#include "support/test_robots.h"

namespace retarget {

/// A configuration changed by a small step of its degrees of freedom.
inline std::vector<double> moved_by_step(const FitModel& model, std::vector<double> qpos,
                                         const std::vector<double>& step) {
  for (std::size_t k = 0; k < 3; ++k) qpos[k] += step[k];
  const Eigen::Quaterniond q = Eigen::Quaterniond(qpos[3], qpos[4], qpos[5], qpos[6]) *
                               exp_so3(Eigen::Vector3d(step[3], step[4], step[5]));
  qpos[3] = q.w();
  qpos[4] = q.x();
  qpos[5] = q.y();
  qpos[6] = q.z();
  for (std::size_t link = 1; link < model.tree.links().size(); ++link) {
    qpos[static_cast<std::size_t>(model.tree.links()[link].qpos_address)] += step[5 + link];
  }
  return qpos;
}

/// The fit's model of a G1 with the published configuration, and random configurations of it.
class FitModelTest : public testing::Test {
 protected:
  void SetUp() override {
    robot_ = load_g1();
    config_ = published_config(*robot_);
    const TargetBuilder targets(config_, 1.75);
    for (const Bone bone : kAllBones) target_of_bone_[bone] = targets.target_of(bone);
    use(FitOptions{});
  }

  void use(const FitOptions& options) {
    options_ = options;
    model_ = make_fit_model(*robot_, config_, robot_->model_limits(), target_of_bone_, options_);
    dofs_ = static_cast<std::size_t>(model_.dof_count());
  }

  std::vector<double> random_configuration(double spread, double height) {
    std::normal_distribution<double> normal;
    std::vector<double> step(dofs_);
    for (double& x : step) x = spread * normal(random_);
    std::vector<double> qpos = moved_by_step(model_, robot_->zero_configuration(), step);
    qpos[2] = height;
    return qpos;
  }

  std::mt19937 random_{7};
  std::shared_ptr<const Robot> robot_;
  ResolvedConfig config_;
  BoneArray<int> target_of_bone_;
  FitOptions options_;
  FitModel model_;
  std::size_t dofs_ = 0;
};

}  // namespace retarget
