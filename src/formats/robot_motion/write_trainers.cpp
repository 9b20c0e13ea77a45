// Writes files for training frameworks: pickles, tracking NPZ and ProtoMotions' PyTorch files.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/try.h"
#include "formats/containers/npz.h"
#include "formats/containers/pickle.h"
#include "formats/containers/torch_file.h"
#include "formats/robot_motion/motion_writers.h"
#include "formats/robot_motion/scene_tracks.h"
#include "formats/robot_motion/trainer_arrays.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/pose.h"
#include "retarget/robot.h"
#include "retarget/root_pose.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

// PBHC's pose_aa ends with rows for the head and the hands, which stay zero.
constexpr std::size_t kEmptyRowsOfPbhc = 3;

void put_fps(PickleWriter& pickle, const FrameRate& rate) {
  pickle.text("fps");
  if (rate.seconds == 1) {
    pickle.integer(rate.frames);
  } else {
    pickle.number(rate.fps());
  }
}

// Per-frame data shared by both dictionary formats.
struct MotionTables {
  std::vector<double> position, rotation_xyzw, joints;
  std::size_t frames = 0, joint_count = 0;
};

MotionTables tables_of(const RobotClip& clip) {
  const Robot& robot = clip.robot();
  MotionTables tables;
  tables.frames = static_cast<std::size_t>(clip.frame_count());
  tables.joint_count = robot.output_joints().size();
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto qpos = clip.qpos(frame);
    tables.position.insert(tables.position.end(), qpos.begin(), qpos.begin() + 3);
    tables.rotation_xyzw.insert(tables.rotation_xyzw.end(), {qpos[4], qpos[5], qpos[6], qpos[3]});
    for (const int joint : robot.output_joints()) {
      tables.joints.push_back(qpos[robot.joints()[joint].qpos_address]);
    }
  }
  return tables;
}

// Positions of all bodies except the world, with the root at the origin and unrotated.
std::vector<double> local_positions(const RobotClip& clip) {
  const std::size_t bodies = clip.robot().bodies().size();
  std::vector<Pose> root_from_body(bodies);
  std::vector<double> positions;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto qpos = clip.qpos(frame);
    std::vector<double> unmoved(qpos.begin(), qpos.end());
    for (int i = 0; i < 7; ++i) unmoved[i] = i == 3 ? 1.0 : 0.0;
    forward_kinematics(clip.robot(), unmoved, root_from_body);
    for (std::size_t b = 1; b < bodies; ++b) {
      append_vector(positions, root_from_body[b].translation);
    }
  }
  return positions;
}

// Rotation vectors of the root and of the joints about their axes, then rows of zeros.
std::vector<double> rotation_vectors(const RobotClip& clip, std::size_t empty_rows) {
  const Robot& robot = clip.robot();
  std::vector<double> vectors;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto qpos = clip.qpos(frame);
    append_vector(vectors, log_so3(root_rotation(qpos)));
    for (const int index : robot.output_joints()) {
      const RobotJoint& joint = robot.joints()[index];
      append_vector(vectors, qpos[joint.qpos_address] * joint.axis);
    }
    for (std::size_t i = 0; i < empty_rows; ++i) append_vector(vectors, Eigen::Vector3d::Zero());
  }
  return vectors;
}

// Contacts of the left and the right foot.
std::vector<double> contact_mask(const FootContacts& contacts) {
  std::vector<double> mask;
  for (int frame = 0; frame < contacts.frame_count(); ++frame) {
    for (const int foot : {0, 1}) mask.push_back(contacts.foot_planted(frame, foot) ? 1.0 : 0.0);
  }
  return mask;
}

void put_motion(PickleWriter& pickle, const RobotClip& clip, MotionFormat format,
                const WriteMotionOptions& options) {
  const MotionTables tables = tables_of(clip);
  const std::size_t frames = tables.frames, joints = tables.joint_count;
  const std::size_t empty_rows = format == MotionFormat::kPklPbhc ? kEmptyRowsOfPbhc : 0;
  pickle.begin_dict();
  pickle.array("root_trans_offset", float32_array(tables.position, {frames, 3}));
  pickle.array("pose_aa", float32_array(rotation_vectors(clip, empty_rows),
                                        {frames, 1 + joints + empty_rows, 3}));
  pickle.array("dof", float32_array(tables.joints, {frames, joints}));
  pickle.array("root_rot", float32_array(tables.rotation_xyzw, {frames, 4}));
  if (options.contacts) {
    pickle.array("contact_mask", float32_array(contact_mask(*options.contacts), {frames, 2}));
  }
  put_fps(pickle, clip.rate());
  pickle.end_dict();
}

// holosoma's joint arrays begin with the root, as in MuJoCo's qpos and qvel.
void add_joints_behind_root(const TrackingMotion& motion, NpzWriter& npz) {
  const std::size_t joints = motion.joint_names.size(), bodies = motion.body_names.size();
  std::vector<double> positions, velocities;
  for (std::size_t frame = 0; frame < motion.frames; ++frame) {
    append_row(positions, motion.body_pos, 3 * frame * bodies, 3);
    append_row(positions, motion.body_quat, 4 * frame * bodies, 4);
    append_row(positions, motion.joint_pos, frame * joints, joints);
    append_row(velocities, motion.root_lin_vel, 3 * frame, 3);
    append_row(velocities, motion.body_ang_vel, 3 * frame * bodies, 3);
    append_row(velocities, motion.joint_vel, frame * joints, joints);
  }
  npz.add("joint_pos", float32_array(positions, {motion.frames, 7 + joints}));
  npz.add("joint_vel", float32_array(velocities, {motion.frames, 6 + joints}));
}

constexpr std::string_view kEnumModule = "protomotions.simulator.base_simulator.simulator_state";
constexpr std::array<std::string_view, 2> kSideNames = {"left", "right"};

// Arrays with one row per body.
struct BodyRows {
  std::vector<double> position, rotation_xyzw, linear, angular;

  void add(const Eigen::Vector3d& at, const Eigen::Quaterniond& turn,
           const Eigen::Vector3d& velocity, const Eigen::Vector3d& rate) {
    append_vector(position, at);
    rotation_xyzw.insert(rotation_xyzw.end(), {turn.x(), turn.y(), turn.z(), turn.w()});
    append_vector(linear, velocity);
    append_vector(angular, rate);
  }
};

Eigen::Vector3d vector_at(const std::vector<double>& values, std::size_t index) {
  const double* v = values.data() + 3 * index;
  return {v[0], v[1], v[2]};
}

BodyRows body_rows(const TrackingMotion& motion, const std::vector<ProtoBody>& bodies) {
  std::vector<std::size_t> carriers;
  for (const ProtoBody& body : bodies) {
    const auto found = std::ranges::find(motion.body_names, body.carrier);
    carriers.push_back(static_cast<std::size_t>(found - motion.body_names.begin()));
  }
  BodyRows rows;
  for (std::size_t frame = 0; frame < motion.frames; ++frame) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const std::size_t at = frame * motion.body_names.size() + carriers[b];
      const double* q = motion.body_quat.data() + 4 * at;
      const Eigen::Quaterniond turn(q[0], q[1], q[2], q[3]);
      const Eigen::Vector3d arm = turn * bodies[b].place, rate = vector_at(motion.body_ang_vel, at);
      rows.add(vector_at(motion.body_pos, at) + arm, turn,
               vector_at(motion.body_lin_vel, at) + rate.cross(arm), rate);
    }
  }
  return rows;
}

// Joint velocities as forward differences, as in ProtoMotions' own files. The last one is repeated.
std::vector<double> forward_speeds(const TrackingMotion& motion) {
  const std::size_t joints = motion.joint_names.size();
  std::vector<double> speeds;
  speeds.reserve(motion.joint_pos.size());
  for (std::size_t frame = 0; frame < motion.frames; ++frame) {
    const std::size_t begin = std::min(frame, motion.frames - 2) * joints;
    for (std::size_t j = begin; j < begin + joints; ++j) {
      speeds.push_back((motion.joint_pos[j + joints] - motion.joint_pos[j]) * motion.rate.fps());
    }
  }
  return speeds;
}

// Contacts per body. Returns nothing if the feet or their contacts are unknown.
std::optional<std::vector<std::uint8_t>> body_contacts(const RobotClip& clip,
                                                       const std::vector<ProtoBody>& bodies,
                                                       const std::optional<FootContacts>& known) {
  if (!known) return std::nullopt;
  std::vector<std::uint8_t> contacts(bodies.size() * static_cast<std::size_t>(known->frame_count()),
                                     0);
  for (int side = 0; side < 2; ++side) {
    const auto foot = proto_foot(clip.robot(), bodies, kSideNames[static_cast<std::size_t>(side)]);
    if (!foot) return std::nullopt;
    for (int frame = 0; frame < known->frame_count(); ++frame) {
      if (known->foot_planted(frame, side)) {
        contacts[static_cast<std::size_t>(frame) * bodies.size() + *foot] = 1;
      }
    }
  }
  return contacts;
}

}  // namespace

MotionFiles write_gmr_pickle(const RobotClip& clip, MotionFormat /*format*/,
                             const WriteMotionOptions& /*options*/) {
  const MotionTables tables = tables_of(clip);
  std::vector<std::string> bodies = clip.robot().body_names();
  bodies.erase(bodies.begin());  // Remove the world.
  PickleWriter pickle;
  pickle.begin_dict();
  put_fps(pickle, clip.rate());
  pickle.array("root_pos", float64_array(tables.position, {tables.frames, 3}));
  pickle.array("root_rot", float64_array(tables.rotation_xyzw, {tables.frames, 4}));
  pickle.array("dof_pos", float64_array(tables.joints, {tables.frames, tables.joint_count}));
  pickle.array("local_body_pos",
               float32_array(local_positions(clip), {tables.frames, bodies.size(), 3}));
  pickle.text("link_body_list");
  pickle.texts(bodies);
  pickle.end_dict();
  return one_file(pickle.finish());
}

MotionFiles write_motion_lib_pickle(const RobotClip& clip, MotionFormat format,
                                    const WriteMotionOptions& options) {
  PickleWriter pickle;
  pickle.begin_dict();
  pickle.text(options.name.empty() ? "motion" : options.name);
  if (format == MotionFormat::kPklPbhc) {
    TRY_ASSIGN(auto robot, pbhc_robot(clip.shared_robot()));
    put_motion(pickle, with_robot(clip, std::move(robot)), format, options);
  } else {
    put_motion(pickle, clip, format, options);
  }
  pickle.end_dict();
  return one_file(pickle.finish());
}

MotionFiles write_mimickit_pickle(const RobotClip& clip, MotionFormat /*format*/,
                                  const WriteMotionOptions& /*options*/) {
  const Robot& robot = clip.robot();
  PickleWriter pickle;
  pickle.begin_dict();
  pickle.text("loop_mode");
  pickle.integer(0);  // The motion does not loop.
  put_fps(pickle, clip.rate());
  pickle.text("frames");
  pickle.begin_list();
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto qpos = clip.qpos(frame);
    const Eigen::Vector3d turn = log_so3(root_rotation(qpos));
    pickle.begin_list();
    for (int i = 0; i < 3; ++i) pickle.number(qpos[i]);
    for (int i = 0; i < 3; ++i) pickle.number(turn[i]);
    for (const int joint : robot.output_joints()) {
      pickle.number(qpos[robot.joints()[joint].qpos_address]);
    }
    pickle.end_list();
  }
  pickle.end_list();
  pickle.end_dict();
  return one_file(pickle.finish());
}

Result<std::string> format_tracking_npz(const TrackingMotion& motion) {
  if (motion.rate.seconds != 1) {
    return run_failure("", "a tracking NPZ needs a whole number of frames per second, not " +
                               to_text(motion.rate));
  }
  const std::size_t frames = motion.frames;
  const std::size_t joints = motion.joint_names.size(), bodies = motion.body_names.size();
  const std::array<std::int64_t, 1> fps = {motion.rate.frames};
  const std::array<std::string, 1> flavour = {std::string(format_name(motion.format))};
  NpzWriter npz;
  npz.add("fps", int64_array(fps, {1}));
  if (motion.format == MotionFormat::kNpzHolosoma) {
    add_joints_behind_root(motion, npz);
  } else {
    npz.add("joint_pos", float32_array(motion.joint_pos, {frames, joints}));
    npz.add("joint_vel", float32_array(motion.joint_vel, {frames, joints}));
  }
  npz.add("body_pos_w", float32_array(motion.body_pos, {frames, bodies, 3}));
  npz.add("body_quat_w", float32_array(motion.body_quat, {frames, bodies, 4}));
  npz.add("body_lin_vel_w", float32_array(motion.body_lin_vel, {frames, bodies, 3}));
  npz.add("body_ang_vel_w", float32_array(motion.body_ang_vel, {frames, bodies, 3}));
  npz.add("flavour", text_array(flavour, true));
  npz.add("joint_names", text_array(motion.joint_names));
  npz.add("body_names", text_array(motion.body_names));
  if (motion.contacts) {
    const std::vector<std::string> names(kContactNames.begin(), kContactNames.end());
    npz.add("contacts", bool_array(motion.contacts->planted, {frames, names.size()}));
    npz.add("contact_names", text_array(names));
  }
  add_scene_arrays(motion, npz);
  return npz.finish();
}

Result<TrackingMotion> tracking_with_contacts(const RobotClip& clip, MotionFormat format,
                                              const WriteMotionOptions& options,
                                              const TrackingOptions& tracking) {
  TRY_ASSIGN(auto motion, make_tracking_motion(clip, format, tracking));
  if (options.contacts) {
    motion.contacts = resample_contacts(*options.contacts, clip.rate(), motion.rate,
                                        static_cast<int>(motion.frames));
  }
  if (options.scene) motion.objects = tracked_objects(*options.scene, motion);
  if (options.labels) motion.touches = tracked_contacts(*options.labels, clip.rate(), motion);
  return motion;
}

MotionFiles write_tracking_npz(const RobotClip& clip, MotionFormat format,
                               const WriteMotionOptions& options) {
  TRY_ASSIGN(const auto motion, tracking_with_contacts(clip, format, options, options.tracking));
  return one_file(format_tracking_npz(motion));
}

MotionFiles write_protomotions(const RobotClip& clip, MotionFormat format,
                               const WriteMotionOptions& options) {
  TrackingOptions tracking;
  tracking.rate = clip.rate();
  TRY_ASSIGN(const auto motion, tracking_with_contacts(clip, format, options, tracking));
  const std::vector<ProtoBody> bodies = proto_bodies(clip.robot());
  const BodyRows rows = body_rows(motion, bodies);
  const std::size_t frames = motion.frames, joints = motion.joint_names.size();
  TorchWriter torch;
  torch.enum_member("state_conversion", kEnumModule, "StateConversion", "common");
  if (clip.rate().seconds == 1) {
    torch.integer("fps", clip.rate().frames);
  } else {
    torch.number("fps", clip.rate().fps());
  }
  torch.tensor("dof_pos", float32_array(motion.joint_pos, {frames, joints}));
  torch.tensor("dof_vel", float32_array(forward_speeds(motion), {frames, joints}));
  torch.tensor("rigid_body_pos", float32_array(rows.position, {frames, bodies.size(), 3}));
  torch.tensor("rigid_body_rot", float32_array(rows.rotation_xyzw, {frames, bodies.size(), 4}));
  torch.tensor("rigid_body_vel", float32_array(rows.linear, {frames, bodies.size(), 3}));
  torch.tensor("rigid_body_ang_vel", float32_array(rows.angular, {frames, bodies.size(), 3}));
  if (const auto contacts = body_contacts(clip, bodies, motion.contacts)) {
    torch.tensor("rigid_body_contacts", bool_array(*contacts, {frames, bodies.size()}));
  }
  return one_file(torch.finish("motion"));
}

}  // namespace retarget
