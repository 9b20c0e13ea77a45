#include "retarget/motion_io.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/npz_writer.h"
#include "base/pickle_writer.h"
#include "base/try.h"
#include "io/gltf_motion.h"
#include "math/so3.h"
#include "retarget/clip.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/pose.h"
#include "retarget/robot.h"
#include "robot/variant.h"

namespace retarget {
namespace {

// PBHC's pose_aa ends in rows for the head and the hands, which stay zero
constexpr std::size_t kEmptyRows = 3;

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

std::string gmr_pickle(const RobotClip& clip) {
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
  return pickle.finish();
}

// rotation vectors of the root and of the joints about their axes
std::vector<double> rotation_vectors(const RobotClip& clip) {
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
    for (std::size_t i = 0; i < kEmptyRows; ++i) append(Eigen::Vector3d::Zero());
  }
  return vectors;
}

std::string pbhc_pickle(const RobotClip& clip, const std::string& name) {
  const MotionTables tables = tables_of(clip);
  PickleWriter pickle;
  pickle.begin_dict();
  pickle.text(name.empty() ? "motion" : name);
  pickle.begin_dict();
  pickle.array("root_trans_offset", float32_array(tables.position, {tables.frames, 3}));
  pickle.array("pose_aa", float32_array(rotation_vectors(clip),
                                        {tables.frames, 1 + tables.joint_count + kEmptyRows, 3}));
  pickle.array("dof", float32_array(tables.joints, {tables.frames, tables.joint_count}));
  pickle.array("root_rot", float32_array(tables.rotation_xyzw, {tables.frames, 4}));
  put_fps(pickle, clip.rate());
  pickle.end_dict();
  pickle.end_dict();
  return pickle.finish();
}

}  // namespace

RobotClip with_robot(const RobotClip& clip, std::shared_ptr<const Robot> robot) {
  RobotClip changed(std::move(robot), clip.rate(), clip.frame_count());
  const Robot& other = changed.robot();
  // places of a joint in a configuration of this robot and of the other, whose models may differ
  std::vector<std::pair<int, int>> addresses;
  for (const int index : other.output_joints()) {
    const RobotJoint& joint = other.joints()[index];
    const auto own = clip.robot().find_joint(joint.name);
    if (!own) continue;
    addresses.emplace_back(clip.robot().joints()[*own].qpos_address, joint.qpos_address);
  }
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto from = clip.qpos(frame);
    const auto to = changed.qpos(frame);
    for (std::size_t i = 0; i < 7; ++i) to[i] = from[i];
    for (const auto& [source, target] : addresses) to[target] = from[source];
  }
  return changed;
}

Result<std::shared_ptr<const Robot>> pbhc_robot(const std::shared_ptr<const Robot>& robot) {
  if (!robot->variant().name.empty()) return robot;
  for (const RobotVariant& variant : robot->profile().variants) {
    if (variant.name.ends_with("pbhc")) return robot_variant(robot, variant.name);
  }
  return robot;
}

Result<std::string> format_robot_motion(const RobotClip& clip, MotionFormat format,
                                        const WriteMotionOptions& options) {
  switch (format) {
    case MotionFormat::kCsv:
      return format_robot_csv(clip, options.csv);
    case MotionFormat::kCsvSoma:
      return format_robot_csv(clip, soma_csv_options(clip.rate(), options.csv.precision));
    case MotionFormat::kPklGmr:
      return gmr_pickle(clip);
    case MotionFormat::kPklPbhc: {
      TRY_ASSIGN(auto robot, pbhc_robot(clip.shared_robot()));
      return pbhc_pickle(with_robot(clip, std::move(robot)), options.name);
    }
    case MotionFormat::kNpzMjlab:
    case MotionFormat::kNpzBeyondMimic: {
      TRY_ASSIGN(const auto motion, make_tracking_motion(clip, format, options.tracking));
      return format_tracking_npz(motion);
    }
    case MotionFormat::kGlb:
      return format_robot_glb(clip, options.human ? &*options.human : nullptr, options.name);
  }
  return run_failure("", "there is no such format");
}

}  // namespace retarget
