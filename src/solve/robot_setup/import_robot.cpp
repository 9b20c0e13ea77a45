#include "solve/robot_setup/import_robot.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <algorithm>
#include <cmath>
#include <string_view>

#include "retarget/kinematic_tree.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "robot/model/limits.h"
#include "robot/model/urdf_extras.h"

namespace retarget {
namespace {

// Checks that names are UTF-8, because profiles and configurations refer to them in JSON.
Result<void> check_names(const mjModel& model, const std::string& path) {
  const std::string_view names(model.names, static_cast<std::size_t>(model.nnames));
  for (std::size_t at = 0; at < names.size();) {
    const std::string_view name = names.substr(at, names.find('\0', at) - at);
    if (valid_utf8(name) != name) {
      return config_failure(path, "the name \"" + valid_utf8(name) + "\" is not UTF-8",
                            "save the model as UTF-8, or use ASCII names");
    }
    at += name.size() + 1;
  }
  return {};
}

std::string quoted_names(std::vector<std::string> names) {
  for (std::string& name : names) name = "\"" + name + "\"";
  return list_names(names, 6);
}

// Hinges with suspicious ranges.
struct OddRanges {
  std::vector<std::string> open, closed, wide;
  double widest = 0.0;  // Largest bound, rad.
  std::size_t limited = 0;
};

OddRanges odd_ranges(const Robot& robot) {
  const LimitSet& limits = robot.model_limits();
  OddRanges odd;
  for (std::size_t j = 0; j < robot.joints().size(); ++j) {
    if (robot.joints()[j].type != RobotJoint::Type::kHinge) continue;
    const std::string name = "\"" + robot.joints()[j].name + "\"";
    const double lower = limits.lower[j], upper = limits.upper[j];
    if (!std::isfinite(lower) || !std::isfinite(upper)) {
      odd.open.push_back(name);
      continue;
    }
    ++odd.limited;
    const double bound = std::max(std::abs(lower), std::abs(upper));
    odd.widest = std::max(odd.widest, bound);
    if (bound > kLikeDegrees) odd.wide.push_back(name);
    if (upper - lower <= 0.0) odd.closed.push_back(name);
  }
  return odd;
}

void add_range_findings(const Robot& robot, std::vector<RobotFinding>& findings) {
  constexpr double kNarrow = 0.12;  // Radians; a range of 2 pi that is read as degrees is 0.11.
  constexpr std::size_t kEnough = 6;
  const OddRanges odd = odd_ranges(robot);
  const auto most = [&](const std::vector<std::string>& names) {
    return 2 * names.size() > odd.limited;
  };
  if (!odd.open.empty()) {
    findings.push_back(
        {false, "these joints have no range, or one from 0 to 0, and are unlimited: " +
                    list_names(odd.open, 6)});
  }
  if (!odd.closed.empty()) {
    findings.push_back({most(odd.closed), "the range of these joints is a single position: " +
                                              list_names(odd.closed, 6)});
  }
  if (!odd.wide.empty()) {
    findings.push_back({most(odd.wide),
                        fmt::format("ranges reach {} rad, which looks like degrees: {}; write them "
                                    "in radians, or add <compiler angle=\"degree\"/> to an MJCF",
                                    number_text(odd.widest, 0), list_names(odd.wide, 6))});
  }
  if (odd.limited >= kEnough && odd.widest < kNarrow) {
    constexpr double kDegrees = 57.29577951308232;
    findings.push_back(
        {true, fmt::format("no joint rotates by more than {} degrees: the ranges look like radians "
                           "read as degrees; add <compiler angle=\"radian\"/>",
                           number_text(kDegrees * odd.widest, 1))});
  }
}

void add_size_findings(const Robot& robot, std::vector<RobotFinding>& findings) {
  constexpr double kGiant = 20.0, kMillimetres = 300.0, kTiny = 0.05;  // Metres.
  const TreeState posed(robot.tree(), robot.zero_configuration());
  Eigen::Vector3d low = Eigen::Vector3d::Constant(INFINITY), high = -low;
  for (int body = 1; body < static_cast<int>(robot.bodies().size()); ++body) {
    const Eigen::Vector3d place = posed.world_from_body(body).translation;
    low = low.cwiseMin(place);
    high = high.cwiseMax(place);
  }
  const double size = (high - low).maxCoeff();
  if (!std::isfinite(size)) return;
  if (size > kGiant) {
    const bool millimetres = size > kMillimetres;
    findings.push_back(
        {true,
         fmt::format(
             "the bodies are {} m apart: the model seems to be in {}; multiply its lengths by {}",
             number_text(size, 0), millimetres ? "millimetres" : "centimetres",
             millimetres ? "0.001" : "0.01")});
  } else if (size < kTiny) {
    findings.push_back(
        {true, fmt::format("the bodies are at most {} mm apart: lengths must be in metres",
                           number_text(1000.0 * size, 1))});
  }
}

}  // namespace

Result<ImportedRobot> import_robot(const std::string& path, const std::string& name,
                                   RobotBase base) {
  ModelChanges changes;
  changes.float_base = true;
  changes.name_all = true;
  RETARGET_TRY_ASSIGN(auto loaded, load_model(path, changes));
  RETARGET_TRY(check_robot_joints(*loaded.model, path));
  RETARGET_TRY(check_names(*loaded.model, path));
  ImportedRobot imported;
  const bool fixed = base == RobotBase::kFixed;
  if (!loaded.sliding.empty()) {
    imported.notes.push_back("the root moved by " + quoted_names(loaded.sliding) + ": " +
                             (fixed ? "they are locked" : "a free joint replaces them"));
  } else if (!loaded.floated_body.empty() && !fixed) {
    imported.notes.push_back("the model had no free joint: \"" + loaded.floated_body +
                             "\" was given one");
  }
  if (!loaded.held.empty()) {
    imported.notes.push_back("ball joints that move nothing else are locked: " +
                             quoted_names(loaded.held));
  }
  imported.tied = std::move(loaded.tied);
  imported.excluded = std::move(loaded.excluded);
  RobotProfile profile;
  profile.name = name;
  profile.fixed_base = fixed;
  profile.coupled_joints = std::move(loaded.couplings);
  profile.speed_limits = urdf_facts(path).speeds;
  std::erase_if(profile.speed_limits, [&](const auto& speed) {
    return mj_name2id(loaded.model.get(), mjOBJ_JOINT, speed.first.c_str()) < 0;
  });
  imported.robot = std::make_shared<Robot>(std::move(loaded.model), std::move(profile),
                                           std::move(loaded.warnings));
  return imported;
}

Result<void> check_closed_chains(const ImportedRobot& imported, const RobotAnatomy& limbs,
                                 const std::string& path, std::vector<std::string>& notes) {
  const Robot& robot = *imported.robot;
  const KinematicTree& tree = robot.tree();
  std::vector<int> ends;
  for (const auto* pair : {&limbs.legs, &limbs.arms}) {
    for (const Limb& limb : *pair) {
      if (limb.joints.empty()) continue;
      ends.push_back(tree.link_of_joint(limb.joints.back()));
    }
  }
  // Whether the body is part of a limb or carries one.
  const auto is_main = [&](const std::string& name) {
    const auto body = robot.find_body(name);
    if (!body) return false;
    const int link = tree.attachment(*body).link;
    return link <= 0 || std::ranges::any_of(ends, [&](int end) { return tree.carries(link, end); });
  };
  for (const auto& [first, second] : imported.tied) {
    if (is_main(first) && is_main(second)) {
      return config_failure(
          path,
          "the model has a closed chain, which a kinematic tree cannot represent: an equality ties "
          "\"" +
              first + "\" to \"" + second + "\"",
          "remove the equality if the rest of the tree moves without it");
    }
    notes.push_back("an equality ties \"" + first + "\" to \"" + second +
                    "\": the equality is dropped, and \"" + (is_main(first) ? second : first) +
                    "\" does not follow");
  }
  return {};
}

std::vector<RobotFinding> model_findings(const Robot& robot) {
  std::vector<RobotFinding> findings;
  add_size_findings(robot, findings);
  add_range_findings(robot, findings);
  return findings;
}

}  // namespace retarget
