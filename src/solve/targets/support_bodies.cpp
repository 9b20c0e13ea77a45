#include "solve/targets/support_bodies.h"

#include <array>
#include <optional>

#include "retarget/human.h"
#include "retarget/shape_distance.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

class SupportFinder {
 public:
  SupportFinder(const Robot& robot, const ResolvedConfig& config)
      : robot_(robot), config_(config), tree_(robot.tree()), state_(tree_) {
    state_.update(robot.zero_configuration());
    is_foot_.assign(tree_.links().size(), false);
    for (const Sole& sole : robot.profile().soles) {
      const int link = tree_.attachment(sole.body).link;
      if (link != KinematicTree::kWorld) is_foot_[static_cast<std::size_t>(link)] = true;
    }
  }

  [[nodiscard]] std::optional<SupportBody> find(std::size_t support) const {
    const Bone bone = kSupportBones[support];
    const auto origin = place_of(bone);
    if (!origin) return std::nullopt;
    SupportBody found;
    found.support = support;
    found.link = link_of(bone);
    if (!add_points(bone, *origin, found)) return std::nullopt;
    Vector3d middle = Vector3d::Zero();
    for (const SupportBody::Point& point : found.points) {
      middle += state_.world_from_link[point.link] * point.in_link;
    }
    middle /= static_cast<double>(found.points.size());
    found.middle = state_.world_from_link[found.link].inverse() * middle;
    return found;
  }

 private:
  [[nodiscard]] int link_of(Bone bone) const {
    return tree_.attachment(config_.body_of(bone)).link;
  }
  // Position in the zero configuration; empty if no body follows the bone.
  [[nodiscard]] std::optional<Vector3d> place_of(Bone bone) const {
    const int body = config_.body_of(bone);
    if (body < 0) return std::nullopt;
    const KinematicTree::Attachment& at = tree_.attachment(body);
    if (at.link == KinematicTree::kWorld) return std::nullopt;
    return state_.world_from_link[at.link] * at.link_from_body.translation;
  }
  [[nodiscard]] std::optional<Vector3d> place_of_any(std::array<Bone, 2> bones) const {
    const auto first = place_of(bones[0]);
    return first ? first : place_of(bones[1]);
  }

  // Collects the points at a distance of at most `reach` from `origin` on links that satisfy
  // `belongs`.
  template <typename Belongs>
  bool collect(const Vector3d& origin, double reach, const Belongs& belongs,
               SupportBody& found) const {
    for (const CollisionShape& shape : robot_.collision_shapes()) {
      const KinematicTree::Attachment& at = tree_.attachment(shape.body);
      if (at.link == KinematicTree::kWorld || is_foot_[static_cast<std::size_t>(at.link)]) continue;
      if (!belongs(at.link)) continue;
      for (const Vector3d& point : core_points(shape)) {
        const Vector3d in_link = at.link_from_body * point;
        if ((state_.world_from_link[at.link] * in_link - origin).norm() > reach) continue;
        found.points.push_back({at.link, in_link, shape.radius});
      }
    }
    return !found.points.empty();
  }

  bool add_points(Bone bone, const Vector3d& origin, SupportBody& found) const {
    constexpr double kUpperHalf = 0.5, kHandReach = 0.8, kSeatReach = 0.7;
    constexpr double kAnywhere = 1e9;
    const int own = found.link;
    const auto is_own = [&](int link) { return link == own; };
    const auto distance_to = [&](std::optional<Vector3d> place) {
      return place ? (*place - origin).norm() : 0.0;
    };
    if (bone == Bone::kSpine2) return collect(origin, kAnywhere, is_own, found);
    if (bone == Bone::kHips) {
      const Bone left = side_bone(Side::kLeft, LimbBone::kLeg);
      const Bone right = side_bone(Side::kRight, LimbBone::kLeg);
      const double reach = kSeatReach * distance_to(place_of_any({left, right}));
      const auto leads_to_leg = [&](int link) {
        return link == own || leads_to_thigh(Side::kLeft, link) ||
               leads_to_thigh(Side::kRight, link);
      };
      return collect(origin, reach, leads_to_leg, found);
    }
    const Side side = side_of(bone);
    if (limb_bone(bone) == LimbBone::kLeg) {
      const double shank = distance_to(
          place_of_any({side_bone(side, LimbBone::kFootMod), side_bone(side, LimbBone::kFoot)}));
      return collect(origin, kUpperHalf * shank, is_own, found);
    }
    if (limb_bone(bone) == LimbBone::kForeArm) {
      const double forearm = distance_to(place_of(side_bone(side, LimbBone::kHand)));
      return collect(origin, kUpperHalf * forearm, is_own, found);
    }
    const Bone forearm_bone = side_bone(side, LimbBone::kForeArm);
    const double forearm = distance_to(place_of(forearm_bone));
    if (!(forearm > 0.0)) return false;
    const int elbow = link_of(forearm_bone);
    // A hand without joints belongs to the link of its forearm.
    const auto is_hand = [&](int link) {
      return link == own || (link != elbow && tree_.carries(elbow, link));
    };
    return collect(origin, kHandReach * forearm, is_hand, found);
  }

  // Whether a link lies between the pelvis and a leg's knee.
  [[nodiscard]] bool leads_to_thigh(Side side, int link) const {
    const Bone knee = side_bone(side, LimbBone::kLeg);
    if (link == 0 || config_.body_of(knee) < 0) return false;
    const int shank = link_of(knee);
    return link != shank && tree_.carries(link, shank);
  }

  const Robot& robot_;
  const ResolvedConfig& config_;
  const KinematicTree& tree_;
  TreeState state_;
  std::vector<bool> is_foot_;
};

}  // namespace

SupportBody::Touch SupportBody::touch_of(const Point& point, const TreeState& pose) {
  const Vector3d place = pose.world_from_link[static_cast<std::size_t>(point.link)] * point.in_link;
  return {point.link, place, place.z() - point.radius};
}

SupportBody::Touch SupportBody::lowest(const TreeState& pose) const {
  Touch lowest{link, Vector3d::Zero(), HUGE_VAL};
  for (const Point& point : points) {
    const Touch touch = touch_of(point, pose);
    if (touch.height < lowest.height) lowest = touch;
  }
  return lowest;
}

SupportBody::SceneTouch SupportBody::nearest(const TreeState& pose, const SceneWorld& world,
                                             int frame, std::size_t scene_body) const {
  SceneTouch nearest{link, Vector3d::Zero(), Vector3d::UnitZ(), HUGE_VAL};
  for (const Point& point : points) {
    const Vector3d place =
        pose.world_from_link[static_cast<std::size_t>(point.link)] * point.in_link;
    const SurfaceDistance found = world.distance(frame, scene_body, place);
    if (found.distance - point.radius >= nearest.distance) continue;
    nearest = {point.link, place, found.normal, found.distance - point.radius};
  }
  return nearest;
}

std::vector<SupportBody> support_bodies(const Robot& robot, const ResolvedConfig& config) {
  const SupportFinder finder(robot, config);
  std::vector<SupportBody> bodies;
  for (std::size_t i = 0; i < kSupportBones.size(); ++i) {
    if (auto body = finder.find(i)) bodies.push_back(std::move(*body));
  }
  return bodies;
}

}  // namespace retarget
