// Motion.reference: positions, velocities, accelerations, forces and torques for controllers.

#include "reference.h"

#include <nanobind/stl/string.h>

#include <utility>

#include "arrays.h"
#include "raise.h"
#include "retarget/reference.h"
#include "watcher.h"

namespace retarget::python {
namespace {

void add_dynamics(MotionReference& made, nb::dict& arrays) {
  const std::size_t rows = made.samples, joints = made.joint_names.size(),
                    points = made.contact_names.size();
  arrays["mass"] = made.mass;
  arrays["torque"] = array_of(std::move(made.torque), {rows, joints});
  arrays["residual"] = array_of(std::move(made.residual), {rows, 6});
  arrays["com"] = array_of(std::move(made.com), {rows, 3});
  arrays["com_vel"] = array_of(std::move(made.com_velocity), {rows, 3});
  arrays["com_acc"] = array_of(std::move(made.com_acceleration), {rows, 3});
  arrays["angular_momentum"] = array_of(std::move(made.angular_momentum), {rows, 3});
  arrays["contact_names"] = names_of(made.contact_names);
  arrays["contact_links"] = names_of(made.contact_links);
  arrays["contacts"] = array_of_flags(std::move(made.contacts), {rows, points});
  arrays["contact_pos"] = array_of(std::move(made.contact_position), {rows, points, 3});
  arrays["contact_force"] = array_of(std::move(made.contact_force), {rows, points, 3});
}

}  // namespace

nb::dict reference_arrays(const MotionHandle& motion, double rate) {
  ReferenceOptions options;
  options.rate = rate_of(rate);
  options.planted = foot_contacts(motion);
  if (motion.solved) {
    options.limits = motion.solved->plan.limits;
    if (motion.solved->scene) options.scene = &motion.solved->scene->clip;
  }
  Watcher watcher(nb::none());
  options.keep_going = [&] { return watcher.keep_going({}); };
  auto done = [&] {
    const ReleasedGil released;
    return make_reference(*motion.clip, options);
  }();
  watcher.rethrow();
  MotionReference made = value_of(std::move(done));
  const std::size_t rows = made.samples, joints = made.joint_names.size();
  nb::dict arrays;
  arrays["fps"] = made.rate.fps();
  arrays["joint_names"] = names_of(made.joint_names);
  arrays["time"] = array_of(std::move(made.time), {rows});
  arrays["qpos"] = array_of(std::move(made.qpos), {rows, 7 + joints});
  arrays["qvel"] = array_of(std::move(made.qvel), {rows, 6 + joints});
  arrays["qacc"] = array_of(std::move(made.qacc), {rows, 6 + joints});
  arrays["joint_lower"] = array_of(std::move(made.lower), {joints});
  arrays["joint_upper"] = array_of(std::move(made.upper), {joints});
  arrays["speed_limits"] = array_of(std::move(made.speed_limits), {joints});
  arrays["torque_limits"] = array_of(std::move(made.torque_limits), {joints});
  if (made.has_dynamics) add_dynamics(made, arrays);
  if (made.planted) {
    arrays["planted"] = array_of_flags(std::move(made.planted->planted), {rows, 4});
    std::vector<std::string> names(kContactNames.begin(), kContactNames.end());
    arrays["planted_names"] = names_of(names);
  }
  arrays["notes"] = names_of(reference_notes(made));
  return arrays;
}

}  // namespace retarget::python
