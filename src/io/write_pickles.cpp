#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/npz_writer.h"
#include "base/pickle_writer.h"
#include "base/try.h"
#include "io/motion_writers.h"
#include "math/so3.h"
#include "retarget/clip.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/pose.h"
#include "retarget/robot.h"

namespace retarget {
namespace {

// PBHC's pose_aa ends in rows for the head and the hands, which stay zero
constexpr std::size_t kEmptyRowsOfPbhc = 3;

void put_fps(PickleWriter& pickle, const FrameRate& rate) {
  pickle.text("fps");
  if (rate.seconds == 1) {
    pickle.integer(rate.frames);
  } else {
    pickle.number(rate.fps());
  }
}

// what both dictionaries have, frame by frame
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

// positions of all bodies below the world, the root at the origin and unturned
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
      const Eigen::Vector3d& place = root_from_body[b].translation;
      positions.insert(positions.end(), {place.x(), place.y(), place.z()});
    }
  }
  return positions;
}

// rotation vectors of the root and of the joints about their axes, then rows of zeros
std::vector<double> rotation_vectors(const RobotClip& clip, std::size_t empty_rows) {
  const Robot& robot = clip.robot();
  std::vector<double> vectors;
  const auto append = [&](const Eigen::Vector3d& v) {
    vectors.insert(vectors.end(), {v.x(), v.y(), v.z()});
  };
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto qpos = clip.qpos(frame);
    append(log_so3(Eigen::Quaterniond(qpos[3], qpos[4], qpos[5], qpos[6])));
    for (const int index : robot.output_joints()) {
      const RobotJoint& joint = robot.joints()[index];
      append(qpos[joint.qpos_address] * joint.axis);
    }
    for (std::size_t i = 0; i < empty_rows; ++i) append(Eigen::Vector3d::Zero());
  }
  return vectors;
}

// of the left and the right foot
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

}  // namespace

MotionFiles write_gmr_pickle(const RobotClip& clip, MotionFormat /*format*/,
                             const WriteMotionOptions& /*options*/) {
  const MotionTables tables = tables_of(clip);
  std::vector<std::string> bodies = clip.robot().body_names();
  bodies.erase(bodies.begin());  // the world
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
  pickle.integer(0);  // the motion ends, it does not begin again
  put_fps(pickle, clip.rate());
  pickle.text("frames");
  pickle.begin_list();
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto qpos = clip.qpos(frame);
    const Eigen::Vector3d turn = log_so3(Eigen::Quaterniond(qpos[3], qpos[4], qpos[5], qpos[6]));
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

}  // namespace retarget
