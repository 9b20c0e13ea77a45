#include "solve/fit/fit_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "retarget/pose.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// Tolerated penetration of soles, which stand on surfaces, metres.
constexpr double kSoleDepth = 0.002;
// Largest number of spheres along one axis of a shape.
constexpr int kMostAlongAxis = 6;

// Covers a shape with a grid of spheres along its axes, about one radius apart. The spheres of a
// box have its smallest half size as their radius; its corners are added as points.
void cover(const FitShape& shape, std::vector<FloorPoint>& points) {
  const int axes = shape.axis_count;
  double radius = shape.radius;
  std::array<Vector3d, 3> half_axes = shape.half_axes;
  if (axes == 3) {
    double smallest = std::numeric_limits<double>::infinity();
    for (const Vector3d& axis : half_axes) smallest = std::min(smallest, axis.norm());
    for (Vector3d& axis : half_axes) axis *= 1.0 - smallest / axis.norm();
    radius += smallest;
    for (int corner = 0; corner < 8; ++corner) {
      Vector3d point = shape.centre;
      for (int axis = 0; axis < 3; ++axis) {
        point += ((corner >> axis) & 1) != 0 ? shape.half_axes[at(axis)]
                                             : Vector3d(-shape.half_axes[at(axis)]);
      }
      points.push_back({point, shape.radius});
    }
  }
  std::array<int, 3> counts{1, 1, 1};
  for (int axis = 0; axis < axes; ++axis) {
    const double length = 2.0 * half_axes[at(axis)].norm();
    if (length < 1e-6) continue;
    counts[at(axis)] =
        std::min(kMostAlongAxis, 2 + static_cast<int>(length / std::max(radius, 0.01)));
  }
  const auto along = [&](int axis, int i) -> Vector3d {
    if (counts[at(axis)] == 1) return Vector3d::Zero();
    return (2.0 * i / (counts[at(axis)] - 1) - 1.0) * half_axes[at(axis)];
  };
  for (int i = 0; i < counts[0]; ++i) {
    for (int j = 0; j < counts[1]; ++j) {
      for (int k = 0; k < counts[2]; ++k) {
        points.push_back({shape.centre + along(0, i) + along(1, j) + along(2, k), radius});
      }
    }
  }
}

// Makes the goals for the frames of a contact, and for the frames before and after it, in which the
// robot approaches and leaves the surface like its human.
class GoalPlanner {
 public:
  GoalPlanner(const FitModel& model, std::span<const TaskTarget> targets,
              const SceneWorld& human_world, const SceneWorld& world, const SurfaceParts& parts,
              double scale, double frame_time)
      : model_(model),
        targets_(targets),
        human_world_(human_world),
        world_(world),
        parts_(parts),
        scale_(scale),
        blend_(std::max(1, static_cast<int>(std::lround(kBlendTime / frame_time)))),
        by_frame_(at(world.clip.frame_count)) {}

  void add(const SurfacePhase& phase, int support) {
    const int frames = static_cast<int>(by_frame_.size());
    const int begin = std::max(0, phase.begin - blend_);
    const int end = std::min(frames, phase.end + blend_);
    const double size = world_.scales[phase.body] / human_world_.scales[phase.body];
    const Vector3d facing = facing_of(phase, support, size);
    for (int frame = begin; frame < end; ++frame) {
      const int away = std::max({0, phase.begin - frame, frame - phase.end + 1});
      const int inside = std::clamp(frame, phase.begin, phase.end - 1);
      const Pose& pose = world_.clip.pose(frame, phase.body);
      SceneGoal goal{support, static_cast<int>(phase.body)};
      const double ramp = 1.0 - static_cast<double>(away) / (blend_ + 1);
      goal.share = ramp * ramp * (3.0 - 2.0 * ramp);
      goal.phase = phases_;
      goal.sticks = !phase.slides;
      const Vector3d in_body = phase.places[at(inside - phase.begin)];
      goal.place = pose * (size * in_body);
      goal.normal = world_.distance(frame, phase.body, goal.place).normal;
      goal.facing = facing;
      if (away > 0) approach(phase, frame, inside, goal);
      merge(goal, by_frame_[at(frame)]);
    }
    ++phases_;
  }

  void write(FitScene& scene) const {
    scene.first_goal.push_back(0);
    for (const auto& goals : by_frame_) {
      scene.goals.insert(scene.goals.end(), goals.begin(), goals.end());
      scene.first_goal.push_back(static_cast<std::uint32_t>(scene.goals.size()));
    }
  }

 private:
  static constexpr double kBlendTime = 0.25;  // Seconds.

  // Mean direction, in the frame of a hand's link, from the human's hand to the object that it
  // holds. Zero if the hand turns relative to the object, if the robot has no wrist, and for other
  // body parts. Also zero for static bodies, so that a climber's hands may turn as the robot's arms
  // require.
  [[nodiscard]] Vector3d facing_of(const SurfacePhase& phase, int support, double size) const {
    constexpr double kTurns = 0.9;  // Length of the mean direction; 1 if the hand does not turn.
    const Bone bone = kSupportBones[phase.part];
    const bool holds = bone == Bone::kLeftHand || bone == Bone::kRightHand;
    if (!holds || !world_.moves(phase.body)) return Vector3d::Zero();
    const auto task = std::ranges::find_if(model_.tasks, [&](const FitTask& each) {
      return each.bone == bone && each.link == model_.supports[at(support)].link;
    });
    if (task == model_.tasks.end() || !has_wrist(task->link, bone)) return Vector3d::Zero();
    const auto index = at(static_cast<int>(task - model_.tasks.begin()));
    Vector3d sum = Vector3d::Zero();
    for (int frame = phase.begin; frame < phase.end; ++frame) {
      const Vector3d place =
          world_.clip.pose(frame, phase.body) * (size * phase.places[at(frame - phase.begin)]);
      const Eigen::Quaterniond& rotation =
          targets_[at(frame) * model_.tasks.size() + index].world_from_link;
      sum -= rotation.conjugate() * world_.distance(frame, phase.body, place).normal;
    }
    const double length = sum.norm();
    if (!(length > kTurns * (phase.end - phase.begin))) return Vector3d::Zero();
    return sum / length;
  }

  // Whether at least two joints turn the hand relative to the forearm; a direction has two degrees
  // of freedom.
  [[nodiscard]] bool has_wrist(int hand, Bone bone) const {
    const Bone forearm = bone == Bone::kLeftHand ? Bone::kLeftForeArm : Bone::kRightForeArm;
    const auto task = std::ranges::find(model_.tasks, forearm, &FitTask::bone);
    if (task == model_.tasks.end()) return false;
    int joints = 0;
    for (int link = hand; link > 0 && link != task->link; ++joints) {
      link = model_.tree.links()[at(link)].parent;
    }
    return joints >= 2;
  }

  // Moves the goal by the scaled displacement of the human's part from its contact position.
  void approach(const SurfacePhase& phase, int frame, int inside, SceneGoal& goal) const {
    const auto nearest = parts_.nearest(human_world_, frame, phase.part, phase.body);
    const auto touching = parts_.nearest(human_world_, inside, phase.part, phase.body);
    goal.distance = std::max(0.0, scale_ * (nearest.distance - touching.distance));
    const auto in_body = [&](int at_frame, const Vector3d& point) -> Vector3d {
      return human_world_.clip.pose(at_frame, phase.body).inverse() * point;
    };
    const Vector3d moved =
        in_body(frame, nearest.on_surface) - in_body(inside, touching.on_surface);
    goal.place += scale_ * (world_.clip.pose(frame, phase.body).rotation * moved);
  }

  // Keeps only the goal with the larger share if contacts of the same part and body overlap.
  static void merge(const SceneGoal& goal, std::vector<SceneGoal>& goals) {
    for (SceneGoal& other : goals) {
      if (other.support != goal.support || other.body != goal.body) continue;
      if (goal.share > other.share) other = goal;
      return;
    }
    goals.push_back(goal);
  }

  const FitModel& model_;
  std::span<const TaskTarget> targets_;
  const SceneWorld &human_world_, &world_;
  const SurfaceParts& parts_;
  double scale_;
  int blend_;
  int phases_ = 0;
  std::vector<std::vector<SceneGoal>> by_frame_;
};

}  // namespace

FitScene make_fit_scene(const FitModel& model, const SceneWorld& human_world,
                        const SurfaceParts& parts, std::span<const SurfacePhase> phases,
                        double scale, double frame_time, std::span<const TaskTarget> targets) {
  FitScene scene;
  scene.world = scaled_world(human_world, scale);
  scene.points.resize(model.tree.links().size());
  scene.spheres.resize(scene.points.size());
  for (const FitShape& shape : model.shapes) cover(shape, scene.points[at(shape.link)]);
  for (const FitFoot& foot : model.feet) {
    for (const FitFoot::End& end : foot.ends) {
      for (const Vector3d& point : end.points) {
        // With the margin of feet, -kFootShapeDepth, the sole may penetrate by kSoleDepth.
        scene.points[at(foot.link)].push_back({point, kFootShapeDepth - kSoleDepth});
      }
    }
  }
  for (std::size_t link = 0; link < scene.points.size(); ++link) {
    BoundingSphere& sphere = scene.spheres[link];
    Eigen::AlignedBox3d box;
    for (const FloorPoint& point : scene.points[link]) box.extend(point.position);
    if (box.isEmpty()) continue;
    sphere.centre = box.center();
    for (const FloorPoint& point : scene.points[link]) {
      sphere.radius = std::max(
          sphere.radius, (point.position - sphere.centre).norm() + std::max(0.0, point.radius));
    }
  }
  GoalPlanner planner(model, targets, human_world, scene.world, parts, scale, frame_time);
  for (const SurfacePhase& phase : phases) {
    for (std::size_t support = 0; support < model.supports.size(); ++support) {
      if (model.supports[support].support == phase.part) {
        planner.add(phase, static_cast<int>(support));
      }
    }
  }
  planner.write(scene);
  scene.joint_smoothness.assign(at(scene.world.clip.frame_count), 1.0);
  return scene;
}

std::vector<double> smoothness_near_contacts(const SolvedScene& solved, const ContactPlan& contacts,
                                             int frame_count, double frame_time) {
  // Near contacts, this divides the accelerations of two climbs by three and keeps as many contacts
  // (docs/world.md).
  constexpr double kWeight = 2.5;
  // Seconds before and after a contact: with the highest weight, and until the usual one.
  constexpr double kHold = 0.25, kFall = 0.25;
  std::vector<double> away(at(frame_count), std::numeric_limits<double>::infinity());
  const auto touch = [&](int begin, int end) {
    for (int frame = std::max(0, begin); frame < std::min(end, frame_count); ++frame) {
      away[at(frame)] = 0.0;
    }
  };
  for (const SceneContact& each : solved.contacts) touch(each.begin, each.end);
  const SourceContacts ends = contacts.of_ends();
  for (std::size_t i = 0; i < ends.size(); ++i) {
    for (std::size_t phase = 0; phase < ends[i].size(); ++phase) {
      if (solved.under_feet[i][phase] >= 0) touch(ends[i][phase].begin, ends[i][phase].end);
    }
  }
  // The time from the nearest frame with a contact.
  for (std::size_t i = 1; i < away.size(); ++i) {
    away[i] = std::min(away[i], away[i - 1] + frame_time);
  }
  for (std::size_t i = away.size() - 1; i-- > 0;) {
    away[i] = std::min(away[i], away[i + 1] + frame_time);
  }
  for (double& each : away) {
    const double share = std::clamp(1.0 - (each - kHold) / kFall, 0.0, 1.0);
    each = square(1.0 + (kWeight - 1.0) * share * share * (3.0 - 2.0 * share));
  }
  return away;
}

bool hold_contacts(const FitModel& model, std::span<const double> qpos, FitScene& scene) {
  struct Place {
    Vector3d goals = Vector3d::Zero(),
             robot = Vector3d::Zero();  // Sums of positions, in the frame of the scene's body.
    int frames = 0;
  };
  std::vector<Place> places;
  TreeState pose(model.tree);
  const auto in_body = [&](int frame, const SceneGoal& goal, const Vector3d& point) -> Vector3d {
    return scene.world.clip.pose(frame, at(goal.body)).inverse() * point;
  };
  for (int frame = 0; frame < scene.world.clip.frame_count; ++frame) {
    if (scene.goals_of(frame).empty()) continue;
    pose.update(
        qpos.subspan(at(frame) * at(model.configuration_size), at(model.configuration_size)));
    for (const SceneGoal& goal : scene.goals_of(frame)) {
      if (!goal.sticks || goal.share < 1.0) continue;
      if (at(goal.phase) >= places.size()) places.resize(at(goal.phase) + 1);
      Place& place = places[at(goal.phase)];
      const Vector3d middle = model.supports[at(goal.support)].world_middle(pose);
      place.goals += in_body(frame, goal, goal.place);
      place.robot += in_body(frame, goal, middle);
      ++place.frames;
    }
  }
  for (int frame = 0; frame < scene.world.clip.frame_count; ++frame) {
    for (std::uint32_t i = scene.first_goal[at(frame)]; i < scene.first_goal[at(frame) + 1]; ++i) {
      SceneGoal& goal = scene.goals[i];
      if (!goal.sticks || at(goal.phase) >= places.size()) continue;
      const Place& place = places[at(goal.phase)];
      if (place.frames == 0) continue;
      const Pose& world_from_body = scene.world.clip.pose(frame, at(goal.body));
      goal.place += world_from_body.rotation * ((place.robot - place.goals) / place.frames);
      goal.normal = scene.world.distance(frame, at(goal.body), goal.place).normal;
      goal.held = true;
    }
  }
  return std::ranges::any_of(places, [](const Place& place) { return place.frames > 0; });
}

}  // namespace retarget
