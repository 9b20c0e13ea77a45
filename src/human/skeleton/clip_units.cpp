#include "human/skeleton/units.h"

#include <fmt/format.h>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "formats/bvh/euler_angles.h"
#include "human/skeleton/foot_slides.h"
#include "human/skeleton/foot_steps.h"
#include "human/skeleton/up_evidence.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// Translation slots of the joints from the root to the hips.
std::vector<int> root_slots(const Skeleton& skeleton, const Body& body) {
  std::vector<int> slots;
  for (int joint = body.joint(Bone::kHips); joint >= 0; joint = skeleton.joint(joint).parent) {
    if (skeleton.translation_slot(joint) >= 0) slots.push_back(skeleton.translation_slot(joint));
  }
  return slots;
}

// Shorter clips show too little motion.
constexpr double kMinSeconds = 0.4;

// Axes of a joint's rotation channels.
std::vector<int> rotation_axes(const Joint& joint) {
  std::vector<int> axes;
  for (const Channel channel : joint.channels) {
    if (channel == Channel::kXRotation) axes.push_back(0);
    if (channel == Channel::kYRotation) axes.push_back(1);
    if (channel == Channel::kZRotation) axes.push_back(2);
  }
  return axes;
}

// Largest plausible angle of a joint, in degrees read from a file in radians: slightly more than 2
// pi. The root may exceed it because people spin.
double bound_of(int joint) {
  constexpr double kTurn = 2.02 * std::numbers::pi;
  return joint == 0 ? 6.0 * kTurn : kTurn;
}

// Whether all rotations are small enough: each is at most three times bound_of.
bool may_be_radians(const Clip& clip) {
  // Cosines of half of three times 6.35 and 38.1 degrees.
  constexpr double kJoint = 0.98623, kRoot = 0.54304;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (int joint = 0; joint < clip.skeleton().joint_count(); ++joint) {
      const double cosine = std::abs(clip.rotations(frame)[joint].w());
      if (cosine < (joint == 0 ? kRoot : kJoint)) return false;
    }
  }
  return true;
}

// Returns the clip with its angles, in degrees, reinterpreted as radians. Returns nothing if an
// angle exceeds its bound, or if all angles are too small to decide.
std::optional<Clip> with_radians(const Clip& clip) {
  constexpr double kDegreesPerRad = 180.0 / std::numbers::pi;
  constexpr double kPlainTurn = 0.5, kNoResidual = 1e-3;
  if (!may_be_radians(clip)) return std::nullopt;
  const Skeleton& skeleton = clip.skeleton();
  std::vector<std::vector<int>> axes;
  for (const Joint& joint : skeleton.joints()) axes.push_back(rotation_axes(joint));
  double largest = 0.0;
  Clip made = clip;
  std::array<double, 16> angles{}, none{};
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
      const std::vector<int>& of_joint = axes[static_cast<std::size_t>(joint)];
      const Eigen::Quaterniond& rotation = clip.rotations(frame)[joint];
      if (of_joint.size() > angles.size()) return std::nullopt;
      if (of_joint.empty()) continue;
      const std::span<double> found(angles.data(), of_joint.size());
      if (euler_angles(rotation, of_joint, {none.data(), of_joint.size()}, found) > kNoResidual) {
        return std::nullopt;
      }
      Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();
      for (std::size_t i = 0; i < found.size(); ++i) {
        if (std::abs(found[i]) > bound_of(joint)) return std::nullopt;
        largest = std::max(largest, std::abs(found[i]));
        rotate_about(turned, of_joint[i], kDegreesPerRad * found[i]);
      }
      made.rotations(frame)[joint] = turned.normalized();
    }
  }
  if (largest < kPlainTurn) return std::nullopt;
  make_sign_continuous(made);
  return made;
}

std::optional<Warning> convert_radians(Clip& clip, const Body& body) {
  // Foot speeds in legs per second, below which there is no evidence.
  constexpr double kSlow = 0.05, kMuchSlower = 0.5;
  // Cosines between trunk and legs.
  constexpr double kFolded = 0.5, kApart = 0.0;
  std::optional<Clip> made = with_radians(clip);
  if (!made) return std::nullopt;
  const std::vector<int> slots = root_slots(clip.skeleton(), body);
  const FootSteps degrees(clip, body, slots), radians(*made, body, slots);
  if (degrees.empty()) return std::nullopt;
  const double before = degrees.slowest_foot(1.0), after = radians.slowest_foot(1.0);
  const bool by_feet = before > kSlow && after < kMuchSlower * before && radians.fold() < kApart;
  const bool by_shape = degrees.fold() > kFolded && radians.fold() < kApart;
  if (by_feet || by_shape) {
    clip = *std::move(made);
    return Warning{0, 0,
                   "the rotations are in radians, according to their ranges and the feet; they "
                   "were converted to degrees"};
  }
  if (degrees.fold() <= kFolded) return std::nullopt;
  return Warning{0, 0,
                 "no joint rotates by more than 6.3 degrees, and legs and trunk point in the same "
                 "direction: the rotations may be in radians or missing"};
}

// Ratio of two positive numbers, inverted if it is below 1.
double factor_between(double a, double b) {
  return std::max(a / b, b / a);
}

// Returns the nearest ratio between two units: powers of ten of a metre, or of an inch.
double nearest_ratio(double number) {
  double best = 1.0;
  for (const double inches : {1.0, 2.54, 1.0 / 2.54}) {
    for (const double power : {1e-4, 1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3, 1e4}) {
      if (factor_between(inches * power, number) < factor_between(best, number))
        best = inches * power;
    }
  }
  return best;
}

// Returns the scale of the root translation that minimises the speed of the slowest foot.
double best_scale(const FootSteps& steps) {
  constexpr double kFactor = 1.05;
  double best = 1.0, least = steps.slowest_foot(1.0);
  for (double scale = 2e-4; scale < 5e3; scale *= kFactor) {
    const double speed = steps.slowest_foot(scale);
    if (speed < least) {
      least = speed;
      best = scale;
    }
  }
  return best;
}

// Whether the root has the only translations of the clip.
bool moves_by_root_alone(const Clip& clip, const std::vector<int>& slots) {
  return static_cast<std::size_t>(clip.skeleton().translated_count()) == slots.size();
}

// Whether a scale of the root translation makes moving feet stand still.
bool makes_feet_stand(const FootSteps& steps, double scale) {
  constexpr double kMuchSlower = 0.4, kSlower = 0.5;
  const double found = steps.slowest_foot(scale);
  return found < kMuchSlower * steps.slowest_foot(1.0) && found < kSlower * steps.slowest_foot(0.0);
}

// Whether feet stand still only with a root translation of another scale.
bool has_another_scale(const FootSteps& steps, double best) {
  constexpr double kPlainRatio = 2.0;
  return factor_between(best, 1.0) > kPlainRatio && makes_feet_stand(steps, best);
}

std::optional<Warning> check_root(Clip& clip, const Body& body) {
  constexpr double kSlow = 0.05;  // Legs per second.
  constexpr double kNearRatio = 1.12;
  const std::vector<int> slots = root_slots(clip.skeleton(), body);
  const FootSteps steps(clip, body, slots);
  if (steps.empty()) return std::nullopt;
  if (steps.slowest_foot(1.0) <= kSlow || !moves_by_root_alone(clip, slots) ||
      !(steps.root() > 0.0)) {
    return std::nullopt;
  }
  const double best = best_scale(steps), ratio = nearest_ratio(best);
  if (ratio != 1.0 && factor_between(best, ratio) < kNearRatio && makes_feet_stand(steps, ratio)) {
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      for (const int slot : slots) {
        clip.translations(frame)[static_cast<std::size_t>(slot)] *= ratio;
      }
    }
    return Warning{0, 0,
                   fmt::format("the unit of the root translation differs from that of the "
                               "offsets, according to the feet; it was multiplied by {:.4g}",
                               ratio)};
  }
  if (has_another_scale(steps, best)) {
    return Warning{0, 0,
                   fmt::format("the feet stand still only if the root translation is multiplied "
                               "by {:.2g}: its unit or the body size may be wrong",
                               best)};
  }
  return std::nullopt;
}

// Horizontal paths that a wrong sign or order of the root's axes makes of the right one: mirrored
// in an axis or a diagonal, or turned.
std::vector<Eigen::Matrix3d> wrong_paths(const Vector3d& up) {
  const Eigen::Matrix3d axes = z_up_from_file(up);
  const Vector3d a = axes.row(0), b = axes.row(1);
  std::vector<Eigen::Matrix3d> paths;
  for (const Vector3d& across :
       {a, b, Vector3d((a + b).normalized()), Vector3d((a - b).normalized())}) {
    paths.push_back(Eigen::Matrix3d::Identity() - 2.0 * across * across.transpose());
  }
  const Eigen::Matrix3d along_up = up * up.transpose();
  const Eigen::Matrix3d quarter = b * a.transpose() - a * b.transpose();
  paths.push_back(2.0 * along_up - Eigen::Matrix3d::Identity());
  paths.push_back(along_up + quarter);
  paths.push_back(along_up - quarter);
  return paths;
}

bool is_long_enough(const Clip& clip) {
  return clip.frame_count() * clip.rate().frame_time() >= kMinSeconds;
}

}  // namespace

std::optional<Warning> find_missing_root(const Clip& clip, const BoneMap& map, const Vector3d& up) {
  constexpr double kRestingRoot = 0.25, kMovingFeet = 0.3;  // Legs per second.
  if (!map.has(Bone::kHips) || !is_long_enough(clip)) return std::nullopt;
  const Body body(clip.skeleton(), map);
  const std::vector<int> slots = root_slots(clip.skeleton(), body);
  const FootSteps steps(clip, body, slots, up);
  // The root of a run may be missing over the ground, and bounce.
  const Eigen::Matrix3d everywhere = Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d over_ground = everywhere - up * up.transpose();
  if (!(steps.root(over_ground) < kRestingRoot)) return std::nullopt;
  const FootSlides slides(clip, body, up);
  const auto is_missing = [&](const Eigen::Matrix3d& measured) {
    const double root = steps.root(measured);
    return root < kRestingRoot && slides.steady(measured) > std::max(root, kMovingFeet);
  };
  if (!is_missing(everywhere) && !is_missing(over_ground)) return std::nullopt;
  if (moves_by_root_alone(clip, slots) && steps.root() > 0.0 &&
      has_another_scale(steps, best_scale(steps))) {
    return std::nullopt;
  }
  return Warning{0, 0,
                 "the planted feet move and the root does not: the root translation is missing "
                 "or centred, and the motion slides in place"};
}

std::optional<Warning> doubt_root_path(const Clip& clip, const BoneMap& map, const Vector3d& up) {
  constexpr double kMovingRoot = 0.25, kMovingFeet = 0.1;  // Legs per second.
  constexpr double kMuchSlower = 0.4, kSlower = 0.5, kFactor = 1.05;
  constexpr double kLeast = 0.25, kNearlyOne = 1.3, kGreatest = 4.0;
  if (!map.has(Bone::kHips) || !is_long_enough(clip)) return std::nullopt;
  const Body body(clip.skeleton(), map);
  const FootSteps steps(clip, body, root_slots(clip.skeleton(), body), up);
  const double speed = steps.slowest_foot(1.0);
  if (!(steps.root() > kMovingRoot && speed > kMovingFeet)) return std::nullopt;
  const Eigen::Matrix3d along_up = up * up.transpose();
  const Eigen::Matrix3d across_up = Eigen::Matrix3d::Identity() - along_up;
  const double least = std::min(kMuchSlower * speed, kSlower * steps.slowest_foot(along_up));
  double best = least, factor = 1.0;
  for (double scale = kLeast; scale < kGreatest; scale *= kFactor) {
    if (factor_between(scale, 1.0) < kNearlyOne) continue;
    const double scaled = steps.slowest_foot(Eigen::Matrix3d(along_up + scale * across_up));
    if (scaled >= best) continue;
    best = scaled;
    factor = scale;
  }
  const std::vector<Eigen::Matrix3d> wrong = wrong_paths(up);
  if (std::ranges::any_of(
          wrong, [&](const Eigen::Matrix3d& path) { return steps.slowest_foot(path) < best; })) {
    return Warning{0, 0,
                   "the feet stand still only if the horizontal path of the root is mirrored or "
                   "turned: an axis of the root translation may have the wrong sign or order"};
  }
  if (factor == 1.0) return std::nullopt;
  return Warning{0, 0,
                 fmt::format("the feet stand still only if the horizontal path of the root is "
                             "multiplied by {:.2g}: the path or the body size may be wrong",
                             factor)};
}

std::vector<Warning> repair_clip_units(Clip& clip, const BoneMap& map) {
  std::vector<Warning> warnings;
  // Positions have no angles, and one unit.
  const bool has_positions_only = !clip.origin().unknown_rotations.empty();
  if (has_positions_only || !map.has(Bone::kHips) || !is_long_enough(clip)) return warnings;
  const Body body(clip.skeleton(), map);
  if (auto warning = convert_radians(clip, body)) warnings.push_back(*std::move(warning));
  if (auto warning = check_root(clip, body)) warnings.push_back(*std::move(warning));
  return warnings;
}

}  // namespace retarget
