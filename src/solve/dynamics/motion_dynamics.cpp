#include "solve/dynamics/motion_dynamics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "retarget/statistics.h"
#include "solve/dynamics/contact_forces.h"
#include "solve/dynamics/motion_spline.h"
#include "solve/dynamics/scene_supports.h"
#include "solve/dynamics/support_points.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kSamplesPerSecond = 120.0;
// Values for a robot as large as a G1.
constexpr double kContactHeight = 0.02;  // Metres.
constexpr double kContactSpeed = 0.5;    // Metres per second.
constexpr double kCarryReach = 0.04;  // Metres between a lifted body and the links that carry it.
constexpr double kNeighbour = 1.0 / 30.0;  // Seconds.
// Share of the weight that must be held for ZMP and friction to be defined.
constexpr double kMinHeld = 0.2;
constexpr double kBadForce = 0.1;    // Share of the weight.
constexpr double kBadTorque = 0.03;  // Metres x weight, for a robot as large as a G1.

// Scales of lengths and speeds relative to a G1. In a time proportional to the square root of its
// size, all bodies fall by the same multiple of their lengths.
struct Sizes {
  double length = 1.0, speed = 1.0;

  explicit Sizes(double size) : length(size), speed(std::sqrt(size)) {}
};

// The surface that may push a point: none, the floor, or that of the body kFirstBody + i.
using Surface = std::uint16_t;
constexpr Surface kNothing = 0, kFloor = 1, kFirstBody = 2;

// Positions of all points at all samples, and the samples at which each point may be a contact.
class SupportTracks {
 public:
  SupportTracks(const std::vector<SupportPoint>& points, std::size_t samples)
      : points_(&points), places_(points.size() * samples), pushed_by_(places_.size(), kNothing) {}

  void set(std::size_t sample, const TreeState& state) {
    for (std::size_t p = 0; p < points_->size(); ++p) {
      places_[sample * points_->size() + p] = lowest_of((*points_)[p], state);
    }
  }

  [[nodiscard]] const Vector3d& at(std::size_t sample, std::size_t point) const {
    return places_[sample * points_->size() + point];
  }

  [[nodiscard]] std::span<const Vector3d> at(std::size_t sample) const {
    return std::span(places_).subspan(sample * points_->size(), points_->size());
  }

  void find_contacts(double floor, double rate, const Sizes& sizes) {
    const std::size_t count = points_->size(), samples = places_.size() / count;
    for (std::size_t p = 0; p < count; ++p) {
      for (std::size_t i = 0; i < samples; ++i) {
        const bool low = at(i, p).z() - floor < kContactHeight * sizes.length;
        const bool slow = velocity(i, p).norm() * rate < kContactSpeed * sizes.speed;
        if (low && slow) mark(i, p, kFloor, rate);
      }
    }
  }

  // Adds the contacts with bodies of the scene; the floor has precedence. @param frame_of  the frame
  // of the scene for each sample
  template <typename FrameOf>
  void find_contacts(const SceneSupports& scene, const FrameOf& frame_of, double rate,
                     const Sizes& sizes) {
    const std::size_t count = points_->size(), samples = places_.size() / count;
    for (std::size_t i = 0; i < samples; ++i) {
      for (std::size_t p = 0; p < count; ++p) {
        const auto body =
            scene.touched(frame_of(i), centre(i, p), (*points_)[p].radius, velocity(i, p) * rate,
                          kContactHeight * sizes.length, kContactSpeed * sizes.speed);
        if (body) mark(i, p, static_cast<Surface>(kFirstBody + *body), rate);
      }
    }
  }

  // The centre of a point's ball.
  [[nodiscard]] Vector3d centre(std::size_t sample, std::size_t point) const {
    return at(sample, point) + (*points_)[point].radius * Vector3d::UnitZ();
  }

  [[nodiscard]] Surface surface(std::size_t sample, int point) const {
    return pushed_by_[sample * points_->size() + static_cast<std::size_t>(point)];
  }

  void list_contacts(std::size_t sample, std::vector<int>& chosen) const {
    chosen.clear();
    const std::size_t count = points_->size();
    for (std::size_t p = 0; p < count; ++p) {
      if (pushed_by_[sample * count + p] != kNothing) chosen.push_back(static_cast<int>(p));
    }
    keep_outermost(at(sample), ContactForces::kMaxPoints, chosen);
  }

 private:
  // A contact counts a little before and after as well.
  void mark(std::size_t sample, std::size_t point, Surface surface, double rate) {
    const std::size_t count = points_->size(), samples = places_.size() / count;
    const auto reach = static_cast<std::size_t>(std::lround(kNeighbour * rate));
    const std::size_t end = std::min(samples, sample + reach + 1);
    for (std::size_t k = sample < reach ? 0 : sample - reach; k < end; ++k) {
      Surface& pushed = pushed_by_[k * count + point];
      if (pushed == kNothing) pushed = surface;
    }
  }

  // Velocity of a point, metres per sample.
  [[nodiscard]] Vector3d velocity(std::size_t sample, std::size_t point) const {
    const std::size_t samples = places_.size() / points_->size();
    const std::size_t before = sample == 0 ? 0 : sample - 1;
    const std::size_t after = std::min(sample + 1, samples - 1);
    if (after == before) return Vector3d::Zero();
    return (at(after, point) - at(before, point)) / static_cast<double>(after - before);
  }

  const std::vector<SupportPoint>* points_;
  std::vector<Vector3d> places_;    // Sample-major.
  std::vector<Surface> pushed_by_;  // Sample-major.
};

// Median height of the standing soles: flat, slow and near the floor.
double standing_height(const SupportTracks& tracks, const std::vector<SupportPoint>& points,
                       std::size_t samples, double rate, const Sizes& sizes) {
  const double slow = 0.15 * sizes.speed;
  const double flat = 0.02 * sizes.length, top = 0.08 * sizes.length;
  const double bottom = -0.06 * sizes.length;
  constexpr double kMinSeconds = 0.5;
  std::vector<double> heights;
  for (std::size_t begin = 0; begin < points.size() && points[begin].of_sole;) {
    std::size_t end = begin;
    while (end < points.size() && points[end].of_sole && points[end].link == points[begin].link)
      ++end;
    const auto middle = [&](std::size_t sample) {
      Vector3d sum = Vector3d::Zero();
      for (std::size_t p = begin; p < end; ++p) sum += tracks.at(sample, p);
      return Vector3d(sum / static_cast<double>(end - begin));
    };
    for (std::size_t i = 1; i + 1 < samples; ++i) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (std::size_t p = begin; p < end; ++p) {
        low = std::min(low, tracks.at(i, p).z());
        high = std::max(high, tracks.at(i, p).z());
      }
      if (high - low >= flat || low >= top || low <= bottom) continue;
      if ((middle(i + 1) - middle(i - 1)).norm() * rate / 2.0 < slow) {
        heights.push_back(middle(i).z());
      }
    }
    begin = end;
  }
  if (static_cast<double>(heights.size()) < kMinSeconds * rate) return 0.0;
  return median(std::move(heights));
}

// Torque limits by link of the tree; infinity if unknown.
std::vector<double> torque_limits_of(const Robot& robot) {
  const auto& links = robot.tree().links();
  std::vector<double> limits(links.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 1; i < links.size(); ++i) limits[i] = robot.torque_limit(links[i].joint);
  return limits;
}

class Analyser {
 public:
  Analyser(const RobotClip& clip, const SceneWorld* scene)
      : clip_(clip),
        spline_(clip),
        inertias_(make_inertias(clip.robot())),
        points_(make_support_points(clip.robot())),
        torque_limits_(torque_limits_of(clip.robot())),
        sizes_(body_size(clip.robot())),
        motion_(clip.robot()),
        state_(clip.robot().tree()),
        inverse_(clip.robot().tree(), inertias_),
        contacts_(clip.robot().tree(), torque_limits_, inertias_.mass * kGravity,
                  ContactForces::kLever * sizes_.length) {
    if (scene != nullptr && scene->clip.frame_count > 0)
      scene_.emplace(*scene, 0, scene->clip.frame_count);
    result_.samples_per_frame =
        std::max(1, static_cast<int>(std::lround(kSamplesPerSecond / clip.rate().fps())));
    result_.weight = inertias_.mass * kGravity;
    result_.knows_torque_limits =
        std::ranges::any_of(torque_limits_, [](double limit) { return std::isfinite(limit); });
  }

  MotionDynamics run() {
    if (clip_.frame_count() < 3 || inertias_.mass <= 0.0) return result_;
    const std::size_t samples = static_cast<std::size_t>(clip_.frame_count() - 1) *
                                static_cast<std::size_t>(result_.samples_per_frame);
    const double rate = clip_.rate().fps() * result_.samples_per_frame;
    SupportTracks tracks(points_, samples);
    for (std::size_t i = 0; i < samples; ++i) {
      place(i);
      tracks.set(i, state_);
    }
    if (!points_.empty()) {
      result_.floor_height = standing_height(tracks, points_, samples, rate, sizes_);
      tracks.find_contacts(result_.floor_height, rate, sizes_);
      if (scene_) {
        const auto frame_of = [this](std::size_t sample) { return scene_frame(sample); };
        tracks.find_contacts(*scene_, frame_of, rate, sizes_);
      }
    }
    result_.samples.resize(samples);
    for (std::size_t i = 0; i < samples; ++i) measure(i, tracks);
    return std::move(result_);
  }

 private:
  void place(std::size_t sample) {
    const int frame = result_.frame_of(sample);
    const int within = static_cast<int>(sample) % result_.samples_per_frame;
    spline_.sample(frame, static_cast<double>(within) / result_.samples_per_frame, motion_);
    state_.update(motion_.qpos);
  }

  // The frame of the scene that is nearest to a sample.
  [[nodiscard]] int scene_frame(std::size_t sample) const {
    const int within = static_cast<int>(sample) % result_.samples_per_frame;
    return result_.frame_of(sample) + (2 * within >= result_.samples_per_frame ? 1 : 0);
  }

  void add_place(std::size_t index, int point, const SupportTracks& tracks) {
    const auto p = static_cast<std::size_t>(point);
    const Surface surface = tracks.surface(index, point);
    supports_.push_back(&points_[p]);
    if (surface == kFloor) {
      places_.push_back({tracks.at(index, p)});
    } else {
      on_floor_ = false;
      places_.push_back(scene_->place(scene_frame(index), tracks.centre(index, p),
                                      points_[p].radius,
                                      static_cast<std::size_t>(surface - kFirstBody)));
    }
  }

  void measure(std::size_t index, const SupportTracks& tracks) {
    place(index);
    if (scene_) {
      scene_->find_loads(scene_frame(index), points_, state_, kCarryReach * sizes_.length, loads_);
    }
    inverse_.compute(state_, motion_.velocity, motion_.acceleration, loads_);
    if (!inverse_.is_finite()) {
      result_.samples[index] = unknown_sample();
      return;
    }
    chosen_.clear();
    if (!points_.empty()) tracks.list_contacts(index, chosen_);
    supports_.clear();
    places_.clear();
    on_floor_ = true;
    for (const int p : chosen_) add_place(index, p, tracks);
    contacts_.solve(inverse_, state_, supports_, places_);
    DynamicsSample& sample = result_.samples[index];
    sample.size = sizes_.length;
    sample.supported = !chosen_.empty();
    sample.unexplained_force = contacts_.unexplained().force / result_.weight;
    sample.unexplained_torque = contacts_.unexplained().torque / result_.weight;
    sample.com_acceleration = inverse_.com_acceleration();
    find_torque(sample);
    find_support(sample);
  }

  [[nodiscard]] DynamicsSample unknown_sample() const {
    constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
    DynamicsSample sample;
    sample.size = sizes_.length;
    for (Vector3d* const each :
         {&sample.unexplained_force, &sample.unexplained_torque, &sample.com_acceleration}) {
      each->setConstant(kNoNumber);
    }
    sample.torque_ratio = sample.zmp_margin = sample.friction = kNoNumber;
    return sample;
  }

  void find_torque(DynamicsSample& sample) const {
    for (std::size_t i = 1; i < torque_limits_.size(); ++i) {
      if (!std::isfinite(torque_limits_[i])) continue;
      const double ratio = std::abs(contacts_.joint_torques()[i]) / torque_limits_[i];
      if (sample.torque_link >= 0 && ratio <= sample.torque_ratio) continue;
      sample.torque_ratio = ratio;
      sample.torque_link = static_cast<int>(i);
    }
  }

  void find_support(DynamicsSample& sample) {
    const Wrench& needed = inverse_.needed();
    const double held = needed.force.z() / result_.weight;
    sample.zmp_margin = sample.friction = std::numeric_limits<double>::quiet_NaN();
    if (!sample.supported || !on_floor_ || !(held >= kMinHeld)) return;
    sample.friction = needed.force.head<2>().norm() / needed.force.z();
    // Zero-moment point: a force on the floor at this point has no horizontal moment.
    const double height = inverse_.com().z() - result_.floor_height;
    const Eigen::Vector2d zmp =
        inverse_.com().head<2>() + Eigen::Vector2d(-needed.torque.y() - height * needed.force.x(),
                                                   needed.torque.x() - height * needed.force.y()) /
                                       needed.force.z();
    polygon_.clear();
    for (const ContactPlace& place : places_) polygon_.emplace_back(place.position.head<2>());
    sample.zmp_margin = margin_in_hull(zmp, polygon_);
  }

  const RobotClip& clip_;
  MotionSpline spline_;
  Inertias inertias_;
  std::vector<SupportPoint> points_;
  std::optional<SceneSupports> scene_;
  std::vector<double> torque_limits_;
  Sizes sizes_;
  MotionState motion_;
  TreeState state_;
  InverseDynamics inverse_;
  ContactForces contacts_;
  MotionDynamics result_;
  // Scratch memory.
  std::vector<int> chosen_;
  std::vector<const SupportPoint*> supports_;
  std::vector<ContactPlace> places_;
  std::vector<LinkLoad> loads_;
  bool on_floor_ = true;  // Whether only the floor supports.
  std::vector<Eigen::Vector2d> polygon_;
};

}  // namespace

bool DynamicsSample::is_bad() const {
  // The negated comparison makes NaN bad.
  const bool explained = unexplained_force.norm() <= kBadForce &&
                         unexplained_torque.head<2>().norm() <= kBadTorque * size;
  return !explained;
}

double DynamicsSample::torque_as_force() const {
  return kBadForce / (kBadTorque * size) * unexplained_torque.head<2>().norm();
}

MotionDynamics analyse_dynamics(const RobotClip& clip, const SceneWorld* scene) {
  return Analyser(clip, scene).run();
}

}  // namespace retarget
