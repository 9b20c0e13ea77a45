#include "solve/hands/hand_target.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "formats/smpl/smpl_body.h"
#include "retarget/spline.h"
#include "retarget/trigonometry.h"

namespace retarget {
namespace {

std::size_t at(Finger finger) {
  return static_cast<std::size_t>(finger);
}

// The finger that replaces a missing finger: the nearest available one; on a tie, the first. A
// thumb is neither replaced nor a replacement.
template <typename Exists>
std::optional<Finger> nearest_finger(Finger finger, const Exists& exists) {
  std::optional<Finger> nearest;
  if (finger == Finger::kThumb) return nearest;
  int distance = static_cast<int>(kFingerCount);
  for (const Finger other : kFingers) {
    const int apart = std::abs(static_cast<int>(at(other)) - static_cast<int>(at(finger)));
    if (other == Finger::kThumb || apart >= distance || !exists(other)) continue;
    nearest = other;
    distance = apart;
  }
  return nearest;
}

// The source's finger that a robot's finger follows.
const FingerLine* line_for(const HandShape& shape, Finger finger) {
  if (shape.line(finger).is_there()) return &shape.line(finger);
  const auto nearest =
      nearest_finger(finger, [&](Finger other) { return shape.line(other).is_there(); });
  return nearest ? &shape.line(*nearest) : nullptr;
}

// Distance between the bones of touching tips, per finger length (15 mm).
constexpr double kSkin = 0.18;
// Gap, per finger length, at which the weight of a touch is 0.
constexpr double kFar = 0.5;

// Gap between thumb and index finger of an open hand, per finger length.
constexpr double kOpenGap = 0.8;

// Gap between the surfaces of two tips, per finger length.
double gap_between(const FingerLine& thumb, const FingerLine& finger) {
  return std::max(0.0, (finger.tip() - thumb.tip()).norm() / finger.length - kSkin);
}

// Unit vector between the points at two fractions of a line's length.
Eigen::Vector3d chord(const FingerLine& line, double from, double to) {
  const Eigen::Vector3d way = line.at(to) - line.at(from);
  const double length = way.norm();
  if (length > 1e-9 * line.length) return way / length;
  return (line.tip() - line.points[line.point_count - 2]).normalized();
}

}  // namespace

HandMatch::HandMatch(const RobotHand& hand) : hand_(&hand) {
  // The jaws of a gripper replace no other fingers.
  for (const Finger finger : kFingers) {
    int& follower = followers_[at(finger)];
    follower = -1;
    if (hand.is_gripper || hand.find(finger) != nullptr) continue;
    const auto nearest =
        nearest_finger(finger, [&](Finger other) { return hand.find(other) != nullptr; });
    if (nearest) follower = static_cast<int>(hand.find(*nearest) - hand.fingers.data());
  }
  // Shares are measured along the straight chain; lengths between joints are the model's.
  for (const RobotFinger& finger : hand.fingers) {
    std::vector<double> shares = {0.0};
    // The distance between two corners does not depend on joint positions, except between the two
    // joints of a knuckle.
    Eigen::Vector3d tip = finger.tip;
    std::vector<double> lengths;
    std::size_t corner = finger.corners.size();
    for (std::size_t i = finger.joints.size(); i-- > 0;) {
      if (corner > 0 && finger.joints[i] == finger.corners[corner - 1]) {
        lengths.insert(lengths.begin(), tip.norm());
        tip = Eigen::Vector3d::Zero();
        --corner;
      }
      tip = hand.joints[static_cast<std::size_t>(finger.joints[i])].parent_from_joint * tip;
    }
    const double total = std::accumulate(lengths.begin(), lengths.end(), 0.0);
    double sum = 0.0;
    for (const double length : lengths) {
      sum += length;
      shares.push_back(sum / total);
    }
    shares.back() = 1.0;
    shares_.push_back(std::move(shares));
  }
}

void HandMatch::target(const HandShape& shape, HandTarget& target) const {
  const FingerLine* thumb = line_for(shape, Finger::kThumb);
  const RobotFinger* robot_thumb = hand_->find(Finger::kThumb);
  for (std::size_t i = 0; i < hand_->fingers.size(); ++i) {
    const RobotFinger& finger = hand_->fingers[i];
    const std::size_t f = at(finger.finger);
    HandTarget::Parts& parts = target.parts[f];
    parts.count = 0;
    target.has_gap[f] = false;
    const FingerLine* line = line_for(shape, finger.finger);
    if (line == nullptr) continue;
    const std::vector<double>& shares = shares_[i];
    parts.count = std::min(static_cast<int>(shares.size()) - 1, HandTarget::Parts::kMaxParts);
    for (int part = 0; part < parts.count; ++part) {
      parts.directions[part] = chord(*line, shares[part], shares[part + 1]);
    }
    if (finger.finger == Finger::kThumb || thumb == nullptr || robot_thumb == nullptr) continue;
    // A finger also takes the smallest gap of the missing fingers that it replaces.
    double gap = gap_between(*thumb, *line);
    for (const Finger other : kFingers) {
      if (followers_[static_cast<std::size_t>(other)] != static_cast<int>(i)) continue;
      const FingerLine& its = shape.line(other);
      if (!its.is_there()) continue;
      const double its_gap = gap_between(*thumb, its);
      if (its_gap >= gap) continue;
      gap = its_gap;
      line = &its;
    }
    target.has_gap[f] = true;
    if (hand_->is_gripper) {
      target.gap[f] = hand_->opening * std::min(gap / kOpenGap, 1.0);
      target.touch[f] = 1.0;
      continue;
    }
    const double scale = (robot_thumb->length + finger.length) / (thumb->length + line->length);
    target.gap[f] = scale * gap * line->length;
    target.touch[f] = 1.0 - smooth_step(0.0, kFar, gap);
  }
}

HandShape relaxed_hand() {
  // Angles between bones and palm, radians: the knuckle bends by 30 degrees, the next joints by 35
  // and 15 degrees.
  constexpr std::array<double, 3> kBent = {0.5236, 1.1345, 1.3963};
  const std::array<Eigen::Vector3d, 3> thumb = {Eigen::Vector3d(0.72, 0.50, 0.48).normalized(),
                                                Eigen::Vector3d(0.86, 0.26, 0.44).normalized(),
                                                Eigen::Vector3d(0.91, 0.05, 0.41).normalized()};
  HandShape shape;
  for (const Finger finger : kFingers) {
    const GenericFinger& generic = generic_hand()[at(finger)];
    FingerLine& line = shape.line(finger);
    line.points[line.point_count++] = generic.knuckle;
    for (std::size_t bone = 0; bone < generic.bones.size(); ++bone) {
      const auto [sine, cosine] = portable::sin_cos(kBent[bone]);
      const Eigen::Vector3d way =
          finger == Finger::kThumb ? thumb[bone] : Eigen::Vector3d(cosine, 0.0, sine);
      line.points[line.point_count] = line.points[line.point_count - 1] + generic.bones[bone] * way;
      ++line.point_count;
      line.length += generic.bones[bone];
    }
  }
  return shape;
}

}  // namespace retarget
