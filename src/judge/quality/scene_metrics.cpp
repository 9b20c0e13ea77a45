#include "judge/quality/scene_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "human/gait/surface_contacts.h"
#include "retarget/kinematic_tree.h"
#include "retarget/shape_distance.h"
#include "retarget/statistics.h"
#include "solve/targets/support_bodies.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kPenetration = 0.01;  // Depth that a metric counts, metres.
constexpr double kKept = 0.03;         // Distance up to which a contact is kept, metres.
constexpr double kTouch = 0.02;        // Distance up to which a part of the robot touches, metres.
constexpr int kLateness = 2;           // Frames by which a contact may be early or late.

// A point of a collision shape or of a sole, in the frame of its link.
struct Probe {
  Vector3d in_link;
  double radius = 0.0;
};

// Adds a grid of points in the core of a shape, at most `spacing` apart.
void add_probes(const RoundedShape& shape, double spacing, std::vector<Probe>& probes) {
  std::array<int, 3> counts{1, 1, 1};
  for (int axis = 0; axis < shape.axis_count; ++axis) {
    const double length = 2.0 * shape.half_axes[static_cast<std::size_t>(axis)].norm();
    counts[static_cast<std::size_t>(axis)] = 1 + static_cast<int>(std::ceil(length / spacing));
  }
  const auto along = [&](std::size_t axis, int i) -> Vector3d {
    if (counts[axis] == 1) return Vector3d::Zero();
    return (2.0 * i / (counts[axis] - 1) - 1.0) * shape.half_axes[axis];
  };
  const auto inner = [&](std::size_t axis, int i) { return i > 0 && i < counts[axis] - 1; };
  for (int i = 0; i < counts[0]; ++i) {
    for (int j = 0; j < counts[1]; ++j) {
      for (int k = 0; k < counts[2]; ++k) {
        // Inner points of a box are not needed.
        if (shape.axis_count == 3 && inner(0, i) && inner(1, j) && inner(2, k)) continue;
        probes.push_back({shape.centre + along(0, i) + along(1, j) + along(2, k), shape.radius});
      }
    }
  }
}

class SceneMeter {
 public:
  SceneMeter(const ReportBuilder& draft, const ResolvedConfig& config, const SceneSource& source,
             int frames)
      : draft_(draft),
        robot_(draft.clip.robot()),
        source_(source),
        world_(source.around_robot != nullptr ? *source.around_robot
                                              : scaled_world(source.world, source.scale)),
        supports_(support_bodies(robot_, config)),
        frames_(std::min({frames, draft.clip.frame_count(), world_.clip.frame_count})),
        state_(robot_.tree()),
        deep_("scene_pen_1cm_pct", "m"),
        away_("scene_contact_kept_pct", "m"),
        slipping_("scene_slip_mean", "m/s") {
    collect_probes();
    collect_contacts();
  }

  [[nodiscard]] std::vector<char> measure() {
    for (int frame = 0; frame < frames_; ++frame) {
      state_.update(draft_.clip.qpos(frame));
      measure_penetration(frame);
      measure_parts(frame);
    }
    measure_feet();
    write();
    return std::move(touches_);
  }

 private:
  [[nodiscard]] std::size_t index(std::size_t support, std::size_t body) const {
    return support * world_.body_count() + body;
  }
  [[nodiscard]] const std::string& link_name(int link) const {
    return robot_
        .bodies()[static_cast<std::size_t>(
            robot_.tree().links()[static_cast<std::size_t>(link)].body)]
        .name;
  }

  void collect_probes() {
    constexpr double kSpacing = 0.015;  // Metres.
    probes_.resize(robot_.tree().links().size());
    for (const CollisionShape& shape : robot_.collision_shapes()) {
      const KinematicTree::Attachment& at = robot_.tree().attachment(shape.body);
      if (at.link == KinematicTree::kWorld) continue;
      add_probes(placed(rounded(shape), at.link_from_body), kSpacing,
                 probes_[static_cast<std::size_t>(at.link)]);
    }
    for (const Sole& sole : robot_.profile().soles) {
      const KinematicTree::Attachment& at = robot_.tree().attachment(sole.body);
      if (at.link == KinematicTree::kWorld) continue;
      const auto link = static_cast<std::size_t>(at.link);
      for (const Vector3d& point : sole.points) {
        probes_[link].push_back({at.link_from_body * point, 0.0});
      }
    }
    spheres_.resize(probes_.size());
    for (std::size_t link = 0; link < probes_.size(); ++link) {
      for (const Probe& probe : probes_[link]) {
        spheres_[link] = std::max(spheres_[link], probe.in_link.norm() + probe.radius);
      }
    }
  }

  void collect_contacts() {
    SurfaceParts parts(source_.human, source_.contacts.scale);
    for (int frame = 0; frame < frames_; ++frame) parts.add(source_.human.frame(frame));
    phases_ = find_surface_contacts(source_.world, parts, source_.contacts, {},
                                    draft_.clip.rate().frame_time() / source_.pace);
    const auto count = static_cast<std::size_t>(frames_);
    human_touches_.assign(supports_.size() * world_.body_count(), std::vector<char>(count, 0));
    robot_touches_ = human_touches_;
    sticks_ = human_touches_;
    for (const SurfacePhase& phase : phases_) {
      for (std::size_t support = 0; support < supports_.size(); ++support) {
        if (supports_[support].support != phase.part) continue;
        for (int frame = phase.begin; frame < std::min(phase.end, frames_); ++frame) {
          human_touches_[index(support, phase.body)][static_cast<std::size_t>(frame)] = 1;
          if (!phase.slides && frame > phase.begin) {
            sticks_[index(support, phase.body)][static_cast<std::size_t>(frame)] = 1;
          }
        }
      }
    }
  }

  void measure_penetration(int frame) {
    double deepest = -HUGE_VAL;
    int where = 0;
    for (std::size_t link = 0; link < probes_.size(); ++link) {
      if (probes_[link].empty()) continue;
      const Pose& world_from_link = state_.world_from_link[link];
      for (std::size_t body = 0; body < world_.body_count(); ++body) {
        if (world_.distance(frame, body, world_from_link.translation).distance >
            spheres_[link] + kTouch) {
          continue;
        }
        for (const Probe& probe : probes_[link]) {
          const double depth =
              probe.radius - world_.distance(frame, body, world_from_link * probe.in_link).distance;
          if (depth <= deepest) continue;
          deepest = depth;
          where = static_cast<int>(link);
        }
      }
    }
    touches_.push_back(deepest > -kTouch ? 1 : 0);
    deepest_ = std::max(deepest_, deepest);
    if (deepest <= kPenetration) return;
    ++deep_frames_;
    deep_.add(link_name(where), frame, deepest);
  }

  void measure_parts(int frame) {
    std::vector<Vector3d> places(human_touches_.size());
    for (std::size_t support = 0; support < supports_.size(); ++support) {
      const SupportBody& body = supports_[support];
      for (std::size_t of_scene = 0; of_scene < world_.body_count(); ++of_scene) {
        const SupportBody::SceneTouch touch = body.nearest(state_, world_, frame, of_scene);
        const std::size_t pair = index(support, of_scene);
        const auto at_frame = static_cast<std::size_t>(frame);
        robot_touches_[pair][at_frame] = touch.distance < kTouch ? 1 : 0;
        places[pair] = world_.clip.pose(frame, of_scene).inverse() * body.world_middle(state_);
        if (human_touches_[pair][at_frame] == 0) continue;
        add_kept(link_name(body.link), frame, touch.distance);
        if (sticks_[pair][at_frame] == 0 || last_places_.empty()) continue;
        const double slip =
            slip_of(frame, of_scene, places[pair] - last_places_[pair], touch.normal);
        slips_.push_back(slip);
        if (slip > 0.1) slipping_.add(link_name(body.link), frame, slip);
      }
    }
    last_places_ = std::move(places);
  }

  // Speed along the surface, m/s.
  // @param step    displacement since the last frame, in the frame of the scene's body, metres.
  // @param normal  surface normal, world.
  [[nodiscard]] double slip_of(int frame, std::size_t body, const Vector3d& step,
                               const Vector3d& normal) const {
    const Vector3d in_world = world_.clip.pose(frame, body).rotation * step;
    return (in_world - normal * normal.dot(in_world)).norm() * draft_.clip.rate().fps();
  }

  void add_kept(const std::string& name, int frame, double distance) {
    gaps_.push_back(std::abs(distance));
    if (distance < kKept) {
      ++kept_;
    } else {
      away_.add(name, frame, distance);
    }
  }

  // Measures the feet while the source's feet stand on bodies of the scene.
  void measure_feet() {
    for (const Sole& sole : robot_.profile().soles) {
      const std::size_t side = sole.side == "left" ? 0 : 1;
      const KinematicTree::Attachment& at = robot_.tree().attachment(sole.body);
      if (at.link == KinematicTree::kWorld) continue;
      for (const ContactPhase& phase : source_.contacts.soles[side]) {
        if (phase.support <= kKept) continue;
        for (int frame = phase.begin; frame < std::min(phase.end, frames_); ++frame) {
          state_.update(draft_.clip.qpos(frame));
          double distance = HUGE_VAL;
          for (const Vector3d& point : sole.points) {
            const Vector3d place = state_.world_from_link[static_cast<std::size_t>(at.link)] *
                                   (at.link_from_body * point);
            for (std::size_t body = 0; body < world_.body_count(); ++body) {
              distance = std::min(distance, world_.distance(frame, body, place).distance);
            }
          }
          add_kept(link_name(at.link), frame, distance);
        }
      }
    }
  }

  // Whether a frame at most kLateness away has a contact.
  [[nodiscard]] static bool near(const std::vector<char>& touches, std::size_t frame) {
    const auto from = frame >= kLateness ? frame - kLateness : 0;
    const auto to = std::min(touches.size(), frame + kLateness + 1);
    return std::any_of(touches.begin() + static_cast<std::ptrdiff_t>(from),
                       touches.begin() + static_cast<std::ptrdiff_t>(to),
                       [](char touch) { return touch != 0; });
  }

  // Percentage of the contacts in `of` that `in` also contains.
  [[nodiscard]] static double found_in(const std::vector<std::vector<char>>& of,
                                       const std::vector<std::vector<char>>& in) {
    double all = 0.0, found = 0.0;
    for (std::size_t pair = 0; pair < of.size(); ++pair) {
      for (std::size_t frame = 0; frame < of[pair].size(); ++frame) {
        if (of[pair][frame] == 0) continue;
        ++all;
        if (near(in[pair], frame)) ++found;
      }
    }
    return all > 0.0 ? percent(found, all) : 100.0;
  }

  void write() {
    draft_.set("scene_pen_1cm_pct", percent(deep_frames_, frames_));
    draft_.set("scene_pen_max_cm", kInCm * deepest_);
    deep_.move_to(draft_.report, draft_.options.faults_per_metric);
    draft_.set("scene_contact_pct", percent(static_cast<double>(gaps_.size()), frames_));
    const bool touches = !gaps_.empty();
    draft_.set("scene_contact_kept_pct",
               touches ? percent(kept_, static_cast<double>(gaps_.size())) : 100.0);
    if (!touches) gaps_.push_back(0.0);
    draft_.set("scene_gap_p95_cm", kInCm * percentile(std::move(gaps_), 95.0));
    draft_.set("scene_contact_precision_pct", found_in(robot_touches_, human_touches_));
    draft_.set("scene_contact_recall_pct", found_in(human_touches_, robot_touches_));
    draft_.set("scene_slip_mean", slips_.empty() ? 0.0 : mean(slips_));
    away_.move_to(draft_.report, draft_.options.faults_per_metric);
    slipping_.move_to(draft_.report, draft_.options.faults_per_metric);
  }

  const ReportBuilder& draft_;
  const Robot& robot_;
  const SceneSource& source_;
  SceneWorld world_;  // Scene around the robot.
  std::vector<SupportBody> supports_;
  int frames_ = 0;
  TreeState state_;
  std::vector<std::vector<Probe>> probes_;  // One per link.
  std::vector<double> spheres_;             // One per link: reach of its probes, metres.
  std::vector<SurfacePhase> phases_;
  // By pair of support body and scene body (index()), then by frame.
  std::vector<std::vector<char>> human_touches_, robot_touches_, sticks_;
  std::vector<Vector3d> last_places_;
  std::vector<double> gaps_, slips_;
  std::vector<char> touches_;  // One per frame: whether a part of the robot touches the scene.
  double deepest_ = 0.0, deep_frames_ = 0.0, kept_ = 0.0;
  FaultList deep_, away_, slipping_;
};

}  // namespace

std::vector<char> measure_scene(const ReportBuilder& draft, const ResolvedConfig& config,
                                const SceneSource& source, int frames) {
  return SceneMeter(draft, config, source, frames).measure();
}

}  // namespace retarget
