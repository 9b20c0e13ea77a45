// retarget.Robot: a robot given by its name, folder or model.

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <filesystem>

#include "arrays.h"
#include "bindings.h"
#include "handles.h"
#include "keywords.h"
#include "raise.h"
#include "retarget/file.h"
#include "retarget/option_table.h"
#include "retarget/robot.h"

namespace retarget::python {

using namespace nb::literals;

namespace {

RobotHandle load_named(const nb::object& name, const nb::dict& options,
                       const std::string& data_dir) {
  RobotChoice choice;
  apply_keywords(without(robot_table(choice), {"robot"}), options);
  if (!name.is_none()) {
    const std::string given = bytes_of_path(name, "robot");
    const std::filesystem::path ending = std::filesystem::path(given).extension();
    const bool is_model = (ending == ".xml" || ending == ".urdf") && is_file(given);
    if (is_model && choice.model.empty()) {
      choice.model = given;
    } else {
      choice.name = given;
    }
  }
  RobotHandle robot = without_gil([&]() -> Result<RobotHandle> {
    auto folder = data_folder_of(data_dir);
    if (!folder) return failure(folder.error());
    auto loaded = load_robot(choice, {*folder});
    if (!loaded) return failure(loaded.error());
    std::string hash = model_hash(*loaded);
    return RobotHandle{*std::move(loaded), std::move(hash)};
  });
  warn(robot.loaded.warnings, robot.loaded.model);
  return robot;
}

// Returns the values of the output joints, in output order.
std::vector<double> in_output_order(const Robot& robot, const std::vector<double>& by_joint) {
  std::vector<double> ordered;
  for (const int joint : robot.output_joints()) ordered.push_back(by_joint[joint]);
  return ordered;
}

nb::list joints_of_robot(const RobotHandle& robot) {
  nb::list names;
  for (const int joint : robot->output_joints()) {
    names.append(name_of(robot->joints()[joint].name));
  }
  return names;
}

nb::object joint_limits(const RobotHandle& robot, const nb::object& set) {
  const std::string name = set.is_none() ? robot->limits_for({}) : bytes_of_path(set, "limits");
  const LimitSet limits = without_gil([&] { return load_limits(*robot, name); });
  const std::vector<double> lower = in_output_order(*robot, limits.lower);
  const std::vector<double> upper = in_output_order(*robot, limits.upper);
  std::vector<double> both;
  for (std::size_t i = 0; i < lower.size(); ++i) both.insert(both.end(), {lower[i], upper[i]});
  return array_of(std::move(both), {lower.size(), 2});
}

nb::object speed_limits(const RobotHandle& robot) {
  std::vector<double> speeds;
  for (const int joint : robot->output_joints()) speeds.push_back(robot->speed_limit(joint));
  const std::size_t count = speeds.size();
  return array_of(std::move(speeds), {count});
}

nb::object zero_configuration(const RobotHandle& robot) {
  std::vector<double> qpos = robot->zero_configuration();
  const std::size_t size = qpos.size();
  return array_of(std::move(qpos), {size});
}

bool is_batch(const nb::object& qpos) {
  int axes = 0;
  return nb::try_cast(nb::module_::import_("numpy").attr("ndim")(qpos), axes) && axes == 2;
}

nb::tuple forward(const RobotHandle& robot, const nb::object& qpos) {
  const std::int64_t size = robot->configuration_size();
  // A ragged list raises in numpy.ndim; GivenArray explains it better.
  bool batch = false;
  try {
    batch = is_batch(qpos);
  } catch (nb::python_error& error) {
    if (!error.matches(PyExc_Exception)) throw;
  }
  const GivenArray given(qpos, "qpos",
                         batch ? std::vector<std::int64_t>{-1, size} : std::vector{size});
  const std::size_t frames = batch ? given.size(0) : 1;
  const auto width = static_cast<std::size_t>(size);
  for (std::size_t frame = 0; frame < frames; ++frame) {
    if (Eigen::Map<const Eigen::Vector4d>(&given.numbers()[width * frame + 3]).norm() >= 1e-9)
      continue;
    raise(usage_failure(fmt::format("qpos[{}3:7]: expected a quaternion, found zero",
                                    batch ? std::to_string(frame) + ", " : ""))
              .value());
  }
  const std::size_t bodies = robot->bodies().size();
  std::vector<double> positions, rotations;
  {
    const ReleasedGil released;
    positions.reserve(3 * bodies * frames);
    rotations.reserve(4 * bodies * frames);
    std::vector<Pose> world_from_body(bodies);
    for (std::size_t frame = 0; frame < frames; ++frame) {
      forward_kinematics(*robot, given.numbers().subspan(width * frame, width), world_from_body);
      for (const auto& [rotation, position] : world_from_body) {
        positions.insert(positions.end(), {position.x(), position.y(), position.z()});
        rotations.insert(rotations.end(), {rotation.w(), rotation.x(), rotation.y(), rotation.z()});
      }
    }
  }
  std::vector<std::size_t> shape = {bodies, 3};
  if (batch) shape.insert(shape.begin(), frames);
  nb::object places = array_of(std::move(positions), shape);
  shape.back() = 4;
  return nb::make_tuple(places, array_of(std::move(rotations), shape));
}

nb::list limit_sets(const RobotHandle& robot) {
  nb::list names;
  for (const LimitSet& set : robot->profile().limit_sets) names.append(name_of(set.name));
  names.append("model");
  return names;
}

nb::list qpos_names(const RobotHandle& robot) {
  nb::list names;
  for (const RobotJoint& joint : robot->joints()) names.append(name_of(joint.name));
  return names;
}

nb::list qpos_bodies(const RobotHandle& robot) {
  nb::list bodies;
  for (const RobotJoint& joint : robot->joints()) bodies.append(joint.body);
  return bodies;
}

nb::list body_parents(const RobotHandle& robot) {
  nb::list parents;
  for (std::size_t body = 0; body < robot->bodies().size(); ++body) {
    parents.append(body == 0 ? -1 : robot->bodies()[body].parent);
  }
  return parents;
}

nb::list variants(const RobotHandle& robot) {
  nb::list names;
  for (const RobotVariant& variant : robot->profile().variants) names.append(name_of(variant.name));
  return names;
}

}  // namespace

void bind_robot(nb::module_& module) {
  nb::class_<RobotHandle>(
      module, "Robot",
      "A robot: its model, output joints and limits; shared by all threads.\n\n"
      "N joints in the order of joint_names, which is the order of the output columns.")
      .def(
          "__init__",
          [](RobotHandle* self, const nb::object& name, const nb::object& data_dir,
             const nb::kwargs& options) {
            new (self) RobotHandle(load_named(name, options, bytes_of_folder(data_dir)));
          },
          "name"_a = nb::none(), nb::kw_only(), "data_dir"_a = nb::none(), "options"_a,
          nb::sig(
              "def __init__(self, name: str | os.PathLike[str] | None = None, *, data_dir: str | "
              "os.PathLike[str] | None = None, **options: "
              "typing_extensions.Unpack[retarget._options.RobotOptions]) -> None"),
          "name: `unitree_g1`, `g1`, a robot folder, or a model file (.xml, .urdf).\n"
          "data_dir: folder with robots/ and configs/; None: $RETARGET_DATA_DIR, otherwise the "
          "package's own.\n\n"
          "Raises ConfigError: unknown robot or errors in its files.")
      .def_prop_ro(
          "name", [](const RobotHandle& robot) { return name_of(robot.loaded.name); },
          "Full name; empty for a model file.")
      .def_prop_ro(
          "model", [](const RobotHandle& robot) { return path_of(robot.loaded.model); },
          "MJCF or URDF file of the robot.")
      .def_prop_ro(
          "variant", [](const RobotHandle& robot) { return name_of(robot->variant().name); },
          "Variant of the robot, whose other joints are locked; empty: the whole robot.")
      .def_prop_ro("variants", &variants, nb::sig("def variants(self) -> list[str]"),
                   "Valid values of `dof`.")
      .def_prop_ro("limit_sets", &limit_sets, nb::sig("def limit_sets(self) -> list[str]"),
                   "Valid values of `limits`, in addition to a file.")
      .def_prop_ro("joint_names", &joints_of_robot, nb::sig("def joint_names(self) -> list[str]"),
                   "N names, in the order of the output columns.")
      .def_prop_ro(
          "body_names", [](const RobotHandle& robot) { return names_of(robot->body_names()); },
          nb::sig("def body_names(self) -> list[str]"),
          "Names of all bodies, the world first, in the order of forward_kinematics.")
      .def_prop_ro("body_parents", &body_parents, nb::sig("def body_parents(self) -> list[int]"),
                   "Index of each body's parent; -1: the world itself.")
      .def_prop_ro("qpos_names", &qpos_names, nb::sig("def qpos_names(self) -> list[str]"),
                   "Names of all n joints of the model, in the order of columns 7 to 7 + n of "
                   "Motion.qpos; joint_names may omit some of them and may have another order.")
      .def_prop_ro("qpos_bodies", &qpos_bodies, nb::sig("def qpos_bodies(self) -> list[int]"),
                   "Index of the body that each joint of qpos_names moves.")
      .def("joint_limits", &joint_limits, "limits"_a = nb::none(),
           nb::sig("def joint_limits(self, limits: str | os.PathLike[str] | None = None) -> "
                   "numpy.ndarray"),
           "(N, 2) float64, lower and upper limits, rad or m, from a set, a file, or the default.")
      .def_prop_ro("speed_limits", &speed_limits,
                   nb::sig("def speed_limits(self) -> numpy.ndarray"),
                   "(N,) float64, rad/s or m/s.")
      .def_prop_ro("zero_configuration", &zero_configuration,
                   nb::sig("def zero_configuration(self) -> numpy.ndarray"),
                   "The model's qpos0: root x y z (metres), root quaternion w x y z, joints.")
      .def("forward_kinematics", &forward, "qpos"_a.none(),
           nb::sig("def forward_kinematics(self, qpos: numpy.typing.ArrayLike) -> "
                   "tuple[numpy.ndarray, numpy.ndarray]"),
           "World positions (B, 3), metres, and rotations (B, 4), wxyz, of all bodies.\n\n"
           "qpos: (7 + n,), a configuration like a row of Motion.qpos; or (F, 7 + n), and the "
           "results are (F, B, 3) and (F, B, 4).\n\n"
           "Raises UsageError: another shape, numbers that are not finite, a zero quaternion.")
      .def("__repr__", [](const RobotHandle& robot) {
        const std::string& name = robot.loaded.name;
        return fmt::format(
            "<retarget.Robot {}: {} joints>",
            nb::cast<std::string>(nb::repr(text_of(name.empty() ? robot.loaded.model : name))),
            robot->output_joints().size());
      });
  // The name in the manifest of a batch.
  module.def(
      "recorded_name",
      [](const RobotHandle& robot) {
        return name_of(std::filesystem::path(robot->name()).filename().generic_string());
      },
      "robot"_a);
}

}  // namespace retarget::python
