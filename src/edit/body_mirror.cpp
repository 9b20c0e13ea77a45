#include "edit/body_mirror.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "edit/rest_frames.h"
#include "retarget/human_skeleton.h"
#include "retarget/so3.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// An offset shorter than this fraction of the longest bone has no direction.
constexpr double kShortOffset = 1e-3;

// Asymmetry of captured bodies, as a fraction of a length.
constexpr double kUneven = 0.25;

struct OffsetPair {
  Eigen::Vector3d own, of_mate;
};

// Pairs of a joint's children with its counterpart's children, for a given reflection.
struct ChildPairs {
  double cost = 0.0;                        // In file units.
  std::vector<std::pair<int, int>> joints;  // Pairs that were not known before.
};

// Returns the reflection nearest to another that maps coordinate axes to coordinate axes, if one is
// near.
std::optional<Eigen::Matrix3d> of_axes(const Eigen::Matrix3d& guess) {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
  constexpr double kNear = 0.82;  // Cosine of 35 degrees.
  for (int column = 0; column < 3; ++column) {
    int row = 0;
    if (guess.col(column).cwiseAbs().maxCoeff(&row) < kNear) return std::nullopt;
    axes(row, column) = guess(row, column) < 0.0 ? -1.0 : 1.0;
  }
  return axes;
}

class MirrorFinder {
 public:
  MirrorFinder(const Skeleton& skeleton, const Calibration& calibration)
      : skeleton_(skeleton),
        calibration_(calibration),
        t_pose_(t_pose_rotations(skeleton, calibration)),
        children_(static_cast<std::size_t>(skeleton.joint_count())),
        mates_(children_.size(), -1),
        axes_(children_.size()) {
    for (int joint = 1; joint < skeleton.joint_count(); ++joint) {
      const Joint& own = skeleton.joint(joint);
      if (own.parent < 0) continue;
      children_[own.parent].push_back(joint);
      longest_ = std::max(longest_, own.offset.norm());
    }
  }

  Result<BodyMirror> run() {
    for (const Bone bone : kMappedBones) {
      RETARGET_TRY(pair_bones(bone));
    }
    const std::optional<Eigen::Matrix3d> all = of_zero_pose();
    for (int joint = 0; joint < skeleton_.joint_count(); ++joint) {
      // A joint without a parent is its own counterpart if the pairs do not determine one.
      if (mates_[joint] < 0 && skeleton_.joint(joint).parent < 0) mates_[joint] = joint;
      if (mates_[joint] < 0) return lonely(joint);
      // One side of each pair determines the reflection; the other side uses its inverse.
      if (mates_[joint] < joint) {
        axes_[joint] = axes_[mates_[joint]].transpose();
        continue;
      }
      RETARGET_TRY(decide(joint, all));
    }
    return BodyMirror{std::move(mates_), std::move(axes_)};
  }

 private:
  [[nodiscard]] Failure lonely(int joint) const {
    return input_failure({}, "the joint \"" + skeleton_.joint(joint).name +
                                 "\" has no counterpart on the other side of the body");
  }

  // Pairs a bone's joint with the other side's, and likewise their ancestors.
  Result<void> pair_bones(Bone bone) {
    int joint = calibration_.bones[bone].position_joint;
    int mate = calibration_.bones[mirrored(bone)].position_joint;
    if (joint < 0) return {};
    while (joint >= 0 || mate >= 0) {
      if (joint < 0 || mate < 0) return lonely(joint < 0 ? mate : joint);
      if (mates_[joint] == mate && mates_[mate] == joint) return {};
      if (mates_[joint] >= 0 || mates_[mate] >= 0) return lonely(mates_[joint] >= 0 ? mate : joint);
      mates_[joint] = mate;
      mates_[mate] = joint;
      joint = skeleton_.joint(joint).parent;
      mate = skeleton_.joint(mate).parent;
    }
    return {};
  }

  // Returns the reflection under which the zero pose is symmetric, if it is.
  [[nodiscard]] std::optional<Eigen::Matrix3d> of_zero_pose() const {
    Eigen::Matrix3d across = Eigen::Matrix3d::Zero();
    for (int joint = 1; joint < skeleton_.joint_count(); ++joint) {
      if (mates_[joint] < 0) continue;
      const Eigen::Vector3d apart =
          skeleton_.joint(joint).offset - skeleton_.joint(mates_[joint]).offset;
      across += apart * apart.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(across);
    Eigen::Vector3d normal = solver.eigenvectors().col(2);
    // Snap to a coordinate axis if it is close.
    constexpr double kNearAxis = 0.99;
    int axis = 0;
    if (normal.cwiseAbs().maxCoeff(&axis) > kNearAxis) normal = Eigen::Vector3d::Unit(axis);
    const Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity() - 2.0 * normal * normal.transpose();
    for (int joint = 1; joint < skeleton_.joint_count(); ++joint) {
      if (mates_[joint] >= 0 && !agrees(mirror, offsets(joint, mates_[joint]))) return std::nullopt;
    }
    return mirror;
  }

  [[nodiscard]] OffsetPair offsets(int joint, int mate) const {
    return {skeleton_.joint(joint).offset, skeleton_.joint(mate).offset};
  }

  [[nodiscard]] bool agrees(const Eigen::Matrix3d& axes, const OffsetPair& pair) const {
    const double size = std::max({pair.own.norm(), pair.of_mate.norm(), kUneven * longest_});
    return (axes * pair.own - pair.of_mate).norm() <= kUneven * size;
  }

  // Finds a joint's reflection and pairs its children.
  Result<void> decide(int joint, const std::optional<Eigen::Matrix3d>& all) {
    const int parent = skeleton_.joint(joint).parent;
    const Eigen::Matrix3d guess = guessed(joint);
    std::vector<Eigen::Matrix3d> candidates;
    if (all) candidates.push_back(*all);
    if (const auto axes = of_axes(guess)) candidates.push_back(*axes);
    if (parent >= 0) {
      // For a limb bone the T-pose gives better information than the parent does.
      const bool like_parent = mates_[joint] == joint || !turns_bone(joint);
      candidates.insert(like_parent ? candidates.begin() : candidates.end(), axes_[parent]);
    }
    candidates.push_back(guess);

    ChildPairs best;
    best.cost = std::numeric_limits<double>::infinity();
    for (const Eigen::Matrix3d& axes : candidates) {
      RETARGET_TRY_ASSIGN(auto pairs, pair_children(joint, axes));
      if (pairs.cost >= best.cost) continue;
      best = std::move(pairs);
      axes_[joint] = axes;
      if (agrees_all(axes, leaving(joint, best))) break;
    }
    for (const auto& [child, mate] : best.joints) {
      mates_[child] = mate;
      mates_[mate] = child;
    }
    const auto pairs = leaving(joint, best);
    if (!agrees_all(axes_[joint], pairs)) axes_[joint] = fitted(guess, pairs);
    return {};
  }

  [[nodiscard]] bool turns_bone(int joint) const {
    return std::ranges::any_of(calibration_.bones, [joint](const BoneSource& bone) {
      return bone.rotation_joint == joint;
    });
  }

  [[nodiscard]] Eigen::Matrix3d guessed(int joint) const {
    const Eigen::DiagonalMatrix<double, 3> mirror(1.0, -1.0, 1.0);
    return t_pose_[mates_[joint]].conjugate().toRotationMatrix() * mirror *
           t_pose_[joint].toRotationMatrix();
  }

  [[nodiscard]] bool agrees_all(const Eigen::Matrix3d& axes,
                                const std::vector<OffsetPair>& pairs) const {
    return std::ranges::all_of(pairs, [&](const auto& pair) { return agrees(axes, pair); });
  }

  // Pairs the offsets of a joint's children with those of its counterpart's.
  [[nodiscard]] std::vector<OffsetPair> leaving(int joint, const ChildPairs& found) const {
    std::vector<OffsetPair> pairs;
    for (const int child : children_[joint]) {
      if (mates_[child] >= 0) pairs.push_back(offsets(child, mates_[child]));
    }
    for (const auto& [child, mate] : found.joints) {
      if (mates_[child] < 0) pairs.push_back(offsets(child, mate));
    }
    const auto& own = skeleton_.joint(joint).end_sites;
    const auto& of_mate = skeleton_.joint(mates_[joint]).end_sites;
    if (own.size() == 1 && of_mate.size() == 1) pairs.push_back({own[0], of_mate[0]});
    return pairs;
  }

  // Pairs each unpaired child with the most similar one under the reflection.
  [[nodiscard]] Result<ChildPairs> pair_children(int joint, const Eigen::Matrix3d& axes) const {
    const int mate = mates_[joint];
    ChildPairs result;
    for (const OffsetPair& pair : leaving(joint, result)) {
      result.cost += (axes * pair.own - pair.of_mate).norm();
    }
    std::vector<int> left = unpaired(mate);
    std::vector<int> done;
    for (const int child : unpaired(joint)) {
      if (std::ranges::find(done, child) != done.end()) continue;
      const auto cost = [&](int other) {
        return (axes * skeleton_.joint(child).offset - skeleton_.joint(other).offset).norm() +
               difference(child, other);
      };
      const auto best = std::ranges::min_element(left, {}, cost);
      if (best == left.end() || std::isinf(cost(*best))) return lonely(child);
      const int other = *best;
      result.cost += cost(other);
      result.joints.emplace_back(child, other);
      left.erase(best);
      if (joint != mate || child == other) continue;
      // Both children belong to this joint, so neither is available any more.
      std::erase(left, child);
      done.push_back(other);
    }
    if (!left.empty()) return lonely(left.front());
    return result;
  }

  [[nodiscard]] std::vector<int> unpaired(int joint) const {
    std::vector<int> result;
    std::ranges::copy_if(children_[joint], std::back_inserter(result),
                         [this](int child) { return mates_[child] < 0; });
    return result;
  }

  // Returns the shape difference of two subtrees, as a sum of length differences; infinite if their
  // topologies differ.
  [[nodiscard]] double difference(int a, int b) const {
    if (children_[a].size() != children_[b].size()) return std::numeric_limits<double>::infinity();
    double sum = 0.0;
    std::vector<int> left(children_[b]);
    for (const int child : children_[a]) {
      const auto cost = [&](int other) {
        return std::abs(skeleton_.joint(child).offset.norm() -
                        skeleton_.joint(other).offset.norm()) +
               difference(child, other);
      };
      const auto best = std::ranges::min_element(left, {}, cost);
      sum += cost(*best);
      left.erase(best);
    }
    return sum;
  }

  // Returns the reflection nearest to a guess that maps a joint's child offsets to its
  // counterpart's.
  [[nodiscard]] Eigen::Matrix3d fitted(const Eigen::Matrix3d& guess,
                                       const std::vector<OffsetPair>& pairs) const {
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    Eigen::Vector3d own = Eigen::Vector3d::Zero(), of_mate = own;
    for (const OffsetPair& pair : pairs) {
      if (std::min(pair.own.norm(), pair.of_mate.norm()) <= kShortOffset * longest_) continue;
      own = pair.own.normalized();
      of_mate = pair.of_mate.normalized();
      covariance += of_mate * own.transpose();
    }
    if (own.isZero(0.0)) return guess;
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
    // A single direction leaves the rotation about it undetermined: keep the guess's.
    constexpr double kOneLine = 0.05;
    if (svd.singularValues()[1] < kOneLine * svd.singularValues()[0]) {
      return rotation_between(guess * own, of_mate).toRotationMatrix() * guess;
    }
    const Eigen::Matrix3d& u = svd.matrixU();
    const Eigen::Matrix3d& v = svd.matrixV();
    const double sign = (u * v.transpose()).determinant() < 0.0 ? 1.0 : -1.0;
    return u * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * v.transpose();
  }

  const Skeleton& skeleton_;
  const Calibration& calibration_;
  const std::vector<Eigen::Quaterniond> t_pose_;
  std::vector<std::vector<int>> children_;
  std::vector<int> mates_;
  std::vector<Eigen::Matrix3d> axes_;
  double longest_ = 0.0;  // Longest bone, file units.
};

}  // namespace

Result<BodyMirror> body_mirror(const Skeleton& skeleton, const Calibration& calibration) {
  return MirrorFinder(skeleton, calibration).run();
}

}  // namespace retarget
