// FrameRetargeter: frame-by-frame engine of retarget.gmr.

#include "retarget/frame_retargeter.h"

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>
#include <type_traits>

#include "arrays.h"
#include "bindings.h"
#include "handles.h"
#include "raise.h"
#include "retarget/try.h"

namespace retarget::python {

using namespace nb::literals;

namespace {

// Copies numbers directly from an array, without numpy; returns false if they are not finite.
template <std::size_t kSize, typename Number>
bool copy_numbers(const nb::ndarray<nb::ro, nb::device::cpu>& array, double* out) {
  const auto* const data = static_cast<const Number*>(array.data());
  for (std::size_t i = 0; i < kSize; ++i) {
    out[i] = static_cast<double>(data[static_cast<std::int64_t>(i) * array.stride(0)]);
    if (!std::isfinite(out[i])) return false;
  }
  return true;
}

template <std::size_t kSize>
bool read_array(nb::handle object, double* out) {
  nb::ndarray<nb::ro, nb::device::cpu> array;
  if (!nb::try_cast(object, array, false)) return false;
  if (array.ndim() != 1 || array.shape(0) != kSize) return false;
  if (array.dtype() == nb::dtype<double>()) return copy_numbers<kSize, double>(array, out);
  if (array.dtype() == nb::dtype<float>()) return copy_numbers<kSize, float>(array, out);
  return false;
}

// Reads kSize numbers from anything that numpy converts to an array.
template <std::size_t kSize>
void read_numbers(nb::handle object, const std::string& body, const char* part, double* out) {
  if (read_array<kSize>(object, out)) return;
  const std::string what = fmt::format("{} of \"{}\"", part, body);
  const GivenArray given(object, what.c_str(), {static_cast<std::int64_t>(kSize)});
  std::copy(given.numbers().begin(), given.numbers().end(), out);
}

// Reads a pair (position, quaternion) of a body.
Pose read_pose(nb::handle value, const std::string& body) {
  nb::object position, rotation;
  if (!PyUnicode_Check(value.ptr()) && PySequence_Check(value.ptr()) != 0 &&
      PySequence_Size(value.ptr()) == 2) {
    position = nb::steal(PySequence_GetItem(value.ptr(), 0));
    rotation = nb::steal(PySequence_GetItem(value.ptr(), 1));
  }
  forget_exception();
  if (!position.is_valid() || !rotation.is_valid()) {
    raise(usage_failure(
              fmt::format("\"{}\": expected a position (3,) and a quaternion (4,), w x y z", body))
              .value());
  }
  std::array<double, 3> xyz{};
  std::array<double, 4> wxyz{};
  read_numbers<3>(position, body, "the position", xyz.data());
  read_numbers<4>(rotation, body, "the rotation", wxyz.data());
  return {Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]),
          Eigen::Vector3d(xyz[0], xyz[1], xyz[2])};
}

struct Loaded {
  LoadedRobot robot;
  HumanConfig config;
  LimitSet limits;
};

Result<Loaded> load(const RobotChoice& choice, const std::string& config,
                    const std::string& config_file) {
  RETARGET_TRY_ASSIGN(const std::string folder, data_folder_of({}));
  RETARGET_TRY_ASSIGN(LoadedRobot robot, load_robot(choice, {folder}, Soles::kAsTheyAre));
  RETARGET_TRY_ASSIGN(const RetargetingConfig tables,
                      parse_retargeting_config(config, config_file));
  RETARGET_TRY_ASSIGN(HumanConfig human, resolve_human_config(tables, *robot.robot));
  RETARGET_TRY_ASSIGN(LimitSet limits, load_limits(*robot.robot, robot.robot->limits_for("gmr")));
  return Loaded{std::move(robot), std::move(human), std::move(limits)};
}

// A retargeter that several Python threads may share.
class SharedRetargeter {
 public:
  SharedRetargeter(Loaded loaded, FrameRetargeter retargeter)
      : loaded_(std::move(loaded)), retargeter_(std::move(retargeter)) {
    for (const std::string& body : retargeter_.human_bodies()) names_.push_back(name_of(body));
  }

  // Format: {body: (position, quaternion)}.
  void update_targets(const nb::object& human_data, double down, bool to_ground) {
    if (PyDict_Check(human_data.ptr()) == 0 && !nb::hasattr(human_data, "keys")) {
      raise(usage_failure("human_data: expected {body: (position, quaternion)}").value());
    }
    HumanPose human;
    std::vector<std::string> missing;
    for (const int body : retargeter_.target_bodies()) {
      const auto value = find(human_data, names_[body]);
      const std::string& name = retargeter_.human_bodies()[body];
      if (value.is_valid()) {
        human[static_cast<Bone>(body)] = read_pose(value, name);
      } else {
        missing.push_back(name);
      }
    }
    if (!missing.empty()) {
      const nb::object make = nb::module_::import_("retarget.gmr._errors").attr("missing_bodies");
      const nb::object exception =
          make(texts_of(missing), text_of(loaded_.config.tables.file), human_data);
      PyErr_SetObject(exception.type().ptr(), exception.ptr());
      throw nb::python_error();
    }
    without_gil([&] { return locked([&] { return take({human, {down, to_ground}}); }); });
  }

  // Takes over the configuration and the last frame of a retargeter with other options.
  void go_on_from(SharedRetargeter& before) {
    std::vector<double> qpos;
    std::optional<Frame> frame;
    without_gil([&]() -> Result<void> {
      before.locked([&] {
        qpos.assign(before.retargeter_.qpos().begin(), before.retargeter_.qpos().end());
        frame = before.frame_;
      });
      return locked([&]() -> Result<void> {
        RETARGET_TRY(retargeter_.set_qpos(qpos));
        return frame ? take(*frame) : Result<void>();
      });
    });
  }

  nb::object solve() {
    std::vector<double> qpos;
    without_gil([&] {
      return locked([&] {
        auto solved = retargeter_.solve();
        qpos.assign(retargeter_.qpos().begin(), retargeter_.qpos().end());
        return solved;
      });
    });
    return writable(std::move(qpos));
  }

  [[nodiscard]] nb::object qpos() {
    return writable(locked(
        [&] { return std::vector<double>(retargeter_.qpos().begin(), retargeter_.qpos().end()); }));
  }
  void set_qpos(const nb::object& qpos) {
    const GivenArray given(qpos, "qpos", {static_cast<std::int64_t>(retargeter_.qpos().size())});
    value_of(locked([&] { return retargeter_.set_qpos(given.numbers()); }));
  }
  [[nodiscard]] double error(int table) {
    return value_of(locked([&] { return retargeter_.error(table); }));
  }

  // Returns names, positions (N, 3) and rotations (N, 4) in wxyz order.
  [[nodiscard]] nb::tuple targets() {
    const std::vector<Pose> world_from_target = locked([&] {
      const auto poses = retargeter_.world_from_target();
      return std::vector<Pose>(poses.begin(), poses.end());
    });
    nb::list names;
    std::vector<double> positions, rotations;
    for (std::size_t i = 0; i < world_from_target.size(); ++i) {
      const auto& [rotation, position] = world_from_target[i];
      names.append(names_[retargeter_.target_bodies()[i]]);
      positions.insert(positions.end(), {position.x(), position.y(), position.z()});
      rotations.insert(rotations.end(), {rotation.w(), rotation.x(), rotation.y(), rotation.z()});
    }
    const std::size_t count = world_from_target.size();
    return nb::make_tuple(names, array_of(std::move(positions), {count, 3}),
                          array_of(std::move(rotations), {count, 4}));
  }

  [[nodiscard]] nb::list target_bodies() const {
    nb::list names;
    for (const int body : retargeter_.target_bodies()) names.append(names_[body]);
    return names;
  }
  [[nodiscard]] nb::list joint_names() const { return names_of(robot().joint_names()); }
  [[nodiscard]] nb::list body_names() const { return names_of(robot().body_names()); }

 private:
  [[nodiscard]] const Robot& robot() const { return *loaded_.robot.robot; }

  // Human pose as given by the caller.
  struct Frame {
    HumanPose human;
    TargetShift shift;
  };

  Result<void> take(const Frame& frame) {
    const std::span all(frame.human.begin(), frame.human.end());
    RETARGET_TRY(retargeter_.update_targets(all.first(names_.size()), frame.shift));
    frame_ = frame;
    return {};
  }

  // `function` must not create or use Python objects: that may switch to another thread, which may
  // hold the GIL while it waits for this lock.
  template <typename Function>
  std::invoke_result_t<const Function&> locked(const Function& function) {
    const std::lock_guard lock(mutex_);
    return function();
  }

  static nb::object find(const nb::object& human_data, const nb::object& name) {
    if (PyDict_Check(human_data.ptr())) {
      PyObject* const found = PyDict_GetItemWithError(human_data.ptr(), name.ptr());
      if (found == nullptr && PyErr_Occurred() != nullptr) throw nb::python_error();
      return nb::borrow(found);
    }
    PyObject* const found = PyObject_GetItem(human_data.ptr(), name.ptr());
    if (found == nullptr) {
      if (PyErr_ExceptionMatches(PyExc_KeyError) == 0) throw nb::python_error();
      PyErr_Clear();
    }
    return nb::steal(found);
  }

  // Makes an array that the caller owns and may modify.
  static nb::object writable(std::vector<double> numbers) {
    auto kept = std::make_unique<std::vector<double>>(std::move(numbers));
    double* const data = kept->data();
    const std::size_t size = kept->size();
    const nb::capsule owner(
        kept.get(), [](void* it) noexcept { delete static_cast<std::vector<double>*>(it); });
    static_cast<void>(kept.release());
    return nb::cast(nb::ndarray<nb::numpy, double, nb::ndim<1>>(data, {size}, owner));
  }

  Loaded loaded_;
  FrameRetargeter retargeter_;
  std::optional<Frame> frame_;     // Source of the targets.
  std::vector<nb::object> names_;  // Names of the human's bodies.
  std::mutex mutex_;
};

void construct(SharedRetargeter* self, const nb::object& model, const nb::object& profile,
               const std::string& config, const nb::object& config_file, double damping,
               int max_extra_steps, const std::string& engine) {
  RobotChoice choice;
  choice.model = bytes_of_path(model, "the robot's model");
  choice.profile = bytes_of_path(profile, "the robot's profile");
  const std::string file = bytes_of_path(config_file, "the retargeting configuration");
  FrameRetargeterOptions options;
  options.damping = damping;
  options.max_extra_steps = max_extra_steps;
  if (engine != "fast" && engine != "reference") {
    raise(usage_failure("engine: expected \"fast\" or \"reference\", found \"" + engine + "\"")
              .value());
  }
  options.engine = engine == "reference" ? IkEngine::kReference : IkEngine::kFast;
  Loaded loaded = without_gil([&] { return load(choice, config, file); });
  auto made = FrameRetargeter::make(loaded.robot.robot, loaded.config, loaded.limits, options);
  new (self) SharedRetargeter(std::move(loaded), value_of(std::move(made)));
}

// Scales N positions about the root's position.
nb::object scale_about(const nb::object& positions, const nb::object& scales, std::size_t root) {
  const GivenArray given(positions, "positions", {-1, 3});
  const auto count = given.size(0);
  const GivenArray factors(scales, "scales", {static_cast<std::int64_t>(count)});
  const auto place = [&](std::size_t i) {
    return Eigen::Map<const Eigen::Vector3d>(&given.numbers()[3 * i]);
  };
  if (root >= count) raise(usage_failure("the root is not among the bodies").value());
  const Eigen::Vector3d before = place(root);
  const Eigen::Vector3d after = factors.numbers()[root] * before;
  std::vector<double> scaled;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d there =
        i == root ? after : scaled_about_root(place(i), factors.numbers()[i], before, after);
    scaled.insert(scaled.end(), there.begin(), there.end());
  }
  return array_of(std::move(scaled), {count, 3});
}

// Applies an offset in the pose's own axes; returns position and quaternion.
nb::tuple offset_pose(const nb::object& position, const nb::object& rotation,
                      const nb::object& position_offset, const nb::object& rotation_offset) {
  const auto vector = [](const GivenArray& given) {
    return Eigen::Vector3d(given.numbers()[0], given.numbers()[1], given.numbers()[2]);
  };
  const auto quaternion = [](const GivenArray& given) {
    const auto& wxyz = given.numbers();
    return Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  };
  const Eigen::Quaterniond turned =
      offset_rotation(quaternion(GivenArray(rotation, "rotation", {4})),
                      quaternion(GivenArray(rotation_offset, "rotation offset", {4})));
  const Pose pose = offset_target(turned, vector(GivenArray(position, "position", {3})),
                                  vector(GivenArray(position_offset, "position offset", {3})));
  return nb::make_tuple(array_of({pose.translation.begin(), pose.translation.end()}, {3}),
                        array_of({turned.w(), turned.x(), turned.y(), turned.z()}, {4}));
}

}  // namespace

void bind_frame_retargeter(nb::module_& module) {
  nb::class_<SharedRetargeter>(module, "FrameRetargeter",
                               "The published method, frame by frame; use it through retarget.gmr.")
      .def("__init__", &construct, "model"_a, "profile"_a, "config"_a, "config_file"_a, "damping"_a,
           "max_extra_steps"_a, "engine"_a,
           nb::sig("def __init__(self, model: str | os.PathLike[str], profile: str | "
                   "os.PathLike[str], config: str, config_file: str | os.PathLike[str], damping: "
                   "float, max_extra_steps: int, engine: str) -> None"))
      .def("update_targets", &SharedRetargeter::update_targets, "human_data"_a.none(), "down"_a,
           "to_ground"_a,
           nb::sig("def update_targets(self, human_data: collections.abc.Mapping[str, "
                   "typing.Any], down: float, to_ground: bool) -> None"),
           "Sets the targets from {body: (position, quaternion w x y z)}, metres, Z up.")
      .def("solve", &SharedRetargeter::solve, nb::sig("def solve(self) -> numpy.ndarray"),
           "Solves for the targets and returns a copy of the new configuration.")
      .def("go_on_from", &SharedRetargeter::go_on_from, "before"_a,
           nb::sig("def go_on_from(self, before: FrameRetargeter) -> None"),
           "Copies the configuration and the last frame of another retargeter of the same robot.")
      .def("set_qpos", &SharedRetargeter::set_qpos, "qpos"_a.none(),
           nb::sig("def set_qpos(self, qpos: numpy.typing.ArrayLike) -> None"),
           "Sets the start configuration of the next frame.")
      .def("error", &SharedRetargeter::error, "table"_a,
           "Norm of the errors of a table's tasks (1 or 2), without weights.")
      .def("targets", &SharedRetargeter::targets,
           nb::sig("def targets(self) -> tuple[list[str], numpy.ndarray, numpy.ndarray]"),
           "Bodies, positions (N, 3), rotations (N, 4) w x y z.")
      .def_prop_ro("qpos", &SharedRetargeter::qpos, nb::sig("def qpos(self) -> numpy.ndarray"),
                   "The configuration, a copy.")
      .def_prop_ro("target_bodies", &SharedRetargeter::target_bodies,
                   nb::sig("def target_bodies(self) -> list[str]"),
                   "Human bodies from which the targets are computed, the root first.")
      .def_prop_ro("joint_names", &SharedRetargeter::joint_names,
                   nb::sig("def joint_names(self) -> list[str]"), "In the order of qpos.")
      .def_prop_ro("body_names", &SharedRetargeter::body_names,
                   nb::sig("def body_names(self) -> list[str]"), "By index, the world first.");
  module.def(
      "data_folder",
      [](const std::string& chosen) { return path_of(value_of(data_folder_of(chosen))); },
      "chosen"_a, "Folder with robots/ and configs/.");
  module.def("scale_about", &scale_about, "positions"_a.none(), "scales"_a.none(), "root"_a,
             nb::sig("def scale_about(positions: numpy.typing.ArrayLike, scales: "
                     "numpy.typing.ArrayLike, root: int) -> numpy.ndarray"),
             "Scales bodies (N, 3) about the root, and the root about the origin.");
  module.def("offset_pose", &offset_pose, "position"_a.none(), "rotation"_a.none(),
             "position_offset"_a.none(), "rotation_offset"_a.none(),
             nb::sig("def offset_pose(position: numpy.typing.ArrayLike, rotation: "
                     "numpy.typing.ArrayLike, position_offset: numpy.typing.ArrayLike, "
                     "rotation_offset: numpy.typing.ArrayLike) -> tuple[numpy.ndarray, "
                     "numpy.ndarray]"),
             "Applies an offset to a pose, in the pose's own axes; rotations w x y z.");
}

}  // namespace retarget::python
