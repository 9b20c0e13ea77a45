#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/math/gravity.h"
#include "base/try.h"
#include "formats/robot_motion/sample_times.h"
#include "retarget/reference.h"
#include "retarget/resample.h"
#include "retarget/so3.h"
#include "retarget/text.h"
#include "scene/scene_world.h"
#include "solve/dynamics/contact_forces.h"
#include "solve/dynamics/inertias.h"
#include "solve/dynamics/inverse_dynamics.h"
#include "solve/dynamics/reference_spline.h"
#include "solve/dynamics/scene_supports.h"
#include "solve/dynamics/support_points.h"
#include "solve/dynamics/support_tracks.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// Lowest sampling rate of contact detection, Hz, so that contacts hardly depend on the rate of the
// reference.
constexpr double kContactRate = 120.0;

void put(std::vector<double>& values, const Vector3d& vector) {
  values.insert(values.end(), vector.data(), vector.data() + 3);
}

// The largest torque of a joint beyond its limit.
struct WorstTorque {
  double ratio = 1.0;
  ReferenceLimit entry;
};

class ReferenceMaker {
 public:
  ReferenceMaker(const RobotClip& clip, const ReferenceOptions& options, const LimitSet& limits,
                 const SceneWorld* world)
      : clip_(clip),
        robot_(clip.robot()),
        options_(options),
        limits_(limits),
        spline_(clip, limits),
        finer_(std::max(1, static_cast<int>(std::ceil(kContactRate / options.rate.fps() - 1e-9)))),
        times_(clip.rate(), {options.rate.frames * finer_, options.rate.seconds}),
        inertias_(make_inertias(robot_)),
        points_(robot_.fixed_base() ? std::vector<SupportPoint>() : make_support_points(robot_)),
        torque_limits_(torque_limits_of(robot_)),
        sizes_(body_size(robot_)),
        motion_(robot_),
        state_(robot_.tree()),
        inverse_(robot_.tree(), inertias_),
        contacts_(robot_.tree(), torque_limits_, inertias_.mass * kGravity,
                  ContactForces::kLever * sizes_.length),
        worst_(torque_limits_.size()) {
    if (world != nullptr) scene_.emplace(*world, 0, world->clip.frame_count);
    result_.samples = static_cast<std::size_t>(
        resampled_frame_count(clip.frame_count(), clip.rate(), options.rate));
  }

  Result<MotionReference> make() {
    TRY(check_memory());
    describe();
    if (result_.has_dynamics) TRY(find_contacts());
    for (std::size_t i = 0; i < result_.samples; ++i) {
      if (is_stopped()) return interrupted_failure();
      add_sample(i);
    }
    finish();
    return std::move(result_);
  }

 private:
  // Number of instants at which contacts are detected.
  [[nodiscard]] std::size_t fine_count() const {
    return (result_.samples - 1) * static_cast<std::size_t>(finer_) + 1;
  }

  Result<void> check_memory() const {
    const std::size_t joints = robot_.output_joints().size();
    // In the worst case, every support point becomes a contact column.
    const std::size_t row = 8 * (60 + 4 * joints) + 49 * points_.size();
    const std::size_t fine = 26 * points_.size() * static_cast<std::size_t>(finer_);
    const double bytes = static_cast<double>(result_.samples) * static_cast<double>(row + fine);
    if (bytes <= static_cast<double>(options_.max_bytes)) return {};
    return input_failure("",
                         "a reference of " + count_text(result_.samples, "sample") +
                             " needs about " + number_text(bytes / 1e6, 0) + " MB of memory",
                         "choose a lower rate or a part of the motion");
  }

  void describe() {
    result_.robot = robot_.name();
    result_.rate = options_.rate;
    for (const int joint : robot_.output_joints()) {
      const auto at = static_cast<std::size_t>(joint);
      result_.joint_names.push_back(robot_.joints()[at].name);
      result_.lower.push_back(limits_.lower[at]);
      result_.upper.push_back(limits_.upper[at]);
      result_.speed_limits.push_back(robot_.speed_limit(joint));
      result_.torque_limits.push_back(robot_.torque_limit(joint));
    }
    result_.mass = inertias_.mass;
    result_.has_dynamics = inertias_.mass > 0.0;
    result_.corrections = spline_.corrections();
    result_.beyond = spline_.beyond();
  }

  // Moves the robot to the instant `within` / `finer_` of a sample period after a sample.
  void place(std::size_t sample, int within) {
    const SampleTime time = times_.at(WideFrames{sample} * finer_ + within);
    // The last sample may lie slightly after the last frame.
    const int last = std::max(clip_.frame_count() - 2, 0);
    const bool beyond = time.frame > last;
    spline_.sample(beyond ? last : time.frame,
                   clip_.frame_count() < 2 ? 0.0 : (beyond ? 1.0 : time.share), motion_);
    state_.update(motion_.qpos);
  }

  // The frame of the scene that is nearest to an instant.
  [[nodiscard]] int scene_frame(std::size_t fine) const {
    const SampleTime time = times_.at(WideFrames{fine});
    return std::min(time.frame + (time.share >= 0.5 ? 1 : 0), clip_.frame_count() - 1);
  }

  [[nodiscard]] bool is_stopped() const { return options_.keep_going && !options_.keep_going(); }

  Result<void> find_contacts() {
    if (points_.empty()) return {};
    tracks_.emplace(points_, fine_count(), options_.rate.fps() * finer_);
    for (std::size_t fine = 0; fine < fine_count(); ++fine) {
      if (is_stopped()) return interrupted_failure();
      const auto step = static_cast<std::size_t>(finer_);
      place(fine / step, static_cast<int>(fine % step));
      tracks_->set(fine, state_);
    }
    tracks_->find_contacts(standing_height(*tracks_, sizes_), sizes_);
    if (scene_) {
      tracks_->find_contacts(
          *scene_, [this](std::size_t fine) { return scene_frame(fine); }, sizes_);
    }
    name_contacts();
    return {};
  }

  // Makes columns for the points that are in contact in at least one sample.
  void name_contacts() {
    std::vector<char> touches(points_.size(), 0);
    for (std::size_t i = 0; i < result_.samples; ++i) {
      tracks_->list_contacts(i * static_cast<std::size_t>(finer_), chosen_);
      for (const int point : chosen_) touches[static_cast<std::size_t>(point)] = 1;
    }
    column_.assign(points_.size(), -1);
    std::vector<int> of_link(robot_.tree().links().size(), 0);
    for (std::size_t p = 0; p < points_.size(); ++p) {
      const auto link = static_cast<std::size_t>(points_[p].link);
      const int number = of_link[link]++;
      if (touches[p] == 0) continue;
      column_[p] = static_cast<int>(result_.contact_names.size());
      const int body = robot_.tree().links()[link].body;
      const std::string& name = robot_.bodies()[static_cast<std::size_t>(body)].name;
      result_.contact_links.push_back(name);
      result_.contact_names.push_back(name + "/" + std::to_string(number));
    }
  }

  void add_sample(std::size_t sample) {
    place(sample, 0);
    add_motion(sample);
    if (!result_.has_dynamics) return;
    const std::size_t fine = sample * static_cast<std::size_t>(finer_);
    if (scene_) {
      scene_->find_loads(scene_frame(fine), points_, state_, sizes_.carry_reach(), loads_);
    }
    inverse_.compute(state_, motion_.velocity, motion_.acceleration, loads_);
    choose_contacts(fine);
    contacts_.solve(inverse_, state_, supports_, places_);
    add_forces(fine);
    add_torques(sample);
  }

  void add_motion(std::size_t sample) {
    result_.time.push_back(options_.rate.time_of(static_cast<int>(sample)));
    if (sample > 0) {
      const double* const before = result_.qpos.data() + result_.qpos.size() - qpos_width() + 3;
      align_sign(Eigen::Map<const Eigen::Vector4d>(before),
                 Eigen::Map<Eigen::Vector4d>(motion_.qpos.data() + 3));
    }
    result_.qpos.insert(result_.qpos.end(), motion_.qpos.begin(), motion_.qpos.begin() + 7);
    for (auto* const of : {&result_.qvel, &result_.qacc}) {
      const auto& from = of == &result_.qvel ? motion_.velocity : motion_.acceleration;
      of->insert(of->end(), from.begin(), from.begin() + 6);
    }
    for (const int joint : robot_.output_joints()) {
      const auto dof =
          static_cast<std::size_t>(KinematicTree::dof_of(robot_.tree().link_of_joint(joint)));
      result_.qpos.push_back(motion_.qpos[static_cast<std::size_t>(
          robot_.joints()[static_cast<std::size_t>(joint)].qpos_address)]);
      result_.qvel.push_back(motion_.velocity[dof]);
      result_.qacc.push_back(motion_.acceleration[dof]);
    }
  }

  [[nodiscard]] std::size_t qpos_width() const { return 7 + robot_.output_joints().size(); }

  void choose_contacts(std::size_t fine) {
    chosen_.clear();
    supports_.clear();
    places_.clear();
    if (!tracks_) return;
    tracks_->list_contacts(fine, chosen_);
    for (const int point : chosen_) {
      const auto p = static_cast<std::size_t>(point);
      supports_.push_back(&points_[p]);
      places_.push_back(tracks_->place(fine, p, scene_ ? &*scene_ : nullptr, scene_frame(fine)));
    }
  }

  void add_forces(std::size_t fine) {
    const std::size_t columns = result_.contact_names.size();
    const std::size_t first = result_.contacts.size();
    result_.contacts.resize(first + columns, 0);
    result_.contact_position.resize(3 * (first + columns), 0.0);
    result_.contact_force.resize(3 * (first + columns), 0.0);
    const auto set = [&](std::vector<double>& values, int column, const Vector3d& vector) {
      for (std::size_t k = 0; k < 3; ++k) {
        values[3 * (first + static_cast<std::size_t>(column)) + k] = vector[static_cast<int>(k)];
      }
    };
    for (std::size_t p = 0; p < column_.size(); ++p) {
      if (column_[p] >= 0) set(result_.contact_position, column_[p], tracks_->at(fine, p));
    }
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
      const int column = column_[static_cast<std::size_t>(chosen_[i])];
      result_.contacts[first + static_cast<std::size_t>(column)] = 1;
      set(result_.contact_position, column, places_[i].position);
      set(result_.contact_force, column, contacts_.forces()[i]);
    }
    add_residual();
    put(result_.com, inverse_.com());
    put(result_.com_velocity, inverse_.com_velocity());
    put(result_.com_acceleration, inverse_.com_acceleration());
    put(result_.angular_momentum, inverse_.angular_momentum());
  }

  // The unexplained wrench moves from the centre of mass to the root's origin.
  void add_residual() {
    const Wrench& rest = contacts_.unexplained();
    const Vector3d lever = inverse_.com() - state_.origin();
    const Vector3d torque = rest.torque + lever.cross(rest.force);
    put(result_.residual, rest.force);
    put(result_.residual,
        state_.world_from_link[0].rotation.conjugate().toRotationMatrix() * torque);
  }

  void add_torques(std::size_t sample) {
    for (const int joint : robot_.output_joints()) {
      const auto link = static_cast<std::size_t>(robot_.tree().link_of_joint(joint));
      const double torque = contacts_.joint_torques()[link];
      result_.torque.push_back(torque);
      const double ratio = std::abs(torque) / torque_limits_[link];
      if (!(ratio > worst_[link].ratio)) continue;
      worst_[link] = {
          ratio,
          {ReferenceLimit::Kind::kTorque, robot_.joints()[static_cast<std::size_t>(joint)].name,
           options_.rate.time_of(static_cast<int>(sample)), std::abs(torque),
           torque_limits_[link]}};
    }
  }

  void finish() {
    for (const WorstTorque& worst : worst_) {
      if (worst.ratio > 1.0) result_.beyond.push_back(worst.entry);
    }
    if (!options_.planted) return;
    result_.planted = resample_contacts(*options_.planted, clip_.rate(), options_.rate,
                                        static_cast<int>(result_.samples));
  }

  const RobotClip& clip_;
  const Robot& robot_;
  const ReferenceOptions& options_;
  const LimitSet& limits_;
  ReferenceSpline spline_;
  int finer_;          // Instants of contact detection per sample.
  SampleTimes times_;  // Times of these instants.
  Inertias inertias_;
  std::vector<SupportPoint> points_;
  std::optional<SceneSupports> scene_;
  std::vector<double> torque_limits_;  // One per link.
  BodySizes sizes_;
  MotionState motion_;
  TreeState state_;
  InverseDynamics inverse_;
  ContactForces contacts_;
  std::vector<WorstTorque> worst_;  // One per link.
  std::optional<SupportTracks> tracks_;
  std::vector<int> column_;  // One per support point; -1: never in contact.
  MotionReference result_;
  // Scratch memory.
  std::vector<int> chosen_;
  std::vector<const SupportPoint*> supports_;
  std::vector<ContactPlace> places_;
  std::vector<LinkLoad> loads_;
};

Result<LimitSet> reference_limits(const Robot& robot, const ReferenceOptions& options) {
  if (!options.limits.lower.empty()) return options.limits;
  return load_limits(robot, robot.limits_for({}));
}

}  // namespace

Result<MotionReference> make_reference(const RobotClip& clip, const ReferenceOptions& options) {
  const double rate = options.rate.fps();
  if (!(rate >= kMinReferenceRate && rate <= kMaxReferenceRate)) {
    return usage_failure("the rate of a reference must be from 10 to 1000, found " +
                         number_text(rate, 3));
  }
  if (clip.frame_count() < 1) return input_failure("", "the motion has no frames");
  TRY_ASSIGN(const LimitSet limits, reference_limits(clip.robot(), options));
  std::optional<SceneWorld> world;
  if (options.scene != nullptr && options.scene->frame_count > 0) {
    TRY_ASSIGN(world, make_scene_world(*options.scene));
  }
  return ReferenceMaker(clip, options, limits, world ? &*world : nullptr).make();
}

}  // namespace retarget
