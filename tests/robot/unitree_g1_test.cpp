// The mesh-free G1, compared with its source data.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <regex>
#include <sstream>

#include "retarget/load_robot.h"
#include "retarget/robot.h"
#include "robot_kinematics.h"
#include "support/shared_data.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAreArray;
using ::testing::IsEmpty;

constexpr double kModelTolerance = 1e-12;

std::string read_text(const fs::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

class UnitreeG1Test : public testing::Test {
 protected:
  void SetUp() override { ASSERT_NE(g1_, nullptr); }

  std::shared_ptr<const Robot> g1_ = load_g1();
};

TEST_F(UnitreeG1Test, TwentyNineJointsInPublishedOrder) {
  EXPECT_EQ(g1_->name(), "unitree_g1");
  EXPECT_EQ(g1_->bodies()[g1_->root_body()].name, "pelvis");
  EXPECT_EQ(g1_->output_joints().size(), 29U);
  // As in the published data: legs left and right, waist, arms left and right.
  const auto name = [&](int column) { return g1_->joints()[g1_->output_joints()[column]].name; };
  EXPECT_EQ(name(0), "left_hip_pitch_joint");
  EXPECT_EQ(name(6), "right_hip_pitch_joint");
  EXPECT_EQ(name(12), "waist_yaw_joint");
  EXPECT_EQ(name(15), "left_shoulder_pitch_joint");
  EXPECT_EQ(name(28), "right_wrist_yaw_joint");
  EXPECT_EQ(g1_->limits_for("gmr"), "gmr");
  EXPECT_EQ(g1_->limits_for("fit"), "official");
  EXPECT_THAT(g1_->warnings(), IsEmpty());
}

// The source files of the values.
class UnitreeG1FiguresTest : public UnitreeG1Test {
 protected:
  void SetUp() override {
    UnitreeG1Test::SetUp();
    const auto shared = shared_folder();
    if (!shared) GTEST_SKIP() << kNoSharedFolder;
    folder_ = *shared / "reference" / "robots" / "unitree_g1";
  }

  [[nodiscard]] std::shared_ptr<const Robot> reference(const std::string& name) const {
    return value_of(load_robot_files((folder_ / name).string()));
  }

  fs::path folder_;
};

TEST_F(UnitreeG1FiguresTest, KinematicsMatchBothReferences) {
  std::mt19937 random(29);
  for (const char* file : {"g1_mocap_29dof.xml", "g1_29dof_rev_1_0.xml"}) {
    const auto reference = this->reference(file);
    double worst = 0.0;
    for (int i = 0; i < 100; ++i) {
      const std::vector<double> qpos = random_configuration(*g1_, random);
      const auto ours = own_kinematics(*g1_, qpos);
      const auto theirs = mujoco_kinematics(*reference->model(), qpos);
      for (std::size_t b = 0; b < theirs.size(); ++b) {
        const auto body = g1_->find_body(reference->bodies()[b].name);
        ASSERT_TRUE(body.has_value()) << reference->bodies()[b].name;
        worst = std::max(worst, difference(ours[*body], theirs[b]));
      }
    }
    EXPECT_LT(worst, kModelTolerance) << file;
  }
}

TEST_F(UnitreeG1FiguresTest, LimitSetsMatchTheReferences) {
  const std::map<std::string, std::string> sources = {{"official", "g1_29dof_rev_1_0.xml"},
                                                      {"model", "g1_29dof_rev_1_0.xml"},
                                                      {"gmr", "g1_mocap_29dof.xml"}};
  for (const auto& [set, file] : sources) {
    const auto reference = this->reference(file);
    const auto limits = value_of(load_limits(*g1_, set));
    EXPECT_THAT(limits.lower, ElementsAreArray(reference->model_limits().lower)) << set;
    EXPECT_THAT(limits.upper, ElementsAreArray(reference->model_limits().upper)) << set;
  }
}

TEST_F(UnitreeG1FiguresTest, SpeedLimitsMatchTheUrdf) {
  const std::string urdf = read_text(folder_ / "g1_29dof_rev_1_0.urdf");
  const std::regex pattern(
      R"re(<joint\s+name="([^"]+)"\s+type="revolute">[\s\S]*?velocity="([^"]+)")re");
  std::map<std::string, double> speeds;
  for (auto match = std::sregex_iterator(urdf.begin(), urdf.end(), pattern);
       match != std::sregex_iterator(); ++match) {
    speeds[(*match)[1]] = std::stod((*match)[2]);
  }
  EXPECT_EQ(speeds.size(), 29U);
  EXPECT_EQ(g1_->profile().speed_limits, speeds);
}

}  // namespace
}  // namespace retarget
