#include "solve/dynamics/motion_dynamics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "solve/dynamics/contact_forces.h"
#include "solve/dynamics/motion_spline.h"
#include "solve/dynamics/scene_supports.h"
#include "solve/dynamics/support_points.h"
#include "solve/dynamics/support_tracks.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kSamplesPerSecond = 120.0;
// Smallest required vertical force for which ZMP and friction are defined, share of the weight.
constexpr double kMinHeld = 0.2;
constexpr double kBadForce = 0.1;    // Share of the weight.
constexpr double kBadTorque = 0.03;  // Metres x weight, for a robot of a G1's size.

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

  double floor() {
    return is_empty() || points_.empty() ? 0.0 : lowest_standing_height(track_points(), sizes_);
  }

  MotionDynamics run() {
    if (is_empty()) return result_;
    SupportTracks tracks = track_points();
    if (!points_.empty()) {
      result_.floor_height = standing_height(tracks, sizes_);
      tracks.find_contacts(result_.floor_height, sizes_);
      if (scene_) {
        const auto frame_of = [this](std::size_t sample) { return scene_frame(sample); };
        tracks.find_contacts(*scene_, frame_of, sizes_);
      }
    }
    result_.samples.resize(tracks.sample_count());
    for (std::size_t i = 0; i < tracks.sample_count(); ++i) measure(i, tracks);
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool is_empty() const { return clip_.frame_count() < 3 || inertias_.mass <= 0.0; }

  SupportTracks track_points() {
    const std::size_t samples = static_cast<std::size_t>(clip_.frame_count() - 1) *
                                static_cast<std::size_t>(result_.samples_per_frame);
    SupportTracks tracks(points_, samples, clip_.rate().fps() * result_.samples_per_frame);
    for (std::size_t i = 0; i < samples; ++i) {
      place(i);
      tracks.set(i, state_);
    }
    return tracks;
  }

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
    supports_.push_back(&points_[p]);
    on_floor_ = on_floor_ && !tracks.body_under(index, p);
    places_.push_back(tracks.place(index, p, scene_ ? &*scene_ : nullptr, scene_frame(index)));
  }

  void measure(std::size_t index, const SupportTracks& tracks) {
    place(index);
    if (scene_) {
      scene_->find_loads(scene_frame(index), points_, state_, sizes_.carry_reach(), loads_);
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
    const Eigen::Vector2d zmp =
        zero_moment_point(needed, inverse_.com(), inverse_.com().z() - result_.floor_height);
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
  BodySizes sizes_;
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
  bool on_floor_ = true;  // Whether all contacts are with the floor.
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

double standing_floor(const RobotClip& clip) {
  return Analyser(clip, nullptr).floor();
}

}  // namespace retarget
