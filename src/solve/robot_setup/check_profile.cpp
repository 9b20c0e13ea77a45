#include "solve/robot_setup/check_profile.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>

#include "retarget/text.h"
#include "solve/robot_setup/format_model.h"
#include "solve/targets/check_soles.h"

namespace retarget {
namespace {

class ProfileChecks {
 public:
  ProfileChecks(const Robot& robot, const RobotAnatomy* limbs, const TPose* t_pose)
      : robot_(robot), profile_(robot.profile()), limbs_(limbs), t_pose_(t_pose) {}

  std::vector<RobotFinding> findings() {
    for (const LimitSet& set : profile_.limit_sets) check_limit_set(set);
    check_speeds();
    if (!profile_.fixed_base) check_soles_of_feet();
    check_t_pose();
    check_couplings();
    for (const RobotVariant& variant : profile_.variants) check_locked_joints(variant);
    return std::move(findings_);
  }

 private:
  void fault(std::string text) { findings_.push_back({true, std::move(text)}); }
  void note(std::string text) { findings_.push_back({false, std::move(text)}); }

  void check_limit_set(const LimitSet& set);
  void check_speeds();
  void check_soles_of_feet();
  void check_t_pose();
  void check_couplings();
  void check_locked_joints(const RobotVariant& variant);
  [[nodiscard]] std::string range_fault(const std::string& joint, double position) const;

  const Robot& robot_;
  const RobotProfile& profile_;
  const RobotAnatomy* limbs_;
  const TPose* t_pose_;
  std::vector<RobotFinding> findings_;
};

// Joints with the same difference between a limit set and the model, and the largest difference.
struct RangeDifference {
  std::size_t count = 0;
  double max = 0.0;  // rad or m
  const RobotJoint* worst = nullptr;

  void add(const RobotJoint& joint, double difference) {
    ++count;
    if (difference <= max) return;
    max = difference;
    worst = &joint;
  }
  [[nodiscard]] std::string text(const LimitSet& set, const char* what) const {
    const char* unit = worst->type == RobotJoint::Type::kSlide ? "m" : "rad";
    return fmt::format(
        "limit set {} {} on {}, most on {}{}", set.name, what, count_text(count, "joint"),
        worst->name,
        std::isfinite(max) ? fmt::format(" ({} {})", number_text(rounded(max, 3)), unit) : "");
  }
};

void ProfileChecks::check_limit_set(const LimitSet& set) {
  constexpr double kDifferent = 1e-3;
  // Makers' own sets exceed the ranges of older models by up to 1.7 rad.
  constexpr double kMuchWider = 2.0;
  const LimitSet& model = robot_.model_limits();
  RangeDifference tighter, wider, apart;
  for (std::size_t j = 0; j < robot_.joints().size(); ++j) {
    const RobotJoint& joint = robot_.joints()[j];
    const double above = model.upper[j] - set.upper[j], below = set.lower[j] - model.lower[j];
    const double gap = std::max(set.lower[j] - model.upper[j], model.lower[j] - set.upper[j]);
    if (gap > kDifferent) apart.add(joint, gap);
    if (std::max(-above, -below) > kMuchWider) wider.add(joint, std::max(-above, -below));
    const bool is_tighter = std::max(above, below) > kDifferent && set.lower[j] != set.upper[j];
    if (is_tighter) tighter.add(joint, std::max(above, below));
  }
  if (tighter.count > 0) note(tighter.text(set, "is tighter than the model"));
  if (wider.count > 0) note(wider.text(set, "is much wider than the model"));
  if (apart.count > 0) note(apart.text(set, "has no position in common with the model"));
}

void ProfileChecks::check_speeds() {
  if (auto odd = odd_speeds_text(robot_, profile_.speed_limits)) note(std::move(*odd));
  std::vector<std::string> missing;
  std::vector<int> joints;
  for (const int joint : robot_.output_joints()) {
    const std::string& name = robot_.joints()[joint].name;
    if (profile_.speed_limits.contains(name)) continue;
    missing.push_back(name);
    joints.push_back(joint);
  }
  if (missing.empty()) return;
  note("no speed limit for " +
       (missing.size() == robot_.output_joints().size() ? "any joint" : list_names(missing, 6)) +
       ": " + default_speeds_text(robot_, joints) + " is used");
}

void ProfileChecks::check_soles_of_feet() {
  if (profile_.soles.empty()) return note("the soles are unknown (\"soles\" in robot.json)");
  if (limbs_ == nullptr || !limbs_->has_legs) return;
  SoleFaults faults = check_soles(robot_, *limbs_);
  if (!faults.missing.empty()) fault(faults.missing + "; " + missing_sole_hint(robot_));
  for (std::string& misplaced : faults.misplaced) fault(std::move(misplaced));
}

void ProfileChecks::check_t_pose() {
  for (const auto& [joint, position] : profile_.t_pose) {
    const std::string beyond = range_fault(joint, position);
    if (!beyond.empty()) note("the T-pose (\"t_pose\" in robot.json) has " + beyond);
  }
  // An empty pose is the zero pose, which is the T-pose of some robots.
  constexpr double kZero = 1e-3;
  const auto is_moved = [&](const RobotJoint& joint) {
    return std::abs(t_pose_->qpos[static_cast<std::size_t>(joint.qpos_address)]) > kZero;
  };
  if (profile_.t_pose.empty() && t_pose_ != nullptr &&
      std::ranges::any_of(robot_.joints(), is_moved)) {
    note("the T-pose is unknown (\"t_pose\" in robot.json)");
  }
}

void ProfileChecks::check_couplings() {
  if (limbs_ == nullptr) return;
  for (const std::string& joint : couplings_outside(find_hands(robot_, *limbs_), robot_)) {
    note(dropped_coupling_text(robot_, joint));
  }
}

void ProfileChecks::check_locked_joints(const RobotVariant& variant) {
  for (const auto& [joint, position] : variant.locked) {
    const std::string beyond = range_fault(joint, position);
    if (!beyond.empty()) fault("variant \"" + variant.name + "\" locks " + beyond);
  }
}

// Describes a position that neither the model nor a limit set allows, with the nearest range;
// empty if one allows it.
std::string ProfileChecks::range_fault(const std::string& joint, double position) const {
  constexpr double kOutside = 1e-3;
  const auto index = robot_.find_joint(joint);
  if (!index) return {};
  const auto j = static_cast<std::size_t>(*index);
  const LimitSet& model = robot_.model_limits();
  const auto excess = [&](const LimitSet& set) {
    return std::max(set.lower[j] - position, position - set.upper[j]);
  };
  const LimitSet* nearest = &model;
  for (const LimitSet& set : profile_.limit_sets) {
    if (excess(set) < excess(*nearest)) nearest = &set;
  }
  if (!(excess(*nearest) > kOutside)) return {};
  return fmt::format("\"{}\" at {}, outside its range from {} to {}{}", joint,
                     number_text(rounded(position, 4)), number_text(rounded(nearest->lower[j], 4)),
                     number_text(rounded(nearest->upper[j], 4)),
                     nearest == &model ? "" : " in limit set " + nearest->name);
}

}  // namespace

std::vector<RobotFinding> profile_findings(const Robot& robot, const RobotAnatomy* limbs,
                                           const TPose* t_pose) {
  return ProfileChecks(robot, limbs, t_pose).findings();
}

std::string default_speeds_text(const Robot& robot, const std::vector<int>& joints) {
  const auto slides = std::ranges::count_if(
      joints, [&](int joint) { return robot.joints()[joint].type == RobotJoint::Type::kSlide; });
  const std::string of_hinges = number_text(robot.profile().default_speed_limit) + " rad/s";
  const std::string of_slides = number_text(kDefaultSlideSpeedLimit) + " m/s";
  if (slides == 0) return of_hinges;
  return slides == std::ssize(joints) ? of_slides : of_hinges + " (slides: " + of_slides + ")";
}

std::optional<std::string> odd_speeds_text(const Robot& robot,
                                           const std::map<std::string, double>& speeds) {
  constexpr double kFast = 60.0;  // rad/s; only single joints of robots are faster.
  std::vector<double> of_hinges;
  for (const RobotJoint& joint : robot.joints()) {
    const auto found = speeds.find(joint.name);
    if (found == speeds.end() || joint.type != RobotJoint::Type::kHinge) continue;
    of_hinges.push_back(found->second);
  }
  const auto fast = std::ranges::count_if(of_hinges, [](double speed) { return speed > kFast; });
  if (2 * fast <= std::ssize(of_hinges)) return std::nullopt;
  return fmt::format(
      "{} of {} speed limits exceed {} rad/s (up to {}), which looks like degrees per second or "
      "like no real limit: write them in rad/s",
      fast, of_hinges.size(), number_text(kFast), number_text(std::ranges::max(of_hinges), 0));
}

std::vector<std::string> couplings_outside(const RobotHands& hands, const Robot& robot) {
  const auto is_in_hand = [&](const std::string& name) {
    const auto joint = robot.find_joint(name);
    return joint && std::ranges::any_of(hands, [&](const auto& hand) {
             return hand && std::ranges::find(hand->joints, *joint, &HandJoint::joint) !=
                                hand->joints.end();
           });
  };
  std::vector<std::string> outside;
  for (const auto& [name, coupling] : robot.profile().coupled_joints) {
    if (!is_in_hand(name) || !is_in_hand(coupling.leader)) outside.push_back(name);
  }
  return outside;
}

std::string dropped_coupling_text(const Robot& robot, const std::string& joint) {
  return "a joint coupling is dropped, both joints move freely: \"" + joint + "\" to \"" +
         robot.profile().coupled_joints.at(joint).leader + "\"";
}

}  // namespace retarget
