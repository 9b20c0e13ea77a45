#include "judge/quality/joint_offset_metric.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <utility>

#include "retarget/kinematic_tree.h"
#include "robot/anatomy/limbs.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// Sums for one joint over the limbs of one rank and over frames.
struct OffsetSum {
  double toward = 0.0;  // Of u_j . w; u_j . u is 0.
  double moved = 0.0;   // Of u_j . u_j.
};
using OffsetSums = std::array<OffsetSum, LimbDirections::kRanks>;

class OffsetMeter {
 public:
  OffsetMeter(const Robot& robot, const LimitSet& limits, const std::vector<LimbDirections>& limbs)
      : robot_(robot),
        limits_(limits),
        limbs_(limbs),
        state_(robot.tree()),
        is_free_(robot.joints().size()),
        sums_(robot.joints().size()) {
    for (const LimbDirections& limb : limbs) movers_.push_back(find_movers(limb));
  }

  void add(std::span<const double> qpos, int frame) {
    state_.update(qpos);
    find_free_joints(qpos);
    for (std::size_t i = 0; i < limbs_.size(); ++i) {
      const auto at = static_cast<std::size_t>(frame);
      if (limbs_[i].is_free(at)) add_limb(limbs_[i], movers_[i], at);
    }
  }

  [[nodiscard]] const OffsetSums& of(int joint) const {
    return sums_[static_cast<std::size_t>(joint)];
  }

 private:
  static constexpr std::array<double, 4> kSigns = {1.0, 1.0, -1.0, -1.0};  // Of ends_of().

  static std::array<const LimbEnd*, 4> ends_of(const LimbDirections& limb) {
    return {&limb.to[0], &limb.to[1], &limb.from[0], &limb.from[1]};
  }

  // The ends of a limb that a joint moves, in the order of ends_of().
  using MovedEnds = std::array<bool, 4>;

  // A joint that moves ends of a limb.
  struct MovingJoint {
    int joint = 0, dof = 0;
    std::size_t ends = 0;  // Index into Movers::ends.
  };
  struct Movers {
    std::vector<MovedEnds> ends;  // Without repetitions.
    std::vector<MovingJoint> joints;
  };

  [[nodiscard]] Movers find_movers(const LimbDirections& limb) const {
    const KinematicTree& tree = robot_.tree();
    Movers found;
    for (const int joint : robot_.output_joints()) {
      if (robot_.joints()[static_cast<std::size_t>(joint)].type != RobotJoint::Type::kHinge) {
        continue;
      }
      const int link = tree.link_of_joint(joint);
      MovedEnds ends{};
      std::ranges::transform(ends_of(limb), ends.begin(), [&](const LimbEnd* end) {
        return tree.carries(link, tree.attachment(end->body).link);
      });
      if (std::ranges::find(ends, true) == ends.end()) continue;
      const auto same = std::ranges::find(found.ends, ends);
      const auto index = static_cast<std::size_t>(same - found.ends.begin());
      if (same == found.ends.end()) found.ends.push_back(ends);
      found.joints.push_back({joint, KinematicTree::dof_of(link), index});
    }
    return found;
  }

  // The signed sum of the moved ends; a joint velocity of 1 rad/s moves their difference by
  // signs * linear + angular x arm.
  struct Lever {
    double signs = 0.0;
    Vector3d arm = Vector3d::Zero();  // From the base's origin, metres.
  };

  void find_levers(const LimbDirections& limb, const Movers& movers) {
    const auto ends = ends_of(limb);
    levers_.assign(movers.ends.size(), {});
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const Vector3d place =
          state_.world_from_body(ends[i]->body) * ends[i]->body_from_joint - state_.origin();
      for (std::size_t k = 0; k < levers_.size(); ++k) {
        if (!movers.ends[k][i]) continue;
        levers_[k].signs += kSigns[i];
        levers_[k].arm += kSigns[i] * place;
      }
    }
  }

  // Excludes joints at a limit, because the limit causes their deviation.
  void find_free_joints(std::span<const double> qpos) {
    constexpr double kAtLimit = 0.02;  // rad
    for (const int j : robot_.output_joints()) {
      const auto joint = static_cast<std::size_t>(j);
      const double q = qpos[static_cast<std::size_t>(robot_.joints()[joint].qpos_address)];
      is_free_[joint] =
          q > limits_.lower[joint] + kAtLimit && q < limits_.upper[joint] - kAtLimit ? 1 : 0;
    }
  }

  void add_limb(const LimbDirections& limb, const Movers& movers, std::size_t frame) {
    const Vector3d& along = limb.robot[frame];
    const double length = along.norm();
    if (!(length > 0.0) || !(limb.human[frame].norm() > 0.0)) return;
    const Vector3d have = along / length, want = limb.human[frame].normalized();
    find_levers(limb, movers);
    for (const auto& [joint, dof, ends] : movers.joints) {
      if (is_free_[static_cast<std::size_t>(joint)] == 0) continue;
      const auto& [signs, arm] = levers_[ends];
      // Per joint velocity, m/rad.
      const Vector3d velocity = signs * state_.linear[static_cast<std::size_t>(dof)] +
                                state_.angular[static_cast<std::size_t>(dof)].cross(arm);
      const Vector3d moved = (velocity - have * have.dot(velocity)) / length;
      OffsetSum& sum = sums_[static_cast<std::size_t>(joint)][static_cast<std::size_t>(limb.rank)];
      sum.toward += moved.dot(want);
      sum.moved += moved.squaredNorm();
    }
  }

  const Robot& robot_;
  const LimitSet& limits_;
  const std::vector<LimbDirections>& limbs_;
  TreeState state_;
  std::vector<Movers> movers_;    // One per limb.
  std::vector<Lever> levers_;     // Scratch memory, by Movers::ends.
  std::vector<char> is_free_;     // One per joint.
  std::vector<OffsetSums> sums_;  // One per joint.
};

// Uses the limbs of the first rank that the joint moves; empty if they do not determine the offset.
// Thresholds are for the mean of u_j . u_j per frame. The threshold of the forearms is higher, so
// that they determine only elbows: shoulders twist bent forearms to turn the hands, too.
std::optional<double> offset_from(const OffsetSums& sums, int frames) {
  constexpr double kMoves = 0.1;
  constexpr std::array kDetermines = {0.5, 0.5, 0.8};
  for (std::size_t rank = 0; rank < sums.size(); ++rank) {
    const auto& [toward, moved] = sums[rank];
    if (moved > kDetermines[rank] * frames) return -toward / moved;
    if (moved > kMoves * frames) return std::nullopt;
  }
  return std::nullopt;
}

// Corresponding joints of the left and the right arm.
std::vector<std::pair<int, int>> arm_pairs(const Robot& robot) {
  std::vector<std::pair<int, int>> pairs;
  const auto anatomy = find_limbs(robot, "");
  if (!anatomy) return pairs;
  const auto& [left, right] = anatomy->arms;
  if (left.joints.size() != right.joints.size()) return pairs;
  for (std::size_t i = 0; i < left.joints.size(); ++i) {
    pairs.emplace_back(left.joints[i], right.joints[i]);
  }
  return pairs;
}

}  // namespace

std::vector<JointOffset> find_joint_offsets(const RobotClip& clip, const LimitSet& limits,
                                            const std::vector<LimbDirections>& limbs) {
  std::vector<JointOffset> offsets;
  if (limbs.empty()) return offsets;
  const int frames = static_cast<int>(limbs.front().robot.size());
  OffsetMeter meter(clip.robot(), limits, limbs);
  for (int frame = 0; frame < frames; ++frame) meter.add(clip.qpos(frame), frame);
  for (const int joint : clip.robot().output_joints()) {
    if (const auto offset = offset_from(meter.of(joint), frames))
      offsets.push_back({joint, *offset});
  }
  return offsets;
}

std::vector<double> weigh_offsets(const std::vector<JointOffset>& offsets,
                                  const std::vector<std::pair<int, int>>& pairs) {
  std::vector<double> weights;
  for (const auto& [joint, offset] : offsets) {
    double weight = std::abs(offset);
    for (const auto& [left, right] : pairs) {
      if (joint != left && joint != right) continue;
      const auto other =
          std::ranges::find(offsets, joint == left ? right : left, &JointOffset::joint);
      if (other == offsets.end()) continue;
      weight = std::max(weight - std::abs(other->offset), 0.5 * weight);
    }
    weights.push_back(weight);
  }
  return weights;
}

void measure_joint_offsets(const ReportBuilder& draft, const LimitSet& limits,
                           const std::vector<LimbDirections>& limbs,
                           const std::vector<LimbDirections>& hands) {
  constexpr double kFarOff = 0.1;  // rad
  std::vector<JointOffset> offsets = find_joint_offsets(draft.clip, limits, limbs);
  for (const JointOffset& of_hand : find_joint_offsets(draft.clip, limits, hands)) {
    const bool known =
        std::ranges::find(offsets, of_hand.joint, &JointOffset::joint) != offsets.end();
    if (!known) offsets.push_back(of_hand);
  }
  if (offsets.empty()) return;
  std::ranges::stable_sort(offsets, std::greater(),
                           [](const JointOffset& off) { return std::abs(off.offset); });
  const std::vector<double> weights = weigh_offsets(offsets, arm_pairs(draft.clip.robot()));
  draft.set("joint_offset_rad", *std::ranges::max_element(weights));
  const int frames = static_cast<int>(limbs.front().robot.size());
  int count = 0;
  for (const auto& [joint, offset] : offsets) {
    if (std::abs(offset) <= kFarOff) break;
    if (static_cast<std::size_t>(count++) >= draft.options.faults_per_metric) continue;
    draft.report.faults.push_back(
        {"joint_offset_rad", draft.clip.robot().joints()[static_cast<std::size_t>(joint)].name, 0,
         frames, 0, offset, "rad"});
  }
  if (count > 0) draft.report.fault_totals.push_back({"joint_offset_rad", count});
}

}  // namespace retarget
