#include "retarget/motion_io.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "base/npz_writer.h"
#include "base/option_name.h"
#include "math/so3.h"
#include "math/spline.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// frame numbers times the terms of two rates pass 64 bits
__extension__ using Int128 = __int128;

constexpr std::size_t kFewestSamples = 3;

// root and joints at the samples' times
struct Samples {
  std::vector<Vector3d> position;
  std::vector<Quaterniond> rotation;
  std::vector<std::vector<double>> qpos;
};

Samples sample(const RobotClip& clip, const FrameRate& rate) {
  const Int128 numerator = Int128{clip.rate().frames} * rate.seconds;
  const Int128 denominator = Int128{clip.rate().seconds} * rate.frames;
  const Int128 last = clip.frame_count() - 1;
  Samples samples;
  for (Int128 i = 0; i * numerator < last * denominator; ++i) {
    const auto frame = static_cast<int>(i * numerator / denominator);
    const double s =
        static_cast<double>(i * numerator % denominator) / static_cast<double>(denominator);
    const auto a = clip.qpos(frame), b = clip.qpos(frame + 1);
    std::vector<double> qpos(a.size());
    for (std::size_t k = 0; k < a.size(); ++k) qpos[k] = a[k] * (1.0 - s) + b[k] * s;
    const Quaterniond rotation =
        interpolate_linear(Quaterniond(a[3], a[4], a[5], a[6]).normalized(),
                           Quaterniond(b[3], b[4], b[5], b[6]).normalized(), s);
    qpos[3] = rotation.w();
    for (int k = 0; k < 3; ++k) qpos[4 + k] = rotation.vec()[k];
    samples.position.emplace_back(qpos[0], qpos[1], qpos[2]);
    samples.rotation.push_back(rotation);
    samples.qpos.push_back(std::move(qpos));
  }
  return samples;
}

// the samples beside one, and the time between them in samples
struct Neighbours {
  std::size_t before, after;
  Neighbours(std::size_t i, std::size_t count)
      : before(i == 0 ? 0 : i - 1), after(i + 1 == count ? i : i + 1) {}
  [[nodiscard]] double steps() const { return static_cast<double>(after - before); }
};

// a body's pose before its last joint moved it, and that joint's anchor and axis in the world
struct JointInWorld {
  Vector3d axis, anchor;
  Pose before;
};

JointInWorld undo(const RobotJoint& joint, const Pose& world_from_body, double position) {
  const double moved = position - joint.reference;
  JointInWorld found;
  found.axis = world_from_body.rotation * joint.axis;
  found.before = world_from_body;
  if (joint.type == RobotJoint::Type::kSlide) {
    found.before.translation -= moved * found.axis;
    return found;
  }
  found.anchor = world_from_body * joint.anchor;
  found.before.rotation = world_from_body.rotation * exp_so3(-moved * joint.axis);
  found.before.translation = found.anchor - found.before.rotation * joint.anchor;
  return found;
}

// velocities of all bodies' origins, and their angular velocities, in the world
class VelocityWalk {
 public:
  explicit VelocityWalk(const Robot& robot) : robot_(robot), joints_of_(robot.bodies().size()) {
    for (std::size_t j = 0; j < robot.joints().size(); ++j) {
      joints_of_[robot.joints()[j].body].push_back(static_cast<int>(j));
    }
    linear.resize(robot.bodies().size());
    angular.resize(robot.bodies().size());
  }

  // joint_speed by index into Robot::joints()
  void walk(std::span<const Pose> world_from_body, std::span<const double> qpos,
            const Vector3d& root_linear, const Vector3d& root_angular,
            std::span<const double> joint_speed) {
    for (std::size_t b = 0; b < world_from_body.size(); ++b) {
      if (b == 0) {
        linear[b] = angular[b] = Vector3d::Zero();
        continue;
      }
      if (static_cast<int>(b) == robot_.root_body()) {
        linear[b] = root_linear;
        angular[b] = root_angular;
        continue;
      }
      const auto parent = static_cast<std::size_t>(robot_.bodies()[b].parent);
      const Vector3d& place = world_from_body[b].translation;
      linear[b] =
          linear[parent] + angular[parent].cross(place - world_from_body[parent].translation);
      angular[b] = angular[parent];
      Pose pose = world_from_body[b];
      for (std::size_t k = joints_of_[b].size(); k-- > 0;) {
        const auto j = static_cast<std::size_t>(joints_of_[b][k]);
        const RobotJoint& joint = robot_.joints()[j];
        const JointInWorld in_world = undo(joint, pose, qpos[joint.qpos_address]);
        if (joint.type == RobotJoint::Type::kSlide) {
          linear[b] += joint_speed[j] * in_world.axis;
        } else {
          linear[b] += joint_speed[j] * in_world.axis.cross(place - in_world.anchor);
          angular[b] += joint_speed[j] * in_world.axis;
        }
        pose = in_world.before;
      }
    }
  }

  std::vector<Vector3d> linear, angular;

 private:
  const Robot& robot_;
  std::vector<std::vector<int>> joints_of_;  // of each body
};

// for each body of the layout the one among them that it is a part of; itself for those
std::vector<int> carriers(const Robot& robot, const std::vector<int>& bodies) {
  std::vector<int> carrier(robot.bodies().size(), 0);
  for (std::size_t b = 1; b < robot.bodies().size(); ++b) {
    const bool own = std::ranges::find(bodies, static_cast<int>(b)) != bodies.end();
    carrier[b] = own ? static_cast<int>(b) : carrier[robot.bodies()[b].parent];
  }
  return carrier;
}

// centre of mass of each body of the layout with all that is fixed to it, in the body's frame
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

void append(std::vector<double>& values, const Vector3d& v) {
  values.insert(values.end(), {v.x(), v.y(), v.z()});
}

// fills the arrays of one motion
class TrackingMaker {
 public:
  TrackingMaker(const Robot& robot, TrackingMotion& motion, const TrackingLayout& layout,
                BodyPoint point)
      : robot_(robot),
        motion_(motion),
        layout_(layout),
        walk_(robot),
        poses_(robot.bodies().size()),
        speeds_(robot.joints().size()) {
    centres_ = point == BodyPoint::kMass
                   ? mass_centres(robot, layout.bodies)
                   : std::vector<Vector3d>(layout.bodies.size(), Vector3d::Zero());
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
    forward_kinematics(robot_, samples.qpos[i], poses_);
    walk_.walk(poses_, samples.qpos[i], linear, root_angular, speeds_);
    for (const int joint : layout_.joints) {
      motion_.joint_pos.push_back(samples.qpos[i][robot_.joints()[joint].qpos_address]);
      motion_.joint_vel.push_back(speeds_[joint]);
    }
    for (std::size_t k = 0; k < layout_.bodies.size(); ++k) {
      const auto body = static_cast<std::size_t>(layout_.bodies[k]);
      const Quaterniond& rotation = poses_[body].rotation;
      append(motion_.body_pos, poses_[body].translation);
      motion_.body_quat.insert(motion_.body_quat.end(),
                               {rotation.w(), rotation.x(), rotation.y(), rotation.z()});
      append(motion_.body_lin_vel,
             walk_.linear[body] + walk_.angular[body].cross(rotation * centres_[k]));
      append(motion_.body_ang_vel, walk_.angular[body]);
    }
  }

 private:
  const Robot& robot_;
  TrackingMotion& motion_;
  const TrackingLayout& layout_;
  VelocityWalk walk_;
  std::vector<Pose> poses_;
  std::vector<double> speeds_;
  std::vector<Vector3d> centres_;  // by body of the layout
};

}  // namespace

TrackingLayout tracking_layout(const Robot& robot, MotionFormat format) {
  std::vector<bool> wanted(robot.joints().size(), false);
  for (const int joint : robot.output_joints()) wanted[joint] = true;
  std::vector<std::vector<int>> joints_of(robot.bodies().size());
  for (std::size_t j = 0; j < wanted.size(); ++j) {
    if (wanted[j]) joints_of[robot.joints()[j].body].push_back(static_cast<int>(j));
  }
  TrackingLayout layout;
  std::vector<int> depth(robot.bodies().size(), 0);
  for (std::size_t b = 1; b < robot.bodies().size(); ++b) {
    const bool own = static_cast<int>(b) == robot.root_body() || !joints_of[b].empty();
    depth[b] = depth[robot.bodies()[b].parent] + (own ? 1 : 0);
    if (own) layout.bodies.push_back(static_cast<int>(b));
  }
  if (format == MotionFormat::kNpzBeyondMimic) {
    std::ranges::stable_sort(layout.bodies, {}, [&](int body) { return depth[body]; });
  }
  for (const int body : layout.bodies) {
    layout.joints.insert(layout.joints.end(), joints_of[body].begin(), joints_of[body].end());
  }
  return layout;
}

Result<TrackingMotion> make_tracking_motion(const RobotClip& clip, MotionFormat format,
                                            const TrackingOptions& options) {
  const Robot& robot = clip.robot();
  const TrackingLayout layout = tracking_layout(robot, format);
  constexpr double kMostSamples = 1e7;
  if (clip.frame_count() * options.rate.fps() > kMostSamples * clip.rate().fps()) {
    return input_failure("",
                         "a motion of " + std::to_string(clip.frame_count()) + " frames at " +
                             to_text(clip.rate()) + " fps is too long for " +
                             to_text(options.rate) + " fps",
                         OPTION("source-fps") " gives the rate that a file does not say truly");
  }
  const Samples samples = sample(clip, options.rate);
  const std::size_t count = samples.qpos.size();
  if (count < kFewestSamples) {
    return input_failure("", "a tracking NPZ needs three frames at " + to_text(options.rate) +
                                 " fps, and the motion has " + std::to_string(count));
  }
  TrackingMotion motion;
  motion.format = format;
  motion.rate = options.rate;
  motion.frames = count;
  for (const int joint : layout.joints) motion.joint_names.push_back(robot.joints()[joint].name);
  for (const int body : layout.bodies) motion.body_names.push_back(robot.bodies()[body].name);
  const BodyPoint usual =
      format == MotionFormat::kNpzBeyondMimic ? BodyPoint::kMass : BodyPoint::kLink;
  TrackingMaker maker(robot, motion, layout, options.velocity_of.value_or(usual));
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t middle = std::clamp<std::size_t>(i, 1, count - 2);
    const Quaterniond turn =
        samples.rotation[middle + 1] * samples.rotation[middle - 1].conjugate();
    maker.add(samples, i, log_so3(turn) / (2.0 * options.rate.frame_time()));
  }
  return motion;
}

Result<std::string> format_tracking_npz(const TrackingMotion& motion) {
  if (motion.rate.seconds != 1) {
    return run_failure(
        "", "a tracking NPZ has a whole number of frames per second, not " + to_text(motion.rate));
  }
  const std::size_t frames = motion.frames;
  const std::size_t joints = motion.joint_names.size(), bodies = motion.body_names.size();
  const std::array<std::int64_t, 1> fps = {motion.rate.frames};
  const std::array<std::string, 1> flavour = {std::string(format_name(motion.format))};
  NpzWriter npz;
  npz.add("fps", int64_array(fps, {1}));
  npz.add("joint_pos", float32_array(motion.joint_pos, {frames, joints}));
  npz.add("joint_vel", float32_array(motion.joint_vel, {frames, joints}));
  npz.add("body_pos_w", float32_array(motion.body_pos, {frames, bodies, 3}));
  npz.add("body_quat_w", float32_array(motion.body_quat, {frames, bodies, 4}));
  npz.add("body_lin_vel_w", float32_array(motion.body_lin_vel, {frames, bodies, 3}));
  npz.add("body_ang_vel_w", float32_array(motion.body_ang_vel, {frames, bodies, 3}));
  npz.add("flavour", text_array(flavour, true));
  npz.add("joint_names", text_array(motion.joint_names));
  npz.add("body_names", text_array(motion.body_names));
  return npz.finish();
}

}  // namespace retarget
