// Compares a robot with another model of the same robot, such as a newer file of its manufacturer.

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "retarget/load_robot.h"
#include "retarget/make_robot.h"
#include "retarget/robot.h"
#include "retarget/so3.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "robot/model/model_values.h"
#include "solve/robot_setup/import_robot.h"

namespace retarget {
namespace {

// Joints or bodies that both models have: pairs of an index in the robot and one in the other
// model.
using Shared = std::vector<std::pair<int, int>>;

// Collects deviations; keeps those above a threshold.
class Deviations {
 public:
  explicit Deviations(double least) : least_(least) {}
  void add(double amount, const std::string& where) {
    if (!(amount > least_)) return;
    places_.emplace_back(amount, where);
  }
  [[nodiscard]] bool any() const { return !places_.empty(); }
  [[nodiscard]] std::string text(const std::string& what, double scale, const char* unit,
                                 int digits) {
    std::ranges::stable_sort(places_, std::ranges::greater(),
                             &std::pair<double, std::string>::first);
    std::vector<std::string> worst;
    for (const auto& [amount, where] : places_) {
      worst.push_back(fmt::format("{} {} {}", where, number_text(scale * amount, digits), unit));
    }
    return what + ": " + list_names(worst, 6);
  }

 private:
  double least_;
  std::vector<std::pair<double, std::string>> places_;
};

class RobotComparison {
 public:
  RobotComparison(const Robot& robot, const Robot& other) : robot_(robot), other_(other) {
    for (int j = 0; j < static_cast<int>(robot.joints().size()); ++j) {
      if (const auto same = other.find_joint(robot.joints()[j].name))
        joints_.emplace_back(j, *same);
    }
    for (int body = 1; body < static_cast<int>(robot.bodies().size()); ++body) {
      if (const auto same = other.find_body(robot.bodies()[body].name)) {
        bodies_.emplace_back(body, *same);
      }
    }
  }

  std::vector<std::string> differences() {
    compare_names();
    compare_order();
    compare_axes();
    compare_ranges();
    compare_poses();
    compare_masses();
    return std::move(lines_);
  }

 private:
  void compare_names();
  void compare_order();
  void compare_axes();
  void compare_ranges();
  void compare_poses();
  void compare_masses();
  [[nodiscard]] const std::string& name_of(int joint) const { return robot_.joints()[joint].name; }

  const Robot& robot_;
  const Robot& other_;
  Shared joints_, bodies_;
  std::vector<std::string> lines_;
};

void RobotComparison::compare_names() {
  const auto missing = [](const Robot& from, const Robot& in) {
    std::vector<std::string> names;
    for (const RobotJoint& joint : from.joints()) {
      if (!in.find_joint(joint.name)) names.push_back(joint.name);
    }
    return names;
  };
  const auto only_here = missing(robot_, other_), only_there = missing(other_, robot_);
  if (!only_here.empty()) {
    lines_.push_back("joints that the model lacks: " + list_names(only_here, 8));
  }
  if (!only_there.empty()) {
    lines_.push_back("joints that the robot lacks: " + list_names(only_there, 8));
  }
}

void RobotComparison::compare_order() {
  std::vector<int> places;
  for (const int joint : robot_.output_joints()) {
    const auto shared = std::ranges::find(joints_, joint, &std::pair<int, int>::first);
    if (shared != joints_.end()) places.push_back(shared->second);
  }
  const auto first = std::ranges::is_sorted_until(places);
  if (first == places.end()) return;
  lines_.push_back("the order of the joints differs, first at " + other_.joints()[*first].name);
}

// Compares joint axes in the zero configuration, relative to the root.
void RobotComparison::compare_axes() {
  constexpr double kTurned = 0.1 * std::numbers::pi / 180.0;
  constexpr double kApart = 5e-4;  // Metres.
  const TreeState here(robot_.tree(), robot_.zero_configuration());
  const TreeState there(other_.tree(), other_.zero_configuration());
  const Pose root = here.world_from_body(robot_.root_body()).inverse();
  const Pose other_root = there.world_from_body(other_.root_body()).inverse();
  Deviations turned(kTurned), apart(kApart);
  for (const auto& [joint, other] : joints_) {
    const Eigen::Vector3d axis = root.rotation * here.axis(joint);
    const Eigen::Vector3d gap = root * here.anchor(joint) - other_root * there.anchor(other);
    turned.add(angle_between(axis, other_root.rotation * there.axis(other)), name_of(joint));
    apart.add(gap.cross(axis).norm(), name_of(joint));
  }
  const double degrees = 180.0 / std::numbers::pi;
  if (turned.any()) lines_.push_back(turned.text("directions of axes", degrees, "degrees", 2));
  if (apart.any()) lines_.push_back(apart.text("positions of axes", 1000.0, "mm", 1));
}

void RobotComparison::compare_ranges() {
  constexpr double kSame = 1e-3;
  const LimitSet& limits = robot_.model_limits();
  const LimitSet& others = other_.model_limits();
  Deviations ranges(kSame);
  for (const auto& [joint, other] : joints_) {
    for (const auto& [bound, other_bound] : {std::pair(limits.lower[joint], others.lower[other]),
                                             std::pair(limits.upper[joint], others.upper[other])}) {
      if (bound != other_bound) ranges.add(std::abs(bound - other_bound), name_of(joint));
    }
  }
  if (ranges.any()) lines_.push_back(ranges.text("ranges", 1.0, "rad or m", 3));
}

// Compares the positions of bodies with the same name in configurations spread over the joint
// ranges.
void RobotComparison::compare_poses() {
  constexpr int kSamples = 32;
  constexpr double kApart = 1e-4;  // Metres.
  constexpr double kHalfRange = 1.0;
  std::vector<double> largest(bodies_.size(), 0.0);
  std::vector<double> here = robot_.zero_configuration(), there = other_.zero_configuration();
  std::vector<Pose> bodies(robot_.bodies().size()), others(other_.bodies().size());
  for (int sample = 0; sample < kSamples; ++sample) {
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const auto& [joint, other] = joints_[i];
      const double turns = sample * std::sqrt(2.0 + static_cast<double>(i));
      const double share = 2.0 * (turns - std::floor(turns)) - 1.0;
      const double position =
          std::clamp(sample == 0 ? 0.0 : share * kHalfRange, robot_.model_limits().lower[joint],
                     robot_.model_limits().upper[joint]);
      here[robot_.joints()[joint].qpos_address] = position;
      there[other_.joints()[other].qpos_address] = position;
    }
    forward_kinematics(robot_, here, bodies);
    forward_kinematics(other_, there, others);
    const Pose root = bodies[robot_.root_body()].inverse();
    const Pose other_root = others[other_.root_body()].inverse();
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const Eigen::Vector3d place = root * bodies[bodies_[i].first].translation;
      const Eigen::Vector3d other = other_root * others[bodies_[i].second].translation;
      largest[i] = std::max(largest[i], (place - other).norm());
    }
  }
  Deviations places(kApart);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    places.add(largest[i], robot_.bodies()[bodies_[i].first].name);
  }
  if (places.any()) {
    lines_.push_back(
        places.text(fmt::format("body positions in {} configurations", kSamples), 1000.0, "mm", 1));
  }
}

double link_mass(const Robot& robot, int joint) {
  double mass = 0.0;
  for (const int body : robot.tree().rigid_group(robot.joints()[joint].body)) {
    mass += robot.model()->body_mass[body];
  }
  return mass;
}

void RobotComparison::compare_masses() {
  constexpr double kSame = 1e-3;  // Kilograms.
  Deviations masses(kSame);
  for (const auto& [joint, other] : joints_) {
    masses.add(std::abs(link_mass(robot_, joint) - link_mass(other_, other)), name_of(joint));
  }
  if (masses.any()) lines_.push_back(masses.text("masses that joints move", 1.0, "kg", 3));
  const double all = mj_getTotalmass(robot_.model()), others = mj_getTotalmass(other_.model());
  if (std::abs(all - others) <= kSame) return;
  lines_.push_back(fmt::format("total mass: {} kg, of the model {} kg", number_text(all, 3),
                               number_text(others, 3)));
}

}  // namespace

Result<std::vector<std::string>> compare_robot(const RobotSources& robot,
                                               const std::string& model_path) {
  RETARGET_TRY_ASSIGN(const auto loaded, load_robot_files(robot.model, robot.profile));
  const RobotBase base = loaded->fixed_base() ? RobotBase::kFixed : RobotBase::kAuto;
  RETARGET_TRY_ASSIGN(const auto imported, import_robot(model_path, loaded->name(), base));
  return RobotComparison(*loaded, *imported.robot).differences();
}

}  // namespace retarget
