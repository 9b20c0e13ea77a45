#include "robot/anatomy/limb_shape.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "base/option_name.h"
#include "base/try.h"
#include "retarget/root_pose.h"
#include "retarget/so3.h"
#include "retarget/text.h"
#include "robot/anatomy/branches.h"
#include "robot/model/model_values.h"

namespace retarget {

Failure no_legs_failure(const std::string& file, const std::string& found,
                        const std::string& hint) {
  const std::string upper = "for an upper body on a stand or wheels, use " OPTION("base") " fixed";
  return config_failure(file, found + ": expected a humanoid with two legs and two arms",
                        hint.empty() ? upper : hint + "; " + upper);
}

namespace {

constexpr double kGroundShare = 0.15;  // Fraction of the height within which a point counts as on
                                       // the floor.
constexpr double kPerRadian = 180.0 / std::numbers::pi;
constexpr double kLying = 60.0;  // Degrees.

std::string name_of(const Robot& robot, int body) {
  return "\"" + robot.bodies()[body].name + "\"";
}

class PairFinder {
 public:
  PairFinder(const Robot& robot, const TreeState& posed, const std::vector<double>& reference,
             const std::string& file)
      : robot_(robot), posed_(posed), reference_(reference), file_(file) {}

  Result<LimbPairs> find();

 private:
  [[nodiscard]] Result<void> check_counterparts(const std::vector<BranchPair>& pairs) const;
  Result<void> choose_pairs();
  [[nodiscard]] Result<void> check_are_arms(const std::vector<BranchPair>& pairs,
                                            const BranchPair& arms) const;
  Result<void> choose_arms();
  [[nodiscard]] bool is_round(int joint) const;
  [[nodiscard]] bool stands_on_wheels() const;
  [[nodiscard]] bool lies() const;
  [[nodiscard]] Failure not_upright() const;
  [[nodiscard]] Failure no_middle(int first, bool is_leg) const;
  [[nodiscard]] bool turns_beyond_shoulder(const LimbShape& arm) const;
  [[nodiscard]] bool is_wrist(const LimbShape& arm) const;
  Result<ShapedPair> shape(const BranchPair& pair, bool is_leg) const;
  [[nodiscard]] int body_of(int link) const { return robot_.tree().links()[link].body; }

  const Robot& robot_;
  const TreeState& posed_;
  const std::vector<double>& reference_;
  const std::string& file_;
  LimbPairs found_;
};

// Returns true if the masses and shapes that a joint carries are centred on its axis, as for a
// wheel.
bool PairFinder::is_round(int joint) const {
  constexpr double kOff = 0.02;  // Metres.
  const KinematicTree& tree = robot_.tree();
  const int first = tree.link_of_joint(joint);
  Eigen::Vector3d mass = Eigen::Vector3d::Zero(), outline = mass;
  double weight = 0.0, count = 0.0;
  for (int link = first; link <= tree.links()[first].last_descendant; ++link) {
    for (const int body : tree.rigid_group(tree.links()[link].body)) {
      const double kg = robot_.model()->body_mass[body];
      mass += kg * (posed_.world_from_body(body) * vector_at(robot_.model()->body_ipos, body));
      weight += kg;
    }
    for (const Eigen::Vector3d& point : outline_points(robot_, posed_, tree.links()[link].body)) {
      outline += point;
      count += 1.0;
    }
  }
  const auto off_axis = [&](const Eigen::Vector3d& point) {
    return (point - posed_.anchor(joint)).cross(posed_.axis(joint)).norm();
  };
  return (weight == 0.0 || off_axis(mass / weight) < kOff) &&
         (count == 0.0 || off_axis(outline / count) < kOff);
}

// Returns true if the lowest joint is an unlimited hinge with a horizontal axis and a round load.
bool PairFinder::stands_on_wheels() const {
  const LimitSet& limits = robot_.model_limits();
  int lowest = -1;
  for (int j = 0; j < static_cast<int>(robot_.joints().size()); ++j) {
    if (lowest < 0 || posed_.anchor(j).z() < posed_.anchor(lowest).z() - 1e-6) lowest = j;
  }
  return lowest >= 0 && std::abs(posed_.axis(lowest).z()) < 0.5 &&
         robot_.joints()[lowest].type == RobotJoint::Type::kHinge &&
         !std::isfinite(limits.upper[lowest]) && !std::isfinite(limits.lower[lowest]) &&
         std::ranges::any_of(limits.upper, [](double upper) { return std::isfinite(upper); }) &&
         is_round(lowest);
}

Failure PairFinder::not_upright() const {
  return no_legs_failure(file_,
                         "the model does not stand upright along z in its zero configuration",
                         "turn its root body, for example if it stands along y");
}

// Explains why a branch is not a limb: names the joint at the position of its knee or elbow.
Failure PairFinder::no_middle(int first, bool is_leg) const {
  const std::vector<int> chain = joint_chain(robot_, first);
  const std::string limb = is_leg ? "leg" : "arm";
  const std::string middle = is_leg ? "knee" : "elbow";
  const std::string name = "the " + limb + " starting at " + name_of(robot_, body_of(first));
  if (const auto slide = first_slide(robot_, first)) {
    return config_failure(file_,
                          name + " has a slide, \"" + robot_.joints()[*slide].name +
                              "\", before its end: " + (is_leg ? "a " : "an ") + middle +
                              " must be a hinge",
                          "replace it with the hinge that it drives");
  }
  return config_failure(
      file_,
      fmt::format("{} has no {}: none of its {} divides it into {}", name, middle,
                  count_text(static_cast<long>(chain.size()), "joint"),
                  is_leg ? "a thigh and a shin" : "an upper arm and a forearm"),
      "check that no joint of the " + limb + " is fixed by mistake" +
          (is_leg ? ""
                  : ", and that the arm's end is identifiable by a hand or the forearm's mass"));
}

// Returns true if the upper arm contains a joint beyond the shoulder: one that only repeats the
// twist of the joint before it, or one after three joints whose axis does not pass their meeting
// point. Both are forearm joints of an arm whose elbow does not move.
bool PairFinder::turns_beyond_shoulder(const LimbShape& arm) const {
  constexpr std::size_t kShoulder = 3;
  constexpr double kParallel = 0.99;  // Cosine.
  constexpr double kSame = 0.1;       // Fraction of the upper arm.
  constexpr double kApart = 0.35;     // Likewise.
  const std::span<const int> joints(arm.joints);
  const double upper = (arm.bend - arm.root).norm();
  const auto distance = [&](int joint, const Eigen::Vector3d& point) {
    return (point - posed_.anchor(joint)).cross(posed_.axis(joint)).norm();
  };
  for (std::size_t i = 2; i + arm.at_root < static_cast<std::size_t>(arm.middle); ++i) {
    const int joint = joints[i], before = joints[i - 1];
    const bool repeats = std::abs(posed_.axis(joint).dot(posed_.axis(before))) > kParallel &&
                         distance(before, posed_.anchor(joint)) < kSame * upper;
    const bool apart =
        i >= kShoulder && distance(joint, common_point(posed_, joints.first(i))) > kApart * upper;
    if (repeats || apart) return true;
  }
  return false;
}

// Returns true if the middle joint is not an elbow: it is named as another joint and the part that
// it bends is short or of unknown length, or this part is of unknown length and the upper arm
// contains joints of a forearm.
bool PairFinder::is_wrist(const LimbShape& arm) const {
  constexpr double kShort = 0.4;
  const double upper = (arm.bend - arm.root).norm(), lower = (arm.end - arm.bend).norm();
  const int middle = arm.joints[arm.middle];
  const bool named = middle_vote_of_names(robot_, middle, false) < 0;
  if (named && lower < kShort * upper) return true;
  if (!arm.end_is_estimated) return false;
  // The body beyond an elbow may be named as the hand, the joint may not.
  const bool joint_is_named = named && middle_vote_of_name(robot_.joints()[middle].name, false) < 0;
  return joint_is_named || turns_beyond_shoulder(arm);
}

Result<ShapedPair> PairFinder::shape(const BranchPair& pair, bool is_leg) const {
  ShapedPair shaped{pair, {}};
  const std::array<int, 2> first = {pair.first, pair.second};
  const auto shape_side = [&](std::size_t side, std::optional<int> at) {
    return shape_limb(robot_, posed_, reference_, joint_chain(robot_, pair, first[side]), is_leg,
                      pair.across.cross(Eigen::Vector3d::UnitZ()), at);
  };
  for (std::size_t side = 0; side < 2; ++side) {
    const auto limb = shape_side(side, std::nullopt);
    if (!limb) return no_middle(first[side], is_leg);
    shaped.limbs[side] = *limb;
  }
  // A hand is not a forearm.
  for (std::size_t side = 0; side < 2 && !is_leg; ++side) {
    if (is_wrist(shaped.limbs[side])) return no_middle(first[side], is_leg);
  }
  // Mirrored limbs bend at the same joint: use the one with the best score on both sides.
  if (shaped.limbs[0].middle == shaped.limbs[1].middle) return shaped;
  const auto sum_of = [&](int middle) {
    return shaped.limbs[0].scores[middle] + shaped.limbs[1].scores[middle];
  };
  const std::size_t better =
      sum_of(shaped.limbs[0].middle) < sum_of(shaped.limbs[1].middle) ? 1 : 0;
  const auto again = shape_side(1 - better, shaped.limbs[better].middle);
  if (!again) {
    return config_failure(file_, "the branches of " + name_of(robot_, body_of(first[0])) + " and " +
                                     name_of(robot_, body_of(first[1])) + " should be " +
                                     (is_leg ? "a leg" : "an arm") +
                                     " each, but their structures differ");
  }
  shaped.limbs[1 - better] = *again;
  return shaped;
}

// Returns true if legs and arms mirror each other once the robot is turned to stand along z.
bool PairFinder::lies() const {
  const double quarter = 0.5 * std::numbers::pi;
  const Pose& base = posed_.world_from_body(robot_.root_body());
  for (const Eigen::Vector3d& turn :
       {Eigen::Vector3d(quarter, 0, 0), Eigen::Vector3d(-quarter, 0, 0),
        Eigen::Vector3d(0, quarter, 0), Eigen::Vector3d(0, -quarter, 0)}) {
    std::vector<double> qpos = reference_;
    set_root_rotation(qpos, exp_so3(turn) * base.rotation);
    const TreeState standing(robot_.tree(), qpos);
    const std::vector<BranchPair> pairs = branch_pairs(robot_, standing);
    if (pairs.size() > 1 && !missing_counterpart(robot_, standing, pairs)) return true;
  }
  return false;
}

Result<void> PairFinder::check_counterparts(const std::vector<BranchPair>& pairs) const {
  const auto missing = missing_counterpart(robot_, posed_, pairs);
  if (!missing) return {};
  if (!robot_.fixed_base() && lies()) return not_upright();
  return config_failure(file_, missing->fault, missing->hint);
}

Result<void> PairFinder::choose_pairs() {
  std::vector<BranchPair> pairs = branch_pairs(robot_, posed_);
  if (stands_on_wheels()) return no_legs_failure(file_, "the model stands on wheels");
  if (pairs.size() < 2) TRY(check_counterparts(pairs));
  if (pairs.empty()) {
    return no_legs_failure(
        file_,
        "no two branches of the model are mirror images of each other (" +
            std::to_string(robot_.joints().size()) + " joints: a single arm?)",
        "check that it stands upright along z in its zero configuration, not along y");
  }
  std::ranges::stable_sort(pairs, {}, &BranchPair::lowest);
  double highest = pairs.front().lowest;
  for (std::size_t b = 1; b < robot_.bodies().size(); ++b) {
    highest = std::max(highest, posed_.world_from_body(static_cast<int>(b)).translation.z());
  }
  const double floor = pairs.front().lowest + kGroundShare * (highest - pairs.front().lowest);
  if (pairs.size() > 1 && pairs[1].lowest < floor) {
    return no_legs_failure(
        file_, "two pairs of limbs reach the ground (a quadruped, or a model that lies down?)");
  }
  if (pairs.size() == 1) {
    return no_legs_failure(file_, "the model has only one pair of limbs whose joints turn",
                           "check that the joints of its arms are not fixed");
  }
  const auto arms =
      std::max_element(pairs.begin() + 1, pairs.end(),
                       [](const auto& a, const auto& b) { return a.joint_count < b.joint_count; });
  TRY_ASSIGN(auto shaped_legs, shape(pairs.front(), true));
  auto shaped_arms = shape(*arms, false);
  if (!shaped_arms) {
    // The arms may have no counterparts, so that their fingers are mistaken for arms.
    TRY(check_counterparts(pairs));
    return failure(shaped_arms.error());
  }
  found_.legs = std::move(shaped_legs);
  found_.arms = std::move(*shaped_arms);
  const auto middle = [](const ShapedPair& pair) -> Eigen::Vector3d {
    return 0.5 * (pair.limbs[0].root + pair.limbs[1].root);
  };
  found_.lean = kPerRadian *
                angle_between(middle(found_.arms) - middle(found_.legs), Eigen::Vector3d::UnitZ());
  if (found_.lean > kLying || !(found_.legs.limbs[0].root.z() > found_.legs.limbs[0].end.z())) {
    return not_upright();
  }
  return {};
}

// Rejects the legs of a quadruped and of a biped without arms.
Result<void> PairFinder::check_are_arms(const std::vector<BranchPair>& pairs,
                                        const BranchPair& arms) const {
  constexpr int kLimbJoints = 3;
  const std::string expected = ": expected an upper body with two arms";
  double lowest = INFINITY, highest = -INFINITY;
  for (const BranchPair& pair : pairs) lowest = std::min(lowest, pair.lowest);
  for (std::size_t b = 1; b < robot_.bodies().size(); ++b) {
    highest = std::max(highest, posed_.world_from_body(static_cast<int>(b)).translation.z());
  }
  const double floor = lowest + kGroundShare * (highest - lowest);
  const auto stands = [&](const BranchPair& pair) {
    return pair.joint_count >= kLimbJoints && pair.lowest < floor;
  };
  if (stands(arms) && std::ranges::count_if(pairs, stands) > 1) {
    return config_failure(file_, "two pairs of limbs reach the ground (a quadruped?)" + expected);
  }
  int votes_of_legs = 0, votes_of_arms = 0;
  for (const int first : {arms.first, arms.second}) {
    for (const int joint : joint_chain(robot_, arms, first)) {
      const LimbNames names = limb_named_by(robot_, joint);
      votes_of_legs += names.leg ? 1 : 0;
      votes_of_arms += names.arm ? 1 : 0;
    }
  }
  if (votes_of_legs > 0 && votes_of_arms == 0) {
    return config_failure(
        file_, "the only limbs, which start at " + name_of(robot_, body_of(arms.first)) + " and " +
                   name_of(robot_, body_of(arms.second)) + ", have the names of legs" + expected);
  }
  return {};
}

// Chooses the arms of an upper body: the highest pair with enough joints for shoulder and elbow.
Result<void> PairFinder::choose_arms() {
  constexpr int kFewestJoints = 2;
  std::vector<BranchPair> pairs = branch_pairs(robot_, posed_);
  std::erase_if(pairs, [](const BranchPair& pair) { return pair.joint_count < kFewestJoints; });
  if (pairs.empty()) {
    TRY(check_counterparts(pairs));
    return config_failure(
        file_,
        "no two branches of the model are mirror images of each other (" +
            std::to_string(robot_.joints().size()) +
            " joints): expected an upper body with two arms",
        "check that it stands upright along z in its zero configuration, not along y");
  }
  const auto& links = robot_.tree().links();
  const auto arms = std::ranges::max_element(pairs, {}, [&](const BranchPair& pair) {
    return posed_.anchor(links[pair.first].joint).z() + posed_.anchor(links[pair.second].joint).z();
  });
  TRY(check_are_arms(pairs, *arms));
  TRY_ASSIGN(auto shaped_arms, shape(*arms, false));
  found_.arms = std::move(shaped_arms);
  return {};
}

Result<LimbPairs> PairFinder::find() {
  TRY(robot_.fixed_base() ? choose_arms() : choose_pairs());
  return std::move(found_);
}

}  // namespace

Result<LimbPairs> find_limb_pairs(const Robot& robot, const TreeState& posed,
                                  const std::vector<double>& reference, const std::string& file) {
  return PairFinder(robot, posed, reference, file).find();
}

}  // namespace retarget
