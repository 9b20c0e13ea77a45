// retarget.Motion: a robot motion, solved or read from a file.

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "arrays.h"
#include "bindings.h"
#include "handles.h"
#include "keywords.h"
#include "raise.h"
#include "reference.h"
#include "retarget/check_options.h"
#include "retarget/motion_io.h"
#include "retarget/option_table.h"
#include "retarget/run.h"

namespace retarget::python {

using namespace nb::literals;

std::optional<FootContacts> foot_contacts(const MotionHandle& motion) {
  return motion.solved ? contacts_of(*motion.solved) : motion.contacts;
}

std::shared_ptr<const RecordedRun> run_of(const MotionHandle& motion) {
  if (!motion.solved) return motion.recorded;
  const Plan& plan = motion.solved->plan;
  RecordedRun recorded;
  recorded.run.motion = motion.name;
  recorded.run.robot = motion.robot.loaded.choice;
  recorded.run.options = plan.options;
  recorded.time_scale = plan.time_scale;
  return std::make_shared<const RecordedRun>(std::move(recorded));
}

RecordedMotion record_of(const MotionHandle& motion) {
  RecordedMotion record{motion.name, std::nullopt, motion.part_start};
  if (const auto run = run_of(motion)) record.recorded = *run;
  return record;
}

RecordedMotion record_against(const MotionHandle& motion, const ClipHandle& clip,
                              Observer& observer) {
  RecordedMotion record = record_of(motion);
  const bool is_of_sidecar = motion.solved == nullptr && motion.is_of_file;
  if (!clip.is_edited() || !is_of_sidecar || !record.recorded) return record;
  PartOptions& part = record.recorded->run.options.part;
  bool& mirror = record.recorded->mirror;
  if (!has_part(part) && !mirror) return record;
  part = without_part(part);
  mirror = false;
  observer.warn({{0, 0,
                  "the sidecar records a part or the mirroring of its source, which is not applied "
                  "to an edited clip"}},
                motion.name);
  return record;
}

Options measuring_options(const MotionHandle& motion) {
  Options options;
  const bool is_of_file = motion.solved == nullptr && motion.is_of_file;
  if (const auto run = run_of(motion); run && !is_of_file) options = run->run.options;
  options.time.fps = motion.clip->rate().fps();
  return options;
}

namespace {

constexpr std::size_t kRoot = 7;  // Values of a configuration before the joints.

std::size_t frames_of(const MotionHandle& motion) {
  return static_cast<std::size_t>(motion.clip->frame_count());
}

const double* numbers_of(const MotionHandle& motion) {
  return motion.clip->frame_count() == 0 ? nullptr : motion.clip->qpos(0).data();
}

// Returns a view of columns [begin, begin + count) of the configurations.
nb::object columns(const MotionHandle& motion, std::size_t begin, std::size_t count) {
  const auto width = static_cast<std::int64_t>(motion.robot->configuration_size());
  const double* numbers = numbers_of(motion);
  return shared_array(numbers == nullptr ? nullptr : numbers + begin, {frames_of(motion), count},
                      motion.clip, {width, 1});
}

nb::object qpos(const MotionHandle& motion) {
  return columns(motion, 0, static_cast<std::size_t>(motion.robot->configuration_size()));
}

nb::object root_rotation_xyzw(const MotionHandle& motion) {
  std::vector<double> numbers;
  for (int frame = 0; frame < motion.clip->frame_count(); ++frame) {
    const auto root = motion.clip->qpos(frame);
    numbers.insert(numbers.end(), {root[4], root[5], root[6], root[3]});
  }
  return array_of(std::move(numbers), {frames_of(motion), 4});
}

nb::object joint_positions(const MotionHandle& motion) {
  const Robot& robot = *motion.robot;
  std::vector<std::size_t> addresses;
  for (const int joint : robot.output_joints()) {
    addresses.push_back(static_cast<std::size_t>(robot.joints()[joint].qpos_address));
  }
  bool in_order = true;
  for (std::size_t i = 0; i < addresses.size(); ++i) in_order &= addresses[i] == kRoot + i;
  if (in_order) return columns(motion, kRoot, addresses.size());
  std::vector<double> numbers;
  for (int frame = 0; frame < motion.clip->frame_count(); ++frame) {
    for (const std::size_t address : addresses)
      numbers.push_back(motion.clip->qpos(frame)[address]);
  }
  return array_of(std::move(numbers), {frames_of(motion), addresses.size()});
}

nb::list joints_of_motion(const MotionHandle& motion) {
  nb::list names;
  for (const int joint : motion.robot->output_joints()) {
    names.append(name_of(motion.robot->joints()[joint].name));
  }
  return names;
}

nb::object contacts(const MotionHandle& motion) {
  std::optional<FootContacts> known = foot_contacts(motion);
  if (!known) return nb::none();
  return array_of_flags(std::move(known->planted), {frames_of(motion), 4});
}

nb::list contact_names() {
  nb::list names;
  for (const std::string_view name : kContactNames) names.append(text_of(name));
  return names;
}

nb::object source(const MotionHandle& motion) {
  return motion.solved ? nb::cast(ClipHandle(motion.solved->source)) : nb::none();
}

// A motion's own precision is a default, which formats that print no numbers ignore. If it is the
// only option that the formats reject, it has no effect on them.
void drop_unused_precision(const std::string& path, SaveOptions& save) {
  if (plan_outputs(path, save)) return;
  SaveOptions usual = save;
  usual.precision = SaveOptions().precision;
  if (plan_outputs(path, usual)) save = std::move(usual);
}

void save_motion(const MotionHandle& motion, const nb::object& file, const nb::kwargs& options) {
  SaveOptions how = motion.save;
  apply_keywords(save_table(how), options);
  const std::string path = bytes_of_path(file, "path");
  if (path == "-") raise(usage_failure("path: expected a file, found standard output").value());
  if (!options.contains("precision")) drop_unused_precision(path, how);
  without_gil([&]() -> Result<void> {
    // Save the Motion if there is one: a GLB then shows the human as well.
    if (motion.solved) return retarget::save(*motion.solved, path, how);
    if (!motion.contacts) return retarget::save(*motion.clip, path, how);
    Observer silent;
    const auto written = write_motion(*motion.clip, motion.contacts, path, how, silent);
    return written ? Result<void>() : failure(written.error());
  });
  for (const MotionFormat format : how.formats) {
    const FrameRate rate = rate_of_format(format, how, motion.clip->rate());
    warn(format_losses(*motion.clip, format, rate), path);
  }
}

nb::object rows(std::vector<double> numbers, std::size_t frames, std::size_t items,
                std::size_t width) {
  if (width == 1) return array_of(std::move(numbers), {frames, items});
  return array_of(std::move(numbers), {frames, items, width});
}

nb::dict tracking(const MotionHandle& motion, const nb::kwargs& options) {
  SaveOptions how = motion.save;
  how.formats = {MotionFormat::kNpzMjlab};
  apply_keywords(rows_for(OptionUse::kTrack, save_table(how)), options);
  if (how.formats.size() != 1 || format_ending(how.formats.front()) != ".npz") {
    raise(usage_failure("format: expected npz-mjlab or npz-beyondmimic").value());
  }
  TrackingOptions what{{how.npz_fps, 1}, how.npz_velocity};
  if (!motion.solved) what = conversion_options(what, motion.clip->rate());
  TrackingMotion made =
      without_gil([&] { return make_tracking_motion(*motion.clip, how.formats.front(), what); });
  const std::size_t frames = made.frames, joints = made.joint_names.size(),
                    bodies = made.body_names.size();
  nb::dict arrays;
  arrays["fps"] = made.rate.fps();
  arrays["joint_names"] = names_of(made.joint_names);
  arrays["body_names"] = names_of(made.body_names);
  arrays["joint_pos"] = rows(std::move(made.joint_pos), frames, joints, 1);
  arrays["joint_vel"] = rows(std::move(made.joint_vel), frames, joints, 1);
  arrays["body_pos_w"] = rows(std::move(made.body_pos), frames, bodies, 3);
  arrays["body_quat_w"] = rows(std::move(made.body_quat), frames, bodies, 4);
  arrays["body_lin_vel_w"] = rows(std::move(made.body_lin_vel), frames, bodies, 3);
  arrays["body_ang_vel_w"] = rows(std::move(made.body_ang_vel), frames, bodies, 3);
  return arrays;
}

std::shared_ptr<const RecordedRun> recorded_run_of(const std::string& path) {
  const ReleasedGil released;
  auto recorded = recorded_run(path);
  return recorded ? std::make_shared<const RecordedRun>(*std::move(recorded)) : nullptr;
}

MotionHandle load_motion(const nb::object& file, const RobotHandle& robot,
                         const nb::dict& options) {
  ReadingOptions given;
  double memory_gb = 0.0;
  OptionTable table = reading_table(given);
  table.push_back(memory_row(memory_gb));
  apply_keywords(table, options);
  const std::string path = bytes_of_path(file, "file");
  RobotMotion read = without_gil([&]() -> Result<RobotMotion> {
    ReadMotionOptions how = read_motion_options(given);
    how.max_bytes = memory_share(memory_gb);
    return load_recorded_motion(path, robot.loaded.robot, how);
  });
  auto recorded = recorded_run_of(path);
  warn(read.warnings, path);
  std::string summary =
      std::string(format_name(read.format)) + (read.rate_known ? "" : ", which has no frame rate");
  for (const std::string& note : read.notes) summary += "\n" + note;
  MotionHandle motion{nullptr, std::make_shared<const RobotClip>(std::move(read.clip)),
                      robot,   nullptr,
                      path,    std::move(summary)};
  motion.contacts = std::move(read.contacts);
  motion.recorded = std::move(recorded);
  motion.rate_known = read.rate_known;
  // The columns of the file may be those of a variant.
  motion.robot.loaded.robot = motion.clip->shared_robot();
  return motion;
}

std::string shown_motion(const MotionHandle& motion) {
  return fmt::format("<retarget.Motion of {}: {} frames at {} fps, {} joints>",
                     nb::cast<std::string>(text_of(motion.robot->name())),
                     motion.clip->frame_count(), to_text(motion.clip->rate()),
                     motion.robot->output_joints().size());
}

}  // namespace

void bind_motion(nb::module_& module) {
  nb::class_<MotionHandle>(
      module, "Motion",
      "A robot motion.\n\n"
      "Metres, radians, world frame with z up. Arrays are read-only; F frames, "
      "N joints in the order of joint_names.")
      .def_prop_ro(
          "fps", [](const MotionHandle& motion) { return motion.clip->rate().fps(); },
          "Frames per second.")
      .def_prop_ro(
          "frame_count", [](const MotionHandle& motion) { return motion.clip->frame_count(); },
          "F.")
      .def_prop_ro(
          "duration",
          [](const MotionHandle& motion) {
            return motion.clip->rate().time_of(std::max(motion.clip->frame_count() - 1, 0));
          },
          "Seconds from the first to the last frame.")
      .def_prop_ro("joint_names", &joints_of_motion, nb::sig("def joint_names(self) -> list[str]"),
                   "N names, in the order of the output columns.")
      .def_prop_ro("qpos", &qpos, nb::sig("def qpos(self) -> numpy.ndarray"),
                   "(F, 7 + n) float64: MuJoCo's configurations, root x y z, root quaternion "
                   "w x y z, then all n joints of the model in its order.")
      .def_prop_ro(
          "root_position", [](const MotionHandle& motion) { return columns(motion, 0, 3); },
          nb::sig("def root_position(self) -> numpy.ndarray"), "(F, 3) float64, metres.")
      .def_prop_ro(
          "root_rotation_wxyz", [](const MotionHandle& motion) { return columns(motion, 3, 4); },
          nb::sig("def root_rotation_wxyz(self) -> numpy.ndarray"),
          "(F, 4) float64: world_from_root, unit quaternions w x y z, sign-continuous.")
      .def_prop_ro("root_rotation_xyzw", &root_rotation_xyzw,
                   nb::sig("def root_rotation_xyzw(self) -> numpy.ndarray"),
                   "(F, 4) float64: the same, x y z w; a copy.")
      .def_prop_ro("joint_positions", &joint_positions,
                   nb::sig("def joint_positions(self) -> numpy.ndarray"),
                   "(F, N) float64: rad; metres for slide joints.")
      .def_prop_ro(
          "contacts", &contacts, nb::sig("def contacts(self) -> numpy.ndarray | None"),
          "(F, 4) bool: contacts of the source's heels and toes, which the fit maintains; "
          "columns are contact_names. Those of the file or of from_qpos() otherwise. None: "
          "unknown.")
      .def_prop_ro(
          "contact_names", [](const MotionHandle&) { return contact_names(); },
          nb::sig("def contact_names(self) -> list[str]"), "Columns of contacts.")
      .def_prop_ro("source", &source, nb::sig("def source(self) -> Clip | None"),
                   "The human clip, with the same frames as the motion; None if the motion was "
                   "read from a file.")
      .def_prop_ro(
          "robot", [](const MotionHandle& motion) { return motion.robot; },
          nb::sig("def robot(self) -> Robot"), "Robot of the motion.")
      .def_prop_ro(
          "summary", [](const MotionHandle& motion) { return text_of(motion.summary); },
          "Decisions made, or properties detected in the file, line by line.")
      .def("save", &save_motion, "path"_a.none(), "options"_a,
           nb::sig("def save(self, path: str | os.PathLike[str], **options: "
                   "typing_extensions.Unpack[retarget._options.SaveOptions]) -> None"),
           "Writes the motion atomically in the format given by the path's extension or `format`; "
           "docs/formats.md.\n\nOptions are those of the command line; the motion's own options "
           "are the defaults.")
      .def("tracking", &tracking, "options"_a,
           nb::sig("def tracking(self, **options: "
                   "typing_extensions.Unpack[retarget._options.TrackingOptions]) -> dict[str, "
                   "typing.Any]"),
           "The arrays of a tracking NPZ, as float64: joint_pos, joint_vel (T, N), body_pos_w, "
           "body_quat_w (wxyz), body_lin_vel_w, body_ang_vel_w (T, B, 3 or 4), fps and names.")
      .def("reference", &reference_arrays, "rate"_a = 200.0,
           nb::sig("def reference(self, rate: float = 200.0) -> dict[str, typing.Any]"),
           "The motion for a controller, rate samples per second from 10 to 1000 "
           "(docs/references.md): time, qpos, qvel, qacc (T, 7 + N or 6 + N), torque (T, N), "
           "residual, com, com_vel, com_acc, angular_momentum, contacts (T, P), contact_pos, "
           "contact_force (T, P, 3), limits and names; `notes` says what is beyond limits.")
      .def_prop_ro(
          "name", [](const MotionHandle& motion) { return text_of(motion.name); },
          "Name of the motion in reports: its file, or that of its source.")
      .def(
          "_repr_html_",
          [](nb::handle_t<MotionHandle> motion) {
            return nb::module_::import_("retarget._view").attr("player_of")(motion);
          },
          nb::sig("def _repr_html_(self) -> str"), "A player, for notebooks.")
      .def("__len__", [](const MotionHandle& motion) { return motion.clip->frame_count(); })
      .def("__repr__", &shown_motion);
  module.def("load_motion", &load_motion, "file"_a.none(), "robot"_a, "options"_a);
}

}  // namespace retarget::python
