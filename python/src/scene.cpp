// Binds retarget.Scene: the environment of a human or a robot, and the contacts of a motion with
// them.

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <map>
#include <memory>
#include <mutex>

#include "arrays.h"
#include "bindings.h"
#include "handles.h"
#include "raise.h"
#include "retarget/contact_table.h"
#include "retarget/scene.h"
#include "retarget/text.h"

namespace retarget::python {

using namespace nb::literals;

namespace {

// Implementation of retarget.Scene: a scene as in its file (one frame), or over a motion.
struct SceneHandle {
  SceneClip clip;
  bool is_motion = false;
  struct Fields {
    std::mutex mutex;
    std::map<std::size_t, DistanceField> by_body;
  };
  std::shared_ptr<Fields> fields = std::make_shared<Fields>();

  [[nodiscard]] std::size_t body_count() const { return clip.scene->bodies.size(); }
};

SceneHandle as_in_file(std::shared_ptr<const Scene> scene) {
  SceneHandle made;
  made.clip.frame_count = 1;
  for (const SceneBody& body : scene->bodies)
    made.clip.world_from_body.push_back(body.world_from_body);
  made.clip.scene = std::move(scene);
  return made;
}

SceneHandle load_scene_file(const nb::object& file) {
  const std::string path = bytes_of_path(file, "file");
  return as_in_file(std::make_shared<const Scene>(without_gil([&] { return load_scene(path); })));
}

const char* shape_type(SceneShape::Type type) {
  switch (type) {
    case SceneShape::Type::kPlane:
      return "plane";
    case SceneShape::Type::kBox:
      return "box";
    case SceneShape::Type::kSphere:
      return "sphere";
    case SceneShape::Type::kCapsule:
      return "capsule";
    case SceneShape::Type::kCylinder:
      return "cylinder";
    case SceneShape::Type::kMesh:
      break;
  }
  return "mesh";
}

nb::object vector_array(const Eigen::Vector3d& vector) {
  return array_of({vector.x(), vector.y(), vector.z()}, {3});
}

nb::object quaternion_array(const Eigen::Quaterniond& rotation) {
  return array_of({rotation.w(), rotation.x(), rotation.y(), rotation.z()}, {4});
}

nb::dict shape_members(const SceneShape& shape) {
  nb::dict all;
  all["type"] = shape_type(shape.type);
  all["position"] = vector_array(shape.body_from_shape.translation);
  all["rotation_wxyz"] = quaternion_array(shape.body_from_shape.rotation);
  all["half_size"] = vector_array(shape.half_size);
  all["radius"] = shape.radius;
  all["half_length"] = shape.half_length;
  std::vector<double> corners, triangles;
  if (shape.mesh) {
    for (const auto& corner : shape.mesh->vertices)
      corners.insert(corners.end(), corner.begin(), corner.end());
    for (const auto& each : shape.mesh->triangles)
      triangles.insert(triangles.end(), each.begin(), each.end());
  }
  const std::size_t vertices = corners.size() / 3, faces = triangles.size() / 3;
  all["vertices"] = array_of(std::move(corners), {vertices, 3});
  all["triangles"] = array_of(std::move(triangles), {faces, 3}).attr("astype")("int64");
  return all;
}

// A list of retarget.SceneBody.
nb::list bodies_of(const SceneHandle& scene) {
  const nb::object make = nb::module_::import_("retarget._scenes").attr("make_body");
  nb::list all;
  for (const SceneBody& body : scene.clip.scene->bodies) {
    nb::list shapes;
    for (const SceneShape& shape : body.shapes) shapes.append(shape_members(shape));
    all.append(make(name_of(body.name), body.moves, body.mass, shapes));
  }
  return all;
}

nb::list scene_body_names(const SceneHandle& scene) {
  nb::list names;
  for (const SceneBody& body : scene.clip.scene->bodies) names.append(name_of(body.name));
  return names;
}

nb::object scene_poses(const SceneHandle& scene, bool rotations) {
  std::vector<double> numbers;
  for (const auto& [rotation, position] : scene.clip.world_from_body) {
    if (rotations) {
      numbers.insert(numbers.end(), {rotation.w(), rotation.x(), rotation.y(), rotation.z()});
    } else {
      numbers.insert(numbers.end(), position.begin(), position.end());
    }
  }
  return array_of(std::move(numbers), {static_cast<std::size_t>(scene.clip.frame_count),
                                       scene.body_count(), rotations ? 4U : 3U});
}

std::size_t scene_body_index(const SceneHandle& scene, const nb::object& body) {
  const Scene& all = *scene.clip.scene;
  if (PyLong_Check(body.ptr())) {
    const auto index = PyLong_AsSsize_t(body.ptr());
    if (PyErr_Occurred() == nullptr && index >= 0 &&
        static_cast<std::size_t>(index) < all.bodies.size()) {
      return static_cast<std::size_t>(index);
    }
    PyErr_Clear();
    raise(usage_failure(fmt::format("body: expected 0 to {}", all.bodies.size() - 1)).value());
  }
  const std::string name = bytes_of_name(body, "body");
  const int found = all.find(name);
  if (found >= 0) return static_cast<std::size_t>(found);
  std::vector<std::string> names;
  for (const SceneBody& each : all.bodies) names.push_back(each.name);
  raise(
      usage_failure(fmt::format("the scene has no body \"{}\"{}", name, did_you_mean(name, names)))
          .value());
}

Result<DistanceField> distance_field(const SceneHandle& scene, std::size_t body) {
  const std::lock_guard lock(scene.fields->mutex);
  const auto found = scene.fields->by_body.find(body);
  if (found != scene.fields->by_body.end()) return found->second;
  auto made = make_distance_field(scene.clip.scene->bodies[body], distance_cache_folder());
  if (made) scene.fields->by_body.emplace(body, *made);
  return made;
}

// Distances and normals of points in the world.
nb::tuple surface_distances(const SceneHandle& scene, const nb::object& body,
                            const nb::object& points, int frame) {
  if (frame < 0 || frame >= scene.clip.frame_count) {
    raise(usage_failure(
              fmt::format("frame: expected 0 to {}, found {}", scene.clip.frame_count - 1, frame))
              .value());
  }
  const std::size_t index = scene_body_index(scene, body);
  const GivenArray given(points, "points", {-1, 3});
  const std::size_t count = given.size(0);
  std::vector<double> distances, normals;
  without_gil([&]() -> Result<void> {
    const auto field = distance_field(scene, index);
    if (!field) return failure(field.error());
    const Pose& world_from_body = scene.clip.pose(frame, index);
    const Pose body_from_world = world_from_body.inverse();
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3d point = Eigen::Map<const Eigen::Vector3d>(&given.numbers()[3 * i]);
      const SurfaceDistance found = field->at(body_from_world * point);
      const Eigen::Vector3d normal = world_from_body.rotation * found.normal;
      distances.push_back(found.distance);
      normals.insert(normals.end(), normal.begin(), normal.end());
    }
    return {};
  });
  return nb::make_tuple(array_of(std::move(distances), {count}),
                        array_of(std::move(normals), {count, 3}));
}

nb::object scene_of_motion(const MotionHandle& motion) {
  if (!motion.solved || !motion.solved->scene) return nb::none();
  SceneHandle scene;
  scene.clip = motion.solved->scene->clip;
  scene.is_motion = true;
  return nb::cast(std::move(scene));
}

nb::object scene_of_plan(const PlanHandle& plan) {
  if (!plan.plan->scene) return nb::none();
  return nb::cast(as_in_file(plan.plan->scene));
}

// The arguments of retarget.ContactLabels.
nb::object labels_of_motion(const MotionHandle& motion) {
  if (!motion.solved || !motion.solved->fit) return nb::none();
  const ContactLabels labels = contact_labels(*motion.solved);
  nb::list touches;
  for (const SurfaceTouch& touch : labels.touches) {
    touches.append(nb::make_tuple(name_of(touch.part), name_of(touch.link), name_of(touch.surface),
                                  touch.begin, touch.end, touch.slides));
  }
  const FrameRate& rate = motion.clip->rate();
  return nb::module_::import_("retarget._scenes")
      .attr("make_labels")(labels.frame_count, touches, text_of(contacts_text(labels, rate)),
                           text_of(contacts_json(labels, rate)));
}

}  // namespace

void bind_scene(nb::module_& module) {
  nb::class_<SceneHandle>(module, "Scene",
                          "The environment of a human or a robot: rigid bodies of solid shapes, "
                          "without the floor z = 0.\n\n"
                          "World frame, metres, Z up; F frames, B bodies. A scene from a file has "
                          "one frame, the scene of a motion has the frames of the motion.")
      .def_prop_ro(
          "name", [](const SceneHandle& scene) { return text_of(scene.clip.scene->name); },
          "File name.")
      .def_prop_ro(
          "frame_count", [](const SceneHandle& scene) { return scene.clip.frame_count; }, "F.")
      .def_prop_ro(
          "fps",
          [](const SceneHandle& scene) -> nb::object {
            if (!scene.is_motion) return nb::none();
            return nb::float_(scene.clip.rate.fps());
          },
          nb::sig("def fps(self) -> float | None"),
          "Frames per second; None: the scene comes from a file.")
      .def_prop_ro("body_names", &scene_body_names, nb::sig("def body_names(self) -> list[str]"),
                   "B names.")
      .def_prop_ro("bodies", &bodies_of,
                   nb::sig("def bodies(self) -> list[retarget._scenes.SceneBody]"),
                   "The bodies with their shapes.")
      .def_prop_ro(
          "positions", [](const SceneHandle& scene) { return scene_poses(scene, false); },
          nb::sig("def positions(self) -> numpy.ndarray"),
          "(F, B, 3) float64: origins of the bodies in the world, metres; a copy.")
      .def_prop_ro(
          "rotations_wxyz", [](const SceneHandle& scene) { return scene_poses(scene, true); },
          nb::sig("def rotations_wxyz(self) -> numpy.ndarray"),
          "(F, B, 4) float64: world_from_body, unit quaternions w x y z; a copy.")
      .def(
          "distance",
          [](const SceneHandle& scene, const nb::object& body, const nb::object& points,
             int frame) { return nb::object(surface_distances(scene, body, points, frame)[0]); },
          "body"_a.none(), "points"_a.none(), "frame"_a = 0,
          nb::sig(
              "def distance(self, body: str | int, points: numpy.typing.ArrayLike, frame: int = "
              "0) -> numpy.ndarray"),
          "(N,) float64: signed distances to the surface of a body, metres, negative inside.\n\n"
          "body: name or index.\npoints: (N, 3), in the world, metres.\nframe: 0 to F - 1.\n\n"
          "Raises UsageError: no such body or frame, another shape; InputError: a mesh that is too "
          "large.")
      .def("distance_and_normal", &surface_distances, "body"_a.none(), "points"_a.none(),
           "frame"_a = 0,
           nb::sig("def distance_and_normal(self, body: str | int, points: "
                   "numpy.typing.ArrayLike, frame: int = 0) -> tuple[numpy.ndarray, "
                   "numpy.ndarray]"),
           "distance(), and (N, 3) float64: the gradients of the distance, unit vectors in world "
           "axes.")
      .def("__len__", &SceneHandle::body_count)
      .def("__repr__", [](const SceneHandle& scene) {
        return fmt::format(
            "<retarget.Scene {}: {}, {}>",
            nb::cast<std::string>(nb::repr(text_of(scene.clip.scene->name))),
            scene.body_count() == 1 ? "1 body" : fmt::format("{} bodies", scene.body_count()),
            count_text(scene.clip.frame_count, "frame"));
      });
  nb::borrow<nb::class_<MotionHandle>>(module.attr("Motion"))
      .def_prop_ro("scene", &scene_of_motion, nb::sig("def scene(self) -> Scene | None"),
                   "The scene around the robot, at the robot's scale, in the frames of the motion; "
                   "None: only the floor, or the motion was not fitted.")
      .def_prop_ro("contact_labels", &labels_of_motion,
                   nb::sig("def contact_labels(self) -> retarget._scenes.ContactLabels | None"),
                   "Contacts of the robot's bodies with surfaces: the human's contacts, which the "
                   "fit enforces; None: the motion was not fitted.");
  nb::borrow<nb::class_<PlanHandle>>(module.attr("Plan"))
      .def_prop_ro("scene", &scene_of_plan, nb::sig("def scene(self) -> Scene | None"),
                   "The scene around the human, as in its file; None: only the floor.");
  module.def("load_scene", &load_scene_file, "file"_a.none());
}

}  // namespace retarget::python
