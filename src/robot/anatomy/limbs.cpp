#include "robot/anatomy/limbs.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "base/option_name.h"
#include "base/try.h"
#include "retarget/kinematic_tree.h"
#include "retarget/so3.h"
#include "retarget/text.h"
#include "robot/anatomy/branches.h"
#include "robot/anatomy/counterparts.h"
#include "robot/anatomy/limb_flexion.h"
#include "robot/anatomy/limb_notes.h"
#include "robot/anatomy/limb_shape.h"
#include "robot/model/model_values.h"

namespace retarget {
namespace {

constexpr double kGroundShare = 0.15;  // Fraction of the height within which a point counts as on
                                       // the floor.
constexpr double kPerRadian = 180.0 / std::numbers::pi;
constexpr double kLying = 60.0;  // Degrees.

// Shapes of a pair's limbs; index 0 is the first branch, towards which `across` points.
struct ShapedPair {
  BranchPair pair;
  std::array<LimbShape, 2> limbs;
};

std::string name_of(const Robot& robot, int body) {
  return "\"" + robot.bodies()[body].name + "\"";
}

// Returns +1 if the names mark the first as the left one, -1 for the second, 0 if unclear.
int side_by_names(const std::string& first, const std::string& second) {
  std::size_t same = 0;
  while (same < std::min(first.size(), second.size()) && first[same] == second[same]) ++same;
  if (same == first.size() || same == second.size()) return 0;
  const auto letter = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  const int a = letter(first[same]);
  const int b = letter(second[same]);
  if (a == 'l' && b == 'r') return 1;
  return a == 'r' && b == 'l' ? -1 : 0;
}

int side_by_names(const Robot& robot, const std::array<LimbShape, 2>& limbs) {
  int votes = 0;
  for (std::size_t i = 0; i < limbs[0].joints.size(); ++i) {
    const RobotJoint& a = robot.joints()[limbs[0].joints[i]];
    const RobotJoint& b = robot.joints()[limbs[1].joints[i]];
    votes += side_by_names(a.name, b.name);
    votes += side_by_names(robot.bodies()[a.body].name, robot.bodies()[b.body].name);
  }
  return votes;
}

// Returns the direction in which flexion moves the limb's end.
Eigen::Vector3d motion_of_bending(const LimbShape& limb) {
  return limb.flexion * limb.axis.cross(limb.end - limb.bend).normalized();
}

class LimbFinder {
 public:
  LimbFinder(const Robot& robot, std::string file)
      : robot_(robot),
        file_(std::move(file)),
        reference_(reference_configuration(robot)),
        posed_(robot.tree(), reference_) {}

  Result<RobotAnatomy> find();

 private:
  [[nodiscard]] Result<void> check_counterparts(const std::vector<BranchPair>& pairs) const;
  Result<void> choose_pairs();
  [[nodiscard]] Result<void> check_are_arms(const std::vector<BranchPair>& pairs,
                                            const BranchPair& arms) const;
  Result<void> choose_arms();
  [[nodiscard]] Failure no_legs(const std::string& found, const std::string& hint = {}) const;
  [[nodiscard]] bool is_round(int joint) const;
  [[nodiscard]] bool stands_on_wheels() const;
  [[nodiscard]] Failure no_middle(int first, bool is_leg) const;
  [[nodiscard]] bool is_wrist(const LimbShape& arm) const;
  Result<ShapedPair> shape(const BranchPair& pair, bool is_leg) const;
  void find_facing();
  [[nodiscard]] double foot_vote(const Eigen::Vector3d& forward) const;
  [[nodiscard]] Limb limb_of(const LimbShape& shape, bool is_leg) const;
  void set_end(Limb& limb, const LimbShape& shape, bool is_leg) const;
  [[nodiscard]] Eigen::Matrix3d in_body(int body, const Eigen::Matrix3d& world_from_bone) const;
  [[nodiscard]] std::optional<LimbPart> head() const;
  [[nodiscard]] Result<void> check_lean() const;
  [[nodiscard]] int body_of(int link) const { return robot_.tree().links()[link].body; }

  const Robot& robot_;
  std::string file_;
  std::vector<double> reference_;
  TreeState posed_;
  ShapedPair legs_, arms_;
  double lean_ = 0.0;  // Lean of the line from hips to shoulders, degrees.
  RobotAnatomy found_;
};

Failure LimbFinder::no_legs(const std::string& found, const std::string& hint) const {
  const std::string upper = "for an upper body on a stand or wheels, use " OPTION("base") " fixed";
  return config_failure(file_, found + ": expected a humanoid with two legs and two arms",
                        hint.empty() ? upper : hint + "; " + upper);
}

// Returns true if the masses and shapes that a joint carries are centred on its axis, as for a
// wheel.
bool LimbFinder::is_round(int joint) const {
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
bool LimbFinder::stands_on_wheels() const {
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

// Explains why a branch is not a limb: names the joint at the position of its knee or elbow.
Failure LimbFinder::no_middle(int first, bool is_leg) const {
  const KinematicTree& tree = robot_.tree();
  const std::vector<int> chain = joint_chain(robot_, first);
  const std::string limb = is_leg ? "leg" : "arm";
  const std::string middle = is_leg ? "knee" : "elbow";
  const std::string name = "the " + limb + " starting at " + name_of(robot_, body_of(first));
  for (int link = first; link <= tree.links()[first].last_descendant; ++link) {
    if (!tree.links()[link].slides) continue;
    return config_failure(file_,
                          name + " has a slide, \"" +
                              robot_.joints()[tree.links()[link].joint].name +
                              "\", before its end: a " + middle + " must be a hinge",
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

// Returns true if a name says that the middle joint is no elbow, and what it bends is short.
bool LimbFinder::is_wrist(const LimbShape& arm) const {
  constexpr double kShort = 0.4;
  const double upper = (arm.bend - arm.root).norm(), lower = (arm.end - arm.bend).norm();
  return lower < kShort * upper && middle_vote_of_names(robot_, arm.joints[arm.middle], false) < 0;
}

Result<ShapedPair> LimbFinder::shape(const BranchPair& pair, bool is_leg) const {
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
  // A hand is no forearm.
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

Result<void> LimbFinder::check_counterparts(const std::vector<BranchPair>& pairs) const {
  const auto missing = missing_counterpart(robot_, posed_, pairs);
  if (!missing) return {};
  return config_failure(file_, *missing,
                        "add it to the model, or remove the joints that only one side has");
}

Result<void> LimbFinder::choose_pairs() {
  std::vector<BranchPair> pairs = branch_pairs(robot_, posed_);
  if (stands_on_wheels()) return no_legs("the model stands on wheels");
  if (pairs.size() < 2) TRY(check_counterparts(pairs));
  if (pairs.empty()) {
    return no_legs("no two branches of the model are mirror images of each other (" +
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
    return no_legs("two pairs of limbs reach the ground (a quadruped, or a model that lies down?)");
  }
  if (pairs.size() == 1) {
    return no_legs("the model has only one pair of limbs whose joints turn",
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
  legs_ = shaped_legs;
  arms_ = *shaped_arms;
  const auto middle = [](const ShapedPair& pair) -> Eigen::Vector3d {
    return 0.5 * (pair.limbs[0].root + pair.limbs[1].root);
  };
  lean_ = kPerRadian * angle_between(middle(arms_) - middle(legs_), Eigen::Vector3d::UnitZ());
  if (lean_ > kLying || !(legs_.limbs[0].root.z() > legs_.limbs[0].end.z())) {
    return no_legs("the model does not stand upright along z in its zero configuration");
  }
  return {};
}

// Rejects the legs of a quadruped and of a biped without arms.
Result<void> LimbFinder::check_are_arms(const std::vector<BranchPair>& pairs,
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
Result<void> LimbFinder::choose_arms() {
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
  arms_ = shaped_arms;
  found_.has_legs = false;
  return {};
}

// Returns the extent of the feet ahead of the ankles minus that behind them, relative to their
// size.
double LimbFinder::foot_vote(const Eigen::Vector3d& forward) const {
  double vote = 0.0;
  for (const LimbShape& leg : legs_.limbs) {
    const int foot = robot_.joints()[leg.joints.back()].body;
    double ahead = 0.0;
    double behind = 0.0;
    for (const Eigen::Vector3d& point : outline_points(robot_, posed_, foot)) {
      const double x = (point - leg.end).dot(forward);
      ahead = std::max(ahead, x);
      behind = std::max(behind, -x);
    }
    if (ahead + behind > 1e-6) vote += (ahead - behind) / (ahead + behind);
  }
  return vote;
}

void LimbFinder::find_facing() {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d& across = (found_.has_legs ? legs_ : arms_).pair.across;
  const Eigen::Vector3d forward = across.cross(up);
  // Each pair has its own direction across, and the two may be opposite. Names can only be added if
  // arms and legs are in the same order.
  if ((arms_.limbs[0].root - arms_.limbs[1].root).dot(across) < 0.0) {
    std::swap(arms_.limbs[0], arms_.limbs[1]);
  }
  // A positive vote means that the first branches are the left ones.
  double votes = 0.25 * (forward.x() + forward.y());
  const double names = side_by_names(robot_, legs_.limbs) + side_by_names(robot_, arms_.limbs);
  votes += names > 0.0 ? 2.0 : (names < 0.0 ? -2.0 : 0.0);
  if (found_.has_legs) {
    for (const LimbShape& leg : legs_.limbs) votes -= 1.5 * motion_of_bending(leg).dot(forward);
    votes += foot_vote(forward);
  }
  for (const LimbShape& arm : arms_.limbs) votes += 0.5 * motion_of_bending(arm).dot(forward);
  const double sign = votes >= 0.0 ? 1.0 : -1.0;
  found_.forward = sign * forward;
  found_.left = sign * across;
  found_.facing_is_sure = std::abs(votes) > 1.0;
  if (sign * names < 0.0) {
    found_.notes.emplace_back(found_.has_legs
                                  ? "the limbs on the robot's left side are named right: the "
                                    "facing direction comes from knees and feet"
                                  : "the arms on the robot's left side are named right: the facing "
                                    "direction comes from the elbows");
  }
  if (!found_.facing_is_sure) {
    found_.notes.emplace_back(
        found_.has_legs ? "knees, feet and names hardly determine the robot's facing direction"
                        : "elbows and names hardly determine the robot's facing direction");
  }
  if (sign < 0.0) {
    std::swap(legs_.limbs[0], legs_.limbs[1]);
    std::swap(arms_.limbs[0], arms_.limbs[1]);
  }
}

Eigen::Matrix3d LimbFinder::in_body(int body, const Eigen::Matrix3d& world_from_bone) const {
  return posed_.world_from_body(body).rotation.toRotationMatrix().transpose() * world_from_bone;
}

void LimbFinder::set_end(Limb& limb, const LimbShape& shape, bool is_leg) const {
  const std::size_t beyond =
      shape.joints.size() - 1 - static_cast<std::size_t>(shape.middle) - shape.at_end;
  limb.end_joints = static_cast<int>(beyond);
  if (beyond == 0 && (is_leg || !shape.end_body)) return;
  LimbPart end;
  end.body = shape.end_body.value_or(robot_.joints()[shape.joints.back()].body);
  Eigen::Matrix3d world_from_bone;
  if (is_leg) {
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    world_from_bone << found_.forward, up, -found_.left;
  } else {
    world_from_bone = posed_.world_from_body(limb.lower.body).rotation.toRotationMatrix() *
                      limb.lower.body_from_bone;
  }
  end.body_from_bone = in_body(end.body, world_from_bone);
  end.joint = posed_.world_from_body(end.body).inverse() * shape.end;
  limb.end = end;
}

Limb LimbFinder::limb_of(const LimbShape& shape, bool is_leg) const {
  Limb limb;
  limb.joints = shape.joints;
  limb.middle = shape.middle;
  limb.clarity = shape.clarity;
  limb.straight = shape.straight;
  limb.lower_is_estimated = shape.end_is_estimated;
  limb.flexion_is_sure = shape.flexion != 0.0;
  limb.flexion = shape.flexion;
  if (!limb.flexion_is_sure) {
    // Knees bend the shin backwards, elbows bend the forearm forwards.
    const double swing = shape.axis.cross(shape.end - shape.bend).dot(found_.forward);
    limb.flexion = (swing > 0.0) == is_leg ? -1.0 : 1.0;
  }
  const Eigen::Vector3d z = -limb.flexion * shape.axis;
  const auto bone = [&](const Eigen::Vector3d& x) {
    Eigen::Matrix3d axes;
    axes << x, z.cross(x), z;
    return axes;
  };
  const auto body_at = [&](std::size_t joint) { return robot_.joints()[shape.joints[joint]].body; };
  const auto middle = static_cast<std::size_t>(shape.middle);
  limb.lower.body = body_at(middle + shape.at_end);
  limb.upper.body = robot_.tree().carrier(robot_.bodies()[body_at(middle - shape.at_root)].parent);
  limb.upper.body_from_bone = in_body(limb.upper.body, bone(shape.upper()));
  limb.upper.joint = posed_.world_from_body(limb.upper.body).inverse() * shape.root;
  limb.lower.body_from_bone = in_body(limb.lower.body, bone(shape.lower()));
  limb.lower.joint = posed_.world_from_body(limb.lower.body).inverse() * shape.bend;
  limb.upper_length = (shape.bend - shape.root).norm();
  limb.lower_length = (shape.end - shape.bend).norm();
  set_end(limb, shape, is_leg);
  return limb;
}

// Returns the branch of the trunk, other than a limb, that reaches highest above the shoulders.
std::optional<LimbPart> LimbFinder::head() const {
  const double shoulders = 0.5 * (arms_.limbs[0].root + arms_.limbs[1].root).z();
  std::optional<LimbPart> best;
  double highest = shoulders;
  for (const int trunk : {arms_.pair.parent, legs_.pair.parent}) {
    for (const int child : robot_.tree().children(trunk)) {
      const bool is_limb = child == legs_.pair.first || child == legs_.pair.second ||
                           child == arms_.pair.first || child == arms_.pair.second;
      const std::vector<int> chain = joint_chain(robot_, child);
      if (is_limb || chain.empty() || chain.size() > 3) continue;
      const int body = robot_.joints()[chain.back()].body;
      const double height = posed_.world_from_body(body).translation.z();
      if (height <= highest) continue;
      highest = height;
      Eigen::Matrix3d upright;
      upright << Eigen::Vector3d::UnitZ(), found_.forward, found_.left;
      best = LimbPart{body, in_body(body, upright), Eigen::Vector3d::Zero()};
    }
  }
  return best;
}

// A robot that leans far is accepted if its limbs and facing are unambiguous.
Result<void> LimbFinder::check_lean() const {
  constexpr double kFar = 40.0;
  if (lean_ <= kFar || (found_.doubts.empty() && found_.facing_is_sure)) return {};
  return config_failure(
      file_,
      fmt::format("the trunk leans by {} degrees in the zero configuration, and {}",
                  number_text(lean_, 0),
                  found_.doubts.empty() ? "the robot's facing direction is doubtful"
                                        : found_.doubts.front()),
      "turn the root body so that the robot stands upright along z");
}

Result<RobotAnatomy> LimbFinder::find() {
  TRY(robot_.fixed_base() ? choose_arms() : choose_pairs());
  find_facing();
  if (found_.has_legs) TRY(compare_flexion(robot_, file_, true, legs_.limbs, found_));
  TRY(compare_flexion(robot_, file_, false, arms_.limbs, found_));
  found_.pelvis = found_.has_legs ? body_of(legs_.pair.parent) : robot_.root_body();
  found_.torso = body_of(arms_.pair.parent);
  Eigen::Matrix3d upright;
  upright << Eigen::Vector3d::UnitZ(), found_.forward, found_.left;
  found_.pelvis_from_hips = in_body(found_.pelvis, upright);
  found_.torso_from_spine2 = in_body(found_.torso, upright);
  for (std::size_t side = 0; side < 2; ++side) {
    if (found_.has_legs) found_.legs[side] = limb_of(legs_.limbs[side], true);
    found_.arms[side] = limb_of(arms_.limbs[side], false);
  }
  if (found_.has_legs && (!found_.legs[0].end || !found_.legs[1].end)) {
    return no_legs("the legs have no ankle joints (a stand or wheels?)");
  }
  found_.head = head();
  note_limbs(robot_, {lean_, legs_.limbs[0].toe}, found_);
  doubt_limbs(robot_, found_);
  TRY(check_lean());
  return found_;
}

}  // namespace

std::vector<double> reference_configuration(const Robot& robot) {
  std::vector<double> qpos = robot.zero_configuration();
  const LimitSet& limits = robot.model_limits();
  for (std::size_t j = 0; j < robot.joints().size(); ++j) {
    double& position = qpos[robot.joints()[j].qpos_address];
    position = std::clamp(position, limits.lower[j], limits.upper[j]);
  }
  return qpos;
}

Result<RobotAnatomy> find_limbs(const Robot& robot, const std::string& file) {
  return LimbFinder(robot, file).find();
}

}  // namespace retarget
