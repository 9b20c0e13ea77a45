// retarget.Clip: a human motion, read from a file or made from arrays.

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "arrays.h"
#include "bindings.h"
#include "handles.h"
#include "keywords.h"
#include "raise.h"
#include "retarget/bvh.h"
#include "retarget/clip.h"
#include "retarget/clip_arrays.h"
#include "retarget/inspect.h"
#include "retarget/option_table.h"
#include "retarget/plan.h"
#include "retarget/try.h"

namespace retarget::python {

using namespace nb::literals;

std::shared_ptr<const WorldPoses> ClipHandle::world() const {
  const std::lock_guard lock(world_->mutex);
  if (world_->poses) return world_->poses;
  const auto joints = static_cast<std::size_t>(clip_->skeleton().joint_count());
  auto made = std::make_shared<WorldPoses>();
  made->positions.reserve(3 * joints * static_cast<std::size_t>(clip_->frame_count()));
  made->rotations.reserve(4 * joints * static_cast<std::size_t>(clip_->frame_count()));
  std::vector<Pose> world_from_joint(joints);
  for (int frame = 0; frame < clip_->frame_count(); ++frame) {
    forward_kinematics(*clip_, frame, world_from_joint);
    for (const auto& [rotation, position] : world_from_joint) {
      made->positions.insert(made->positions.end(), {position.x(), position.y(), position.z()});
      made->rotations.insert(made->rotations.end(),
                             {rotation.w(), rotation.x(), rotation.y(), rotation.z()});
    }
  }
  world_->poses = std::move(made);
  return world_->poses;
}

namespace {

std::vector<std::size_t> shape_of(const Clip& clip, std::size_t last) {
  return {static_cast<std::size_t>(clip.frame_count()),
          static_cast<std::size_t>(clip.skeleton().joint_count()), last};
}

std::shared_ptr<const WorldPoses> world_of(const ClipHandle& clip) {
  const ReleasedGil released;
  return clip.world();
}

nb::object positions(const ClipHandle& clip) {
  const auto world = world_of(clip);
  return shared_array(world->positions.data(), shape_of(*clip, 3), world);
}

nb::object rotations_wxyz(const ClipHandle& clip) {
  const auto world = world_of(clip);
  return shared_array(world->rotations.data(), shape_of(*clip, 4), world);
}

// Converts quaternions between wxyz and xyzw.
nb::object reordered(std::span<const double> numbers, bool scalar_first,
                     const std::vector<std::size_t>& shape) {
  std::vector<double> turned(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t from = scalar_first ? (i % 4 + 3) % 4 : (i % 4 + 1) % 4;
    turned[i] = numbers[i - i % 4 + from];
  }
  return array_of(std::move(turned), shape);
}

nb::object rotations_xyzw(const ClipHandle& clip) {
  return reordered(world_of(clip)->rotations, false, shape_of(*clip, 4));
}

std::span<const double> local_rotations(const Clip& clip) {
  if (clip.frame_count() == 0) return {};
  // A clip stores its rotations contiguously, frame-major.
  const std::size_t joints = clip.rotations(0).size();
  return {clip.rotations(0).data()->coeffs().data(),
          4 * joints * static_cast<std::size_t>(clip.frame_count())};
}

nb::object local_rotations_xyzw(const ClipHandle& clip) {
  return shared_array(local_rotations(*clip).data(), shape_of(*clip, 4), clip.shared());
}

nb::object local_rotations_wxyz(const ClipHandle& clip) {
  return reordered(local_rotations(*clip), true, shape_of(*clip, 4));
}

nb::object local_positions(const ClipHandle& clip) {
  std::vector<double> numbers;
  for (int frame = 0; frame < clip->frame_count(); ++frame) {
    for (int joint = 0; joint < clip->skeleton().joint_count(); ++joint) {
      const Eigen::Vector3d& position = clip->translation(frame, joint);
      numbers.insert(numbers.end(), position.begin(), position.end());
    }
  }
  return array_of(std::move(numbers), shape_of(*clip, 3));
}

nb::object offsets(const ClipHandle& clip) {
  std::vector<double> numbers;
  for (const Joint& joint : clip->skeleton().joints()) {
    numbers.insert(numbers.end(), joint.offset.begin(), joint.offset.end());
  }
  return array_of(std::move(numbers),
                  {static_cast<std::size_t>(clip->skeleton().joint_count()), 3});
}

nb::list parents(const ClipHandle& clip) {
  nb::list all;
  for (const Joint& joint : clip->skeleton().joints()) all.append(joint.parent);
  return all;
}

nb::list warnings_of(const ClipHandle& clip) {
  nb::list all;
  for (const Warning& each : clip->origin().warnings) all.append(text_of(describe(each, "")));
  return all;
}

ClipHandle from_arrays(const nb::list& names, const nb::list& parents, nb::object positions,
                       nb::object rotations, bool scalar_first, bool local, double fps,
                       const nb::object& name) {
  ClipArrays arrays;
  arrays.rate = rate_of(fps);
  arrays.scalar_first = scalar_first;
  arrays.local = local;
  arrays.name = bytes_of_name(name, "name");
  for (nb::handle each : names) arrays.names.push_back(bytes_of_name(each, "names"));
  for (nb::handle each : parents) arrays.parents.push_back(nb::cast<int>(each));
  const auto joints = static_cast<std::int64_t>(arrays.names.size());
  const GivenArray places(positions, "positions", {-1, joints, 3});
  const char* what = scalar_first ? "rotations_wxyz" : "rotations_xyzw";
  const GivenArray turns(rotations, what, {static_cast<std::int64_t>(places.size(0)), joints, 4});
  arrays.frames = places.size(0);
  arrays.positions = places.numbers();
  arrays.rotations = turns.numbers();
  return ClipHandle(without_gil([&] { return clip_from_arrays(arrays); }));
}

ClipHandle from_positions(nb::object positions, const nb::list& names, double fps,
                          const nb::object& name) {
  JointPositions motion;
  motion.rate = rate_of(fps);
  motion.name = bytes_of_name(name, "name");
  for (nb::handle each : names) motion.names.push_back(bytes_of_name(each, "names"));
  const auto named = static_cast<std::int64_t>(motion.names.size());
  const GivenArray places(positions, "positions", {-1, named > 0 ? named : -1, 3});
  motion.frames = places.size(0);
  motion.joints = places.size(1);
  motion.positions = places.numbers();
  ClipHandle clip(without_gil([&] { return clip_from_positions(motion); }));
  warn(clip->origin().warnings, clip->name());
  return clip;
}

ClipHandle load_clip_file(const nb::object& file, const nb::dict& options, bool skeleton_only,
                          const nb::object& data_dir) {
  const std::string chosen = bytes_of_folder(data_dir);
  SourceOptions source;
  apply_keywords(source_table(source), options);
  const std::string path = bytes_of_path(file, "file");
  ClipHandle clip(without_gil([&]() -> Result<Clip> {
    if (skeleton_only) return load_skeleton(path, source);
    if (source.from_robot.empty()) return load_clip(path, source);
    RETARGET_TRY_ASSIGN(const std::string folder, data_folder_of(chosen));
    return load_clip(path, source, DataFolder{folder});
  }));
  warn(clip->origin().warnings, clip->name());
  return clip;
}

void save_clip(const ClipHandle& clip, const nb::object& file, std::optional<int> decimals) {
  const std::string path = bytes_of_path(file, "path");
  without_gil([&] { return save_bvh(path, *clip, {decimals}); });
}

// Describes a clip as text and JSON.
nb::tuple inspect(const ClipHandle& handle, const nb::dict& options, const nb::object& data_dir) {
  Options how;
  const std::string chosen = bytes_of_folder(data_dir);
  apply_keywords(rows_for(OptionUse::kInspect, human_table(how.human)), options);
  const auto human = [&] {
    const ReleasedGil released;
    const auto folder = data_folder_of(chosen);
    Clip copy = *handle;
    return folder ? find_human_as_run(copy, how, *folder) : failure(folder.error());
  }();
  // Recognition failures are acceptable; invalid user options are not.
  if (!human && human.error().kind != ErrorKind::kInput) raise(human.error());
  Inspection found{handle->name(), *handle, handle->origin().warnings};
  if (human) {
    found.map = &human->map;
    found.calibration = &human->calibration;
  } else {
    found.reason = &human.error();
  }
  return nb::make_tuple(text_of(inspection_text(found)), text_of(inspection_json(found)));
}

std::string shown_clip(const ClipHandle& clip) {
  return fmt::format("<retarget.Clip {}: {} joints, {} frames at {} fps>",
                     nb::cast<std::string>(nb::repr(text_of(clip->name()))),
                     clip->skeleton().joint_count(), clip->frame_count(), to_text(clip->rate()));
}

}  // namespace

void bind_clip(nb::module_& module) {
  nb::class_<ClipHandle>(
      module, "Clip",
      "A human motion: a skeleton and its poses, in the units and axes of its file.\n\n"
      "Arrays are read-only; F frames, J joints in the order of joint_names.")
      .def_prop_ro(
          "name", [](const ClipHandle& clip) { return text_of(clip->name()); },
          "Name of the clip in messages: its file.")
      .def_prop_ro(
          "fps", [](const ClipHandle& clip) { return clip->rate().fps(); }, "Frames per second.")
      .def_prop_ro(
          "frame_count", [](const ClipHandle& clip) { return clip->frame_count(); }, "F.")
      .def_prop_ro(
          "duration", [](const ClipHandle& clip) { return clip->duration(); },
          "Seconds from the first to the last frame.")
      .def_prop_ro(
          "joint_names", [](const ClipHandle& clip) { return names_of(clip->skeleton().names()); },
          nb::sig("def joint_names(self) -> list[str]"), "J names, parents before children.")
      .def_prop_ro("parents", &parents, nb::sig("def parents(self) -> list[int]"),
                   "Index of each joint's parent; -1: the root.")
      .def_prop_ro("offsets", &offsets, nb::sig("def offsets(self) -> numpy.ndarray"),
                   "(J, 3) float64: joint offsets in the parent's frame, in the file's unit.")
      .def_prop_ro("positions", &positions, nb::sig("def positions(self) -> numpy.ndarray"),
                   "(F, J, 3) float64: joint positions in the world, in the file's unit and axes.")
      .def_prop_ro("rotations_wxyz", &rotations_wxyz,
                   nb::sig("def rotations_wxyz(self) -> numpy.ndarray"),
                   "(F, J, 4) float64: world_from_joint, unit quaternions w x y z.")
      .def_prop_ro("rotations_xyzw", &rotations_xyzw,
                   nb::sig("def rotations_xyzw(self) -> numpy.ndarray"),
                   "(F, J, 4) float64: world_from_joint, unit quaternions x y z w; a copy.")
      .def_prop_ro("rotations", &rotations_wxyz, nb::sig("def rotations(self) -> numpy.ndarray"),
                   "The same as rotations_wxyz.")
      .def_prop_ro("local_positions", &local_positions,
                   nb::sig("def local_positions(self) -> numpy.ndarray"),
                   "(F, J, 3) float64: joint positions in the parent's frame; a copy.")
      .def_prop_ro(
          "local_rotations_xyzw", &local_rotations_xyzw,
          nb::sig("def local_rotations_xyzw(self) -> numpy.ndarray"),
          "(F, J, 4) float64: parent_from_joint, unit quaternions x y z w, as stored in the clip.")
      .def_prop_ro("local_rotations_wxyz", &local_rotations_wxyz,
                   nb::sig("def local_rotations_wxyz(self) -> numpy.ndarray"),
                   "(F, J, 4) float64: parent_from_joint, unit quaternions w x y z; a copy.")
      .def_prop_ro("warnings", &warnings_of, nb::sig("def warnings(self) -> list[str]"),
                   "Warnings about the file.")
      .def("save", &save_clip, "path"_a.none(), "decimals"_a = nb::none(),
           nb::sig("def save(self, path: str | os.PathLike[str], decimals: int | None = None) -> "
                   "None"),
           "Writes the clip as BVH, atomically.\n\n"
           "decimals: digits after the decimal point; None: as many as necessary to read back the "
           "same numbers.")
      .def_static(
          "from_arrays",
          [](const nb::args& given, const nb::kwargs& named) {
            // The conversion of array-like arguments is simpler in Python.
            return nb::module_::import_("retarget._clips")
                .attr("clip_from_arrays")(*given, **named);
          },
          "given"_a, "named"_a,
          nb::sig("def from_arrays(names: collections.abc.Sequence[str], parents: "
                  "collections.abc.Sequence[int], positions: numpy.typing.ArrayLike, *, "
                  "rotations_wxyz: numpy.typing.ArrayLike | None = None, rotations_xyzw: "
                  "numpy.typing.ArrayLike | None = None, fps: float, space: str = 'world', name: "
                  "str = 'arrays') -> Clip"),
          "Makes a clip from the poses of named joints.\n\n"
          "names: J unique names; names known to recognition (docs/human.md) need no bone map.\n"
          "parents: index of each joint's parent; -1: the root.\n"
          "positions: (F, J, 3), any unit of length, any up axis.\n"
          "rotations_wxyz, rotations_xyzw: (F, J, 4) unit quaternions; one of them.\n"
          "fps: frames per second.\n"
          "space: 'world': joint poses in the world; 'local': in the parents' frames.\n"
          "name: name of the clip in messages.\n\n"
          "Joints are stored in depth-first order, so joint_names may differ from names. A joint "
          "at a constant distance from its parent (to 1e-4 of the longest) gets a fixed offset.\n\n"
          "Raises UsageError: wrong shapes, numbers that are not finite, quaternions that are not "
          "of "
          "unit length, parents that do not form a tree.")
      .def_static(
          "from_positions",
          [](const nb::args& given, const nb::kwargs& named) {
            return nb::module_::import_("retarget._clips")
                .attr("clip_from_positions")(*given, **named);
          },
          "given"_a, "named"_a,
          nb::sig("def from_positions(positions: numpy.typing.ArrayLike, names: "
                  "collections.abc.Sequence[str] | None = None, *, fps: float, name: str = "
                  "'positions') -> Clip"),
          "Makes a clip from joint positions without rotations; rotations are computed from limb "
          "directions and bending planes (docs/positions.md).\n\n"
          "positions: (F, J, 3), any unit of length, any up axis.\n"
          "names: J unique names, such as left_hip or LeftUpLeg; None: the joint order, such as "
          "that of SMPL, is recognised from the positions.\n"
          "fps: frames per second.\n"
          "name: name of the clip in messages.\n\n"
          "Findings and assumptions are reported as warnings. Raises UsageError: wrong shapes or "
          "numbers that are not finite; InputError: the joints do not form a human.")
      .def_static(
          "from_motion",
          [](const MotionHandle& motion) {
            return ClipHandle(without_gil(
                [&] { return clip_of_robot(*motion.clip, motion.robot.loaded, motion.name); }));
          },
          "motion"_a, nb::sig("def from_motion(motion: Motion) -> Clip"),
          "Converts a robot motion to a human clip with the same movement, for another robot "
          "(docs/robot_to_robot.md).\n\n"
          "Raises ConfigError: the robot has no retargeting configuration.")
      .def("__len__", [](const ClipHandle& clip) { return clip->frame_count(); })
      .def("__repr__", &shown_clip);
  module.def("clip_from_arrays", &from_arrays, "names"_a, "parents"_a, "positions"_a.none(),
             "rotations"_a.none(), "scalar_first"_a, "local"_a, "fps"_a, "name"_a);
  module.def("clip_from_positions", &from_positions, "positions"_a.none(), "names"_a, "fps"_a,
             "name"_a);
  module.def("load", &load_clip_file, "file"_a.none(), "options"_a, "skeleton_only"_a,
             "data_dir"_a.none());
  module.def("inspect", &inspect, "clip"_a, "options"_a, "data_dir"_a.none());
}

}  // namespace retarget::python
