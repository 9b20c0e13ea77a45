#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "retarget/kinematic_tree.h"
#include "retarget/text.h"
#include "solve/robot_setup/import_robot.h"

namespace retarget {
namespace {

// Hinges with suspicious ranges.
struct OddRanges {
  std::vector<std::string> open, closed, wide;
  double widest = 0.0;  // Largest bound, rad.
  std::size_t limited = 0;
};

OddRanges odd_ranges(const Robot& robot) {
  constexpr double kWide = 10.0;  // Radians: more than 1.5 turns in either direction.
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
    if (bound > kWide) odd.wide.push_back(name);
    if (upper - lower <= 0.0) odd.closed.push_back(name);
  }
  return odd;
}

void add_range_findings(const Robot& robot, std::vector<RobotFinding>& findings) {
  constexpr double kNarrow = 0.12;  // Radians: a full turn in radians misread as degrees is 0.11.
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

std::vector<RobotFinding> model_findings(const Robot& robot) {
  std::vector<RobotFinding> findings;
  add_size_findings(robot, findings);
  add_range_findings(robot, findings);
  return findings;
}

}  // namespace retarget
