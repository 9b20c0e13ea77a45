// Tracking arrays as NPZ files.

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/npz_writer.h"
#include "base/try.h"
#include "io/motion_writers.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"

namespace retarget {
namespace {

// appends `width` numbers of a row
void append_row(std::vector<double>& to, const std::vector<double>& from, std::size_t begin,
                std::size_t width) {
  const auto first = from.begin() + static_cast<std::ptrdiff_t>(begin);
  to.insert(to.end(), first, first + static_cast<std::ptrdiff_t>(width));
}

// holosoma's joint arrays begin with the root, as in MuJoCo's qpos and qvel
void add_joints_behind_root(const TrackingMotion& motion, NpzWriter& npz) {
  const std::size_t joints = motion.joint_names.size(), bodies = motion.body_names.size();
  std::vector<double> positions, velocities;
  for (std::size_t frame = 0; frame < motion.frames; ++frame) {
    append_row(positions, motion.body_pos, 3 * frame * bodies, 3);
    append_row(positions, motion.body_quat, 4 * frame * bodies, 4);
    append_row(positions, motion.joint_pos, frame * joints, joints);
    append_row(velocities, motion.body_lin_vel, 3 * frame * bodies, 3);
    append_row(velocities, motion.body_ang_vel, 3 * frame * bodies, 3);
    append_row(velocities, motion.joint_vel, frame * joints, joints);
  }
  npz.add("joint_pos", float32_array(positions, {motion.frames, 7 + joints}));
  npz.add("joint_vel", float32_array(velocities, {motion.frames, 6 + joints}));
}

}  // namespace

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
  return motion;
}

MotionFiles write_tracking_npz(const RobotClip& clip, MotionFormat format,
                               const WriteMotionOptions& options) {
  TRY_ASSIGN(const auto motion, tracking_with_contacts(clip, format, options, options.tracking));
  return one_file(format_tracking_npz(motion));
}

}  // namespace retarget
