// Motions from arrays and from motions: from_qpos, parts, other rates; and as a dictionary.

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <cmath>
#include <optional>

#include "arrays.h"
#include "bindings.h"
#include "handles.h"
#include "raise.h"
#include "retarget/motion_io.h"
#include "retarget/resample.h"

namespace retarget::python {

using namespace nb::literals;

namespace {

// Beyond this, a quaternion is wrong and not only rounded.
constexpr double kUnitTolerance = 1e-3;
// Up to this, its bits are kept, so that the numbers of a Motion round-trip.
constexpr double kExactTolerance = 1e-12;

[[noreturn]] void refuse_qpos(const std::string& message) {
  raise(usage_failure(message).value());
}

// Readers of motion files reject larger numbers, and some formats cannot hold them.
void check_magnitudes(const GivenArray& given, std::size_t width) {
  constexpr double kMaxMagnitude = 1e6;
  const auto numbers = given.numbers();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (std::abs(numbers[i]) <= kMaxMagnitude) continue;
    refuse_qpos(fmt::format("qpos[{}, {}]: expected at most 1e6, found {}", i / width, i % width,
                            numbers[i]));
  }
}

// Joints that a variant locks, and a fixed base, stay where the robot holds them.
void check_held_values(const Robot& robot, const RobotClip& clip) {
  constexpr double kHeldTolerance = 1e-6;
  const std::vector<double> zero = robot.zero_configuration();
  struct Held {
    std::size_t address;
    std::string name;
  };
  std::vector<Held> held;
  if (robot.fixed_base()) {
    for (std::size_t i = 0; i < 7; ++i) held.push_back({i, "the fixed base"});
  }
  for (const auto& [name, position] : robot.variant().locked) {
    const auto joint = robot.find_joint(name);
    if (!joint) continue;
    held.push_back({static_cast<std::size_t>(robot.joints()[*joint].qpos_address), name});
  }
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (const auto& [address, name] : held) {
      const double found = clip.qpos(frame)[address];
      if (std::abs(found - zero[address]) <= kHeldTolerance) continue;
      refuse_qpos(fmt::format("qpos[{}, {}]: {} is locked at {} in this robot, found {}", frame,
                              address, nb::cast<std::string>(text_of(name)), zero[address], found));
    }
  }
}

std::optional<FootContacts> contacts_in(const nb::object& contacts, std::size_t frames) {
  if (contacts.is_none()) return std::nullopt;
  const nb::module_ numpy = nb::module_::import_("numpy");
  const nb::object whole = numpy.attr("asarray")(contacts);
  const bool is_flags = nb::cast<std::string>(whole.attr("dtype").attr("kind")) == "b";
  const GivenArray given(is_flags ? whole.attr("astype")("uint8") : whole, "contacts",
                         {static_cast<std::int64_t>(frames), 4});
  FootContacts planted;
  for (const double flag : given.numbers()) planted.planted.push_back(flag > 0.5 ? 1 : 0);
  return planted;
}

MotionHandle from_qpos(const nb::object& qpos, const RobotHandle& robot, double fps,
                       const nb::object& contacts, const nb::object& name) {
  const FrameRate rate = rate_of(fps);
  const std::int64_t width = robot->configuration_size();
  const GivenArray given(qpos, "qpos", {-1, width});
  const std::size_t frames = given.size(0);
  if (frames == 0) refuse_qpos("qpos: expected at least one frame");
  if (frames > 100'000'000) refuse_qpos("qpos: too many frames");
  check_magnitudes(given, static_cast<std::size_t>(width));
  RobotClip clip(robot.loaded.robot, rate, static_cast<int>(frames));
  Eigen::Vector4d before = Eigen::Vector4d::Zero();
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const auto row = given.numbers().subspan(frame * static_cast<std::size_t>(width),
                                             static_cast<std::size_t>(width));
    const auto out = clip.qpos(static_cast<int>(frame));
    std::copy(row.begin(), row.end(), out.begin());
    Eigen::Map<Eigen::Vector4d> wxyz(&out[3]);
    const double norm = wxyz.norm();
    if (std::abs(norm - 1.0) > kUnitTolerance) {
      refuse_qpos(fmt::format(
          "qpos[{}, 3:7]: expected a unit quaternion w x y z, found the norm {}", frame, norm));
    }
    if (std::abs(norm - 1.0) > kExactTolerance) wxyz /= norm;
    if (before.dot(wxyz) < 0.0) wxyz = -wxyz;
    before = wxyz;
  }
  check_held_values(*robot, clip);
  MotionHandle motion{nullptr,
                      std::make_shared<const RobotClip>(std::move(clip)),
                      robot,
                      nullptr,
                      bytes_of_name(name, "name"),
                      "from arrays"};
  motion.contacts = contacts_in(contacts, frames);
  return motion;
}

// Makes `made`, the same motion or a part of it, one of the same run.
void keep_run(const MotionHandle& motion, MotionHandle& made) {
  made.recorded = run_of(motion);
  made.is_of_file = motion.solved == nullptr && motion.is_of_file;
  made.part_start = motion.part_start;
}

MotionHandle part_of(const MotionHandle& motion, const nb::object& index) {
  if (!PySlice_Check(index.ptr())) {
    raise_type_error(
        "index a motion with a slice, such as motion[10:200]; motion.qpos[i] is one frame");
  }
  Py_ssize_t begin = 0, end = 0, step = 0;
  if (PySlice_Unpack(index.ptr(), &begin, &end, &step) < 0) throw nb::python_error();
  if (step != 1) {
    raise(usage_failure("a slice of a motion must have the step 1, found " + std::to_string(step),
                        "motion.resample(fps) changes the frame rate")
              .value());
  }
  const Py_ssize_t count = PySlice_AdjustIndices(motion.clip->frame_count(), &begin, &end, step);
  if (count == 0)
    raise(usage_failure("the slice has no frames of the motion's " +
                        std::to_string(motion.clip->frame_count()))
              .value());
  RobotClip clip(motion.clip->shared_robot(), motion.clip->rate(), static_cast<int>(count));
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto from = motion.clip->qpos(static_cast<int>(begin) + frame);
    std::copy(from.begin(), from.end(), clip.qpos(frame).begin());
  }
  MotionHandle part{
      nullptr,
      std::make_shared<const RobotClip>(std::move(clip)),
      motion.robot,
      nullptr,
      motion.name,
      fmt::format("frames {} to {} of {}", begin, begin + count, motion.clip->frame_count()),
      motion.save};
  part.rate_known = motion.rate_known;
  keep_run(motion, part);
  part.part_start = motion.part_start.value_or(0.0) +
                    static_cast<double>(begin) * motion.clip->rate().frame_time();
  if (auto contacts = foot_contacts(motion)) {
    const auto first = contacts->planted.begin() + 4 * begin;
    part.contacts = FootContacts{{first, first + 4 * count}};
  }
  return part;
}

MotionHandle at_other_rate(const MotionHandle& motion, double fps) {
  const FrameRate rate = rate_of(fps);
  RobotClip clip = without_gil([&] { return resample_robot(*motion.clip, rate); });
  MotionHandle made{
      nullptr,      std::make_shared<const RobotClip>(std::move(clip)),
      motion.robot, nullptr,
      motion.name,  fmt::format("resampled from {} fps", to_text(motion.clip->rate())),
      motion.save};
  keep_run(motion, made);
  if (const auto contacts = foot_contacts(motion)) {
    made.contacts =
        resample_contacts(*contacts, motion.clip->rate(), rate, made.clip->frame_count());
  }
  return made;
}

nb::dict as_dictionary(nb::handle_t<MotionHandle> motion) {
  nb::dict all;
  for (const char* name : {"fps", "joint_names", "qpos", "root_position", "root_rotation_wxyz",
                           "joint_positions", "contacts", "contact_names"}) {
    all[name] = motion.attr(name);
  }
  all["robot"] = motion.attr("robot").attr("name");
  return all;
}

}  // namespace

void bind_motion_arrays(nb::module_& module) {
  nb::borrow<nb::class_<MotionHandle>>(module.attr("Motion"))
      .def_static(
          "from_qpos",
          [](const nb::args& given, const nb::kwargs& named) {
            return nb::module_::import_("retarget._motions")
                .attr("motion_from_qpos")(*given, **named);
          },
          "given"_a, "named"_a,
          nb::sig(
              "def from_qpos(qpos: numpy.typing.ArrayLike, robot: Robot | str | "
              "os.PathLike[str], fps: float, contacts: numpy.typing.ArrayLike | None = None, *, "
              "name: str = 'qpos') -> Motion"),
          "Makes a motion from configurations.\n\n"
          "qpos: (F, 7 + n), F at least 1: root x y z in metres, Z up, root quaternion w x y z "
          "(world_from_root), all n joints of the model in its order, rad or m.\n"
          "robot: a robot, or an argument of Robot().\n"
          "fps: frames per second.\n"
          "contacts: (F, 4) bool, columns as contact_names; None: unknown.\n"
          "name: name of the motion in messages and reports.\n\n"
          "Quaternions are normalised and made sign-continuous; other numbers are kept bit for "
          "bit.\n\n"
          "Raises UsageError: another shape, numbers that are not finite or beyond 1e6, "
          "quaternions "
          "that are not of unit length, joints that the robot's variant holds elsewhere.")
      .def("__getitem__", &part_of, "frames"_a,
           nb::sig("def __getitem__(self, frames: slice) -> Motion"),
           "The frames of a slice as a separate motion, with its contacts; negative indices count "
           "from the end. The result has no source; pass one to evaluate(), which cuts it at the "
           "time of the slice unless `start` or `frames` is given.\n\n"
           "Raises UsageError: a step other than 1, no frames; TypeError: not a slice.")
      .def("resample", &at_other_rate, "fps"_a, nb::sig("def resample(self, fps: float) -> Motion"),
           "The motion at another frame rate, with its contacts: cubic interpolation, after a "
           "low-pass "
           "filter if the rate is lower.\n\n"
           "fps: frames per second.\n\n"
           "Raises InputError: a rate that gives too many frames.")
      .def("to_dict", &as_dictionary, nb::sig("def to_dict(self) -> dict[str, typing.Any]"),
           "fps, robot, joint_names, qpos (F, 7 + n), root_position (F, 3), root_rotation_wxyz "
           "(F, 4), joint_positions (F, N), contacts (F, 4) or None, contact_names; units and "
           "frames are those of the properties of these names.");
  module.def("motion_from_qpos", &from_qpos, "qpos"_a.none(), "robot"_a, "fps"_a,
             "contacts"_a.none(), "name"_a);
}

}  // namespace retarget::python
