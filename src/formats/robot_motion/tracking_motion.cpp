#include "retarget/motion_io.h"

#include <mujoco/mujoco.h>
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "formats/containers/npz.h"
#include "formats/robot_motion/motion_writers.h"
#include "formats/robot_motion/sample_times.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/kinematic_tree.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/pose.h"
#include "retarget/robot.h"
#include "retarget/root_pose.h"
#include "retarget/so3.h"
#include "retarget/spline.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr std::size_t kMinSamples = 3;

// Root and joints at the sample times.
struct Samples {
  std::vector<Vector3d> position;
  std::vector<Quaterniond> rotation;
  std::vector<std::vector<double>> qpos;
};

Samples sample(const RobotClip& clip, MotionFormat format, const TrackingOptions& options) {
  const SampleTimes times(clip.rate(), options.rate);
  const int count = tracking_frame_count(clip, format, options);
  Samples samples;
  for (int i = 0; i < count; ++i) {
    const auto [frame, s] = times.at(i);
    const auto a = clip.qpos(frame), b = clip.qpos(std::min(frame + 1, clip.frame_count() - 1));
    std::vector<double> qpos(a.size());
    for (std::size_t k = 0; k < a.size(); ++k) qpos[k] = a[k] * (1.0 - s) + b[k] * s;
    const Quaterniond rotation =
        interpolate_linear(root_rotation(a).normalized(), root_rotation(b).normalized(), s);
    set_root_rotation(qpos, rotation);
    samples.position.emplace_back(qpos[0], qpos[1], qpos[2]);
    samples.rotation.push_back(rotation);
    samples.qpos.push_back(std::move(qpos));
  }
  return samples;
}

// The samples before and after one, and the number of steps between them.
struct Neighbours {
  std::size_t before, after;
  Neighbours(std::size_t i, std::size_t count)
      : before(i == 0 ? 0 : i - 1), after(i + 1 == count ? i : i + 1) {}
  [[nodiscard]] double steps() const { return static_cast<double>(after - before); }
};

// Maps each body to the layout body that carries it; layout bodies map to themselves.
std::vector<int> carriers(const Robot& robot, const std::vector<int>& bodies) {
  std::vector<int> carrier(robot.bodies().size(), 0);
  for (std::size_t b = 1; b < robot.bodies().size(); ++b) {
    const bool own = std::ranges::find(bodies, static_cast<int>(b)) != bodies.end();
    carrier[b] = own ? static_cast<int>(b) : carrier[robot.bodies()[b].parent];
  }
  return carrier;
}

// Centre of mass of each layout body with everything fixed to it, in the body's frame.
std::vector<Vector3d> mass_centres(const Robot& robot, const std::vector<int>& bodies) {
  std::vector<Pose> world_from_body(robot.bodies().size());
  forward_kinematics(robot, robot.zero_configuration(), world_from_body);
  const auto carrier = carriers(robot, bodies);
  std::vector<double> mass(robot.bodies().size(), 0.0);
  std::vector<Vector3d> moment(robot.bodies().size(), Vector3d::Zero());
  for (std::size_t b = 1; b < robot.bodies().size(); ++b) {
    const double* centre = robot.model()->body_ipos + 3 * b;
    const double part = robot.model()->body_mass[b];
    const auto of = static_cast<std::size_t>(carrier[b]);
    mass[of] += part;
    moment[of] += part * (world_from_body[of].inverse() *
                          (world_from_body[b] * Vector3d(centre[0], centre[1], centre[2])));
  }
  std::vector<Vector3d> centres;
  for (const int body : bodies) {
    const auto b = static_cast<std::size_t>(body);
    centres.push_back(mass[b] > 0.0 ? Vector3d(moment[b] / mass[b]) : Vector3d::Zero());
  }
  return centres;
}

// Fills the arrays of one motion.
class TrackingMaker {
 public:
  TrackingMaker(const Robot& robot, TrackingMotion& motion, const TrackingLayout& layout,
                BodyPoint point)
      : robot_(robot),
        motion_(motion),
        layout_(layout),
        posed_(robot.tree()),
        speeds_(robot.joints().size()),
        linear_(posed_.world_from_link.size()),
        angular_(posed_.world_from_link.size()) {
    if (point == BodyPoint::kMass) {
      centres_ = mass_centres(
          robot, std::vector<int>(layout.bodies.begin(), layout.bodies.end() - layout.fixed));
    }
    centres_.resize(layout.bodies.size(), Vector3d::Zero());
  }

  void add(const Samples& samples, std::size_t i, const Vector3d& root_angular) {
    const std::size_t count = samples.qpos.size();
    const Neighbours at(i, count);
    const double time = at.steps() * motion_.rate.frame_time();
    for (std::size_t j = 0; j < speeds_.size(); ++j) {
      const int address = robot_.joints()[j].qpos_address;
      speeds_[j] = (samples.qpos[at.after][address] - samples.qpos[at.before][address]) / time;
    }
    const Vector3d linear = (samples.position[at.after] - samples.position[at.before]) / time;
    posed_.update(samples.qpos[i]);
    find_velocities(linear, root_angular);
    append_vector(motion_.root_lin_vel, linear);
    for (const int joint : layout_.joints) {
      motion_.joint_pos.push_back(samples.qpos[i][robot_.joints()[joint].qpos_address]);
      motion_.joint_vel.push_back(speeds_[joint]);
    }
    for (std::size_t k = 0; k < layout_.bodies.size(); ++k) {
      const Pose body = posed_.world_from_body(layout_.bodies[k]);
      const int link = robot_.tree().attachment(layout_.bodies[k]).link;
      append_vector(motion_.body_pos, body.translation);
      motion_.body_quat.insert(motion_.body_quat.end(), {body.rotation.w(), body.rotation.x(),
                                                         body.rotation.y(), body.rotation.z()});
      const Vector3d from_origin = body * centres_[k] - posed_.origin();
      append_vector(motion_.body_lin_vel, linear_[link] + angular_[link].cross(from_origin));
      append_vector(motion_.body_ang_vel, angular_[link]);
    }
  }

 private:
  // Computes the velocities of the links from the base outwards.
  void find_velocities(const Vector3d& root_linear, const Vector3d& root_angular) {
    linear_[0] = root_linear;
    angular_[0] = root_angular;
    for (std::size_t i = 1; i < linear_.size(); ++i) {
      const KinematicTree::Link& link = robot_.tree().links()[i];
      const int dof = KinematicTree::dof_of(static_cast<int>(i));
      linear_[i] = linear_[link.parent] + speeds_[link.joint] * posed_.linear[dof];
      angular_[i] = angular_[link.parent] + speeds_[link.joint] * posed_.angular[dof];
    }
  }

  const Robot& robot_;
  TrackingMotion& motion_;
  const TrackingLayout& layout_;
  TreeState posed_;
  std::vector<double> speeds_;              // One per joint.
  std::vector<Vector3d> linear_, angular_;  // One per link; linear: at the base's origin.
  std::vector<Vector3d> centres_;           // One per body of the layout.
};

}  // namespace

TrackingLayout tracking_layout(const Robot& robot, MotionFormat format) {
  std::vector<bool> wanted(robot.joints().size(), false);
  for (const int joint : robot.output_joints()) wanted[joint] = true;
  std::vector<std::vector<int>> joints_of(robot.bodies().size());
  for (std::size_t j = 0; j < wanted.size(); ++j) {
    if (!wanted[j]) continue;
    joints_of[robot.moved_body(robot.joints()[j].body)].push_back(static_cast<int>(j));
  }
  TrackingLayout layout;
  std::vector<int> depth(robot.bodies().size(), 0);
  for (std::size_t b = 1; b < robot.bodies().size(); ++b) {
    const bool own = static_cast<int>(b) == robot.root_body() || !joints_of[b].empty() ||
                     std::ranges::count(robot.variant().bodies, robot.bodies()[b].name) > 0;
    depth[b] = depth[robot.bodies()[b].parent] + (own ? 1 : 0);
    if (own) layout.bodies.push_back(static_cast<int>(b));
  }
  if (format == MotionFormat::kNpzBeyondMimic || format == MotionFormat::kCsvSonic) {
    std::ranges::stable_sort(layout.bodies, {}, [&](int body) { return depth[body]; });
  }
  for (const int body : layout.bodies) {
    layout.joints.insert(layout.joints.end(), joints_of[body].begin(), joints_of[body].end());
  }
  if (format == MotionFormat::kNpzHolosoma) {
    // holosoma's reader looks up bodies by name, including those without a joint.
    for (std::size_t b = 1; b < robot.bodies().size(); ++b) {
      const int body = static_cast<int>(b);
      if (std::ranges::find(layout.bodies, body) != layout.bodies.end()) continue;
      if (robot.moved_body(body) != body) continue;
      layout.bodies.push_back(body);
      ++layout.fixed;
    }
  }
  return layout;
}

TrackingOptions conversion_options(TrackingOptions options, const FrameRate& motion) {
  options.until_last = options.until_last || same_rate(options.rate, motion);
  return options;
}

int tracking_frame_count(const RobotClip& clip, MotionFormat format,
                         const TrackingOptions& options) {
  if (clip.frame_count() == 0) return 0;
  const SampleTimes times(clip.rate(), options.rate);
  const int last = clip.frame_count() - 1;
  const bool until_last = options.until_last || format == MotionFormat::kProtoMotions ||
                          format == MotionFormat::kCsvSonic;
  return times.count_before(last) + (until_last && times.has_sample_at(last) ? 1 : 0);
}

Result<TrackingMotion> make_tracking_motion(const RobotClip& clip, MotionFormat format,
                                            const TrackingOptions& options) {
  const Robot& robot = clip.robot();
  const TrackingLayout layout = tracking_layout(robot, format);
  constexpr double kMaxSamples = 1e7;
  if (clip.frame_count() * options.rate.fps() > kMaxSamples * clip.rate().fps()) {
    return input_failure("",
                         "a motion of " + std::to_string(clip.frame_count()) + " frames at " +
                             to_text(clip.rate()) + " fps is too long for " +
                             to_text(options.rate) + " fps",
                         OPTION("source-fps") " corrects a wrong rate in the file");
  }
  const Samples samples = sample(clip, format, options);
  const std::size_t count = samples.qpos.size();
  if (count < kMinSamples) {
    return input_failure("", "a tracking file needs three frames at " + to_text(options.rate) +
                                 " fps, but the motion has " + std::to_string(clip.frame_count()) +
                                 " at " + to_text(clip.rate()) + " fps");
  }
  TrackingMotion motion;
  motion.format = format;
  motion.rate = options.rate;
  motion.frames = count;
  for (const int joint : layout.joints) motion.joint_names.push_back(robot.joints()[joint].name);
  for (const int body : layout.bodies) motion.body_names.push_back(robot.bodies()[body].name);
  const BodyPoint usual =
      format == MotionFormat::kNpzBeyondMimic || format == MotionFormat::kNpzHolosoma
          ? BodyPoint::kMass
          : BodyPoint::kLink;
  TrackingMaker maker(robot, motion, layout, options.velocity_of.value_or(usual));
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t middle = std::clamp<std::size_t>(i, 1, count - 2);
    const Quaterniond turn =
        samples.rotation[middle + 1] * samples.rotation[middle - 1].conjugate();
    maker.add(samples, i, log_so3(turn) / (2.0 * options.rate.frame_time()));
  }
  return motion;
}

}  // namespace retarget
