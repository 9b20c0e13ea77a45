// The included robots, compared with their source files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "robot_kinematics.h"
#include "shipped_robots.h"
#include "support/shared_data.h"
#include "support/value_of.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using ::testing::DoubleNear;
using ::testing::ElementsAreArray;
using ::testing::Pointwise;

constexpr double kTolerance = 1e-12;
// MuJoCo's rotation from an axis to a nearly parallel one has fewer digits.
constexpr double kShapeTolerance = 1e-10;

struct FiguresCase {
  const char* robot;
  const char* folder;             // below reference/robots
  const char* model;              // in that folder
  const char* ranges;             // In that folder; the file whose ranges equal the model's.
  bool hands_are_others = false;  // The hand shapes are not those that were fitted.
  // Metres by which the maker's current soles, and foot boxes, are lower than those of the older
  // meshes.
  double lowered_soles = 0.0;
  std::set<std::string> other_shapes = {};  // Bodies whose shapes are not those that were fitted.
};

void PrintTo(const FiguresCase& figures, std::ostream* out) {
  *out << figures.robot;
}

// The model in MuJoCo, without elements that need files.
ModelPtr load_by_mujoco(const fs::path& path) {
  std::array<char, 1000> error{};
  mjSpec* spec = mj_parseXML(path.c_str(), nullptr, error.data(), static_cast<int>(error.size()));
  EXPECT_NE(spec, nullptr) << error.data();
  if (spec == nullptr) return nullptr;
  for (const mjtObj kind :
       {mjOBJ_SENSOR, mjOBJ_ACTUATOR, mjOBJ_EQUALITY, mjOBJ_KEY, mjOBJ_PAIR, mjOBJ_EXCLUDE,
        mjOBJ_GEOM, mjOBJ_SITE, mjOBJ_MESH, mjOBJ_MATERIAL, mjOBJ_TEXTURE}) {
    std::vector<mjsElement*> all;
    for (mjsElement* e = mjs_firstElement(spec, kind); e != nullptr; e = mjs_nextElement(spec, e)) {
      all.push_back(e);
    }
    for (mjsElement* element : all) mjs_delete(spec, element);
  }
  spec->compiler.boundmass = 1e-6;
  spec->compiler.boundinertia = 1e-9;
  ModelPtr model(mj_compile(spec, nullptr));
  EXPECT_NE(model, nullptr) << mjs_getError(spec);
  mj_deleteSpec(spec);
  return model;
}

// A shape as a list of numbers: its ends and radius, or its centre, axes and half size.
std::vector<double> figures_of(const CollisionShape& shape) {
  const Eigen::Vector3d up(0, 0, shape.half_length);
  const Pose& pose = shape.body_from_shape;
  std::vector<double> figures;
  const auto add = [&](const Eigen::Vector3d& v) {
    figures.insert(figures.end(), v.data(), v.data() + 3);
  };
  if (shape.type == CollisionShape::Type::kBox) {
    add(pose.translation);
    for (int i = 0; i < 3; ++i) add(pose.rotation.toRotationMatrix().col(i));
    add(shape.half_size);
  } else {
    // The order of the ends is irrelevant.
    add((pose * up).cwiseMin(pose * -up));
    add((pose * up).cwiseMax(pose * -up));
    figures.push_back(shape.radius);
  }
  return figures;
}

CollisionShape shape_from_json(const nlohmann::json& json) {
  const auto vector = [&](const char* key) {
    return Eigen::Vector3d(json.at(key)[0], json.at(key)[1], json.at(key)[2]);
  };
  CollisionShape shape;
  const std::string type = json.at("type");
  if (type == "sphere") {
    shape.body_from_shape.translation = vector("center");
    shape.radius = json.at("radius");
  } else if (type == "capsule") {
    shape.type = CollisionShape::Type::kCapsule;
    const Eigen::Vector3d from = vector("from"), to = vector("to");
    shape.body_from_shape = {
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), to - from), (from + to) / 2};
    shape.half_length = (to - from).norm() / 2;
    shape.radius = json.at("radius");
  } else {
    shape.type = CollisionShape::Type::kBox;
    const auto& q = json.at("quat_wxyz");
    shape.body_from_shape = {Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized(),
                             vector("center")};
    shape.half_size = vector("half_size");
  }
  return shape;
}

class RobotFigures : public testing::TestWithParam<FiguresCase> {
 protected:
  void SetUp() override {
    const auto shared = shared_folder();
    if (!shared) GTEST_SKIP() << kNoSharedFolder;
    folder_ = *shared / "reference" / "robots" / GetParam().folder;
    robot_ = load_shipped(GetParam().robot);
  }

  [[nodiscard]] std::shared_ptr<const Robot> reference(const char* file) const {
    return value_of(load_robot_files((folder_ / file).string()));
  }

  [[nodiscard]] nlohmann::json collision() const {
    std::ifstream file(folder_ / "collision.json");
    return nlohmann::json::parse(file);
  }

  fs::path folder_;
  std::shared_ptr<const Robot> robot_;
};

TEST_P(RobotFigures, TreeAndJointsMatchTheReference) {
  const auto reference = this->reference(GetParam().model);
  EXPECT_THAT(robot_->body_names(), ElementsAreArray(reference->body_names()));
  EXPECT_THAT(robot_->joint_names(), ElementsAreArray(reference->joint_names()));
  EXPECT_THAT(robot_->zero_configuration(), ElementsAreArray(reference->zero_configuration()));
  EXPECT_EQ(robot_->root_body(), reference->root_body());
  for (std::size_t b = 0; b < robot_->bodies().size(); ++b) {
    const RobotBody& ours = robot_->bodies()[b];
    const RobotBody& theirs = reference->bodies()[b];
    EXPECT_EQ(ours.parent, theirs.parent) << ours.name;
    EXPECT_EQ(ours.parent_from_body.translation, theirs.parent_from_body.translation) << ours.name;
    EXPECT_EQ(ours.parent_from_body.rotation.coeffs(), theirs.parent_from_body.rotation.coeffs())
        << ours.name;
  }
  for (std::size_t j = 0; j < robot_->joints().size(); ++j) {
    const RobotJoint& ours = robot_->joints()[j];
    const RobotJoint& theirs = reference->joints()[j];
    EXPECT_EQ(ours.type, theirs.type) << ours.name;
    EXPECT_EQ(ours.body, theirs.body) << ours.name;
    EXPECT_EQ(ours.axis, theirs.axis) << ours.name;
    EXPECT_EQ(ours.anchor, theirs.anchor) << ours.name;
    EXPECT_EQ(ours.reference, theirs.reference) << ours.name;
  }
}

TEST_P(RobotFigures, RangesMatchTheReference) {
  const auto reference = this->reference(GetParam().ranges);
  for (std::size_t j = 0; j < robot_->joints().size(); ++j) {
    const std::string& name = robot_->joints()[j].name;
    const auto theirs = reference->find_joint(name);
    ASSERT_TRUE(theirs.has_value()) << name;
    EXPECT_EQ(robot_->model_limits().lower[j], reference->model_limits().lower[*theirs]) << name;
    EXPECT_EQ(robot_->model_limits().upper[j], reference->model_limits().upper[*theirs]) << name;
  }
}

TEST_P(RobotFigures, MassesMatchTheReference) {
  const auto reference = this->reference(GetParam().model);
  const mjModel& ours = *robot_->model();
  const mjModel& theirs = *reference->model();
  for (int b = 0; b < ours.nbody; ++b) {
    const std::string& name = robot_->bodies()[b].name;
    EXPECT_EQ(ours.body_mass[b], theirs.body_mass[b]) << name;
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(ours.body_ipos[3 * b + i], theirs.body_ipos[3 * b + i]) << name;
      EXPECT_EQ(ours.body_inertia[3 * b + i], theirs.body_inertia[3 * b + i]) << name;
    }
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(ours.body_iquat[4 * b + i], theirs.body_iquat[4 * b + i]) << name;
    }
  }
}

TEST_P(RobotFigures, KinematicsMatchTheReference) {
  const ModelPtr reference = load_by_mujoco(folder_ / GetParam().model);
  ASSERT_NE(reference, nullptr);
  ASSERT_EQ(reference->nbody, static_cast<int>(robot_->bodies().size()));
  std::mt19937 random(29);
  double worst = 0.0;
  for (int i = 0; i < 100; ++i) {
    const std::vector<double> qpos = random_configuration(*robot_, random);
    const auto ours = own_kinematics(*robot_, qpos);
    const auto theirs = mujoco_kinematics(*reference, qpos);
    for (std::size_t b = 0; b < theirs.size(); ++b) {
      worst = std::max(worst, difference(ours[b], theirs[b]));
    }
  }
  EXPECT_LT(worst, kTolerance);
}

TEST_P(RobotFigures, ShapesMatchTheFit) {
  std::map<std::string, std::vector<CollisionShape>> shapes;
  for (const CollisionShape& shape : robot_->collision_shapes()) {
    shapes[robot_->bodies()[shape.body].name].push_back(shape);
  }
  std::size_t fitted = 0;
  const nlohmann::json json = collision();
  for (const auto& [body, primitives] : json.at("bodies").items()) {
    if (GetParam().hands_are_others && !robot_->find_body(body)) continue;
    if (GetParam().other_shapes.contains(body)) {
      fitted += shapes[body].size();
      continue;
    }
    fitted += primitives.size();
    const bool is_foot = json.at("soles").at("left").at("body") == body ||
                         json.at("soles").at("right").at("body") == body;
    ASSERT_GE(shapes[body].size(), primitives.size()) << body;
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      CollisionShape expected = shape_from_json(primitives[i]);
      if (is_foot && expected.type == CollisionShape::Type::kBox) {
        expected.body_from_shape.translation.z() -= 0.5 * GetParam().lowered_soles;
        expected.half_size.z() += 0.5 * GetParam().lowered_soles;
      }
      EXPECT_EQ(shapes[body][i].type, expected.type) << body;
      EXPECT_THAT(figures_of(shapes[body][i]),
                  Pointwise(DoubleNear(kShapeTolerance), figures_of(expected)))
          << body;
    }
  }
  if (!GetParam().hands_are_others) {
    EXPECT_EQ(robot_->collision_shapes().size(), fitted);
  }
}

TEST_P(RobotFigures, SolesAndContactsMatchTheFit) {
  const nlohmann::json json = collision();
  for (const Sole& sole : robot_->profile().soles) {
    const auto& expected = json.at("soles").at(sole.side);
    EXPECT_EQ(robot_->bodies()[sole.body].name, expected.at("body"));
    EXPECT_EQ(nlohmann::json(sole.labels), expected.at("labels"));
    ASSERT_EQ(sole.points.size(), expected.at("points").size());
    for (std::size_t i = 0; i < sole.points.size(); ++i) {
      const auto& point = expected.at("points")[i];
      const Eigen::Vector3d fitted(point[0], point[1], point[2]);
      EXPECT_LT(
          (sole.points[i] + GetParam().lowered_soles * Eigen::Vector3d::UnitZ() - fitted).norm(),
          1e-12);
    }
  }
  auto found = nlohmann::json::array();
  for (const auto& [a, b] : robot_->profile().allowed_self_contact) {
    found.push_back({robot_->bodies()[a].name, robot_->bodies()[b].name});
  }
  auto expected = nlohmann::json::array();
  for (const auto& pair : json.at("allowed_self_contact")) {
    if (robot_->find_body(pair[0].get<std::string>()) &&
        robot_->find_body(pair[1].get<std::string>())) {
      expected.push_back(pair);
    }
  }
  if (GetParam().hands_are_others) found.erase(found.begin() + expected.size(), found.end());
  EXPECT_EQ(found, expected);
}

constexpr const char* kG1 = "g1_29dof_rev_1_0.xml";
constexpr const char* kG1Mocap = "g1_mocap_29dof.xml";
constexpr const char* kG1Hands = "g1_mocap_29dof_with_hands.xml";

INSTANTIATE_TEST_SUITE_P(
    All, RobotFigures,
    testing::Values(
        FiguresCase{"unitree_g1", "unitree_g1", kG1Mocap, kG1},
        FiguresCase{"unitree_g1_with_hands", "unitree_g1", kG1Hands, kG1Hands, true},
        FiguresCase{"booster_t1_29dof", "booster_t1_29dof", "t1_mocap.xml", "t1_mocap.xml", false,
                    0.0123},
        FiguresCase{"fourier_n1", "fourier_n1", "n1_mocap.xml", "n1_mocap.xml"},
        FiguresCase{"stanford_toddy", "stanford_toddy", "toddy_mocap.xml", "toddy_mocap.xml"},
        FiguresCase{"engineai_pm01", "engineai_pm01", "pm_v2.xml", "pm_v2.xml"},
        FiguresCase{"unitree_h1", "unitree_h1", "h1.xml", "h1.xml"},
        FiguresCase{"unitree_h1_2", "unitree_h1_2", "h1_2_handless.xml", "h1_2_handless.xml"},
        FiguresCase{"booster_t1", "booster_t1", "t1_mocap.xml", "t1_mocap.xml", false, 0.0123},
        FiguresCase{"booster_k1", "booster_k1", "K1_serial.xml", "K1_serial.xml", false, 0.0111},
        FiguresCase{"hightorque_hi", "hightorque_hi", "hi_25dof.xml", "hi_25dof.xml"},
        FiguresCase{"kuavo_s45", "kuavo_s45", "biped_s45_collision.xml", "biped_s45_collision.xml"},
        FiguresCase{"pal_talos",
                    "pal_talos",
                    "talos.xml",
                    "talos.xml",
                    false,
                    0.0,
                    {"leg_left_3_link", "leg_right_3_link", "arm_left_7_link", "arm_right_7_link"}},
        FiguresCase{"pnd_adam_lite", "pnd_adam_lite", "adam_lite.xml", "adam_lite.xml"},
        FiguresCase{"tienkung", "tienkung", "tienkung.xml", "tienkung.xml"},
        FiguresCase{"berkeley_humanoid_lite", "berkeley_humanoid_lite",
                    "berkeley_humanoid_lite.xml", "berkeley_humanoid_lite.xml"}),
    [](const auto& figures) { return std::string(figures.param.robot); });

}  // namespace
}  // namespace retarget
