// Scenes as MJCF and URDF. Every body with geoms that take part in contacts, or every link with a
// collision, becomes a body.

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <tinyxml2.h>
#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "base/parse_xml.h"
#include "base/try.h"
#include "retarget/file.h"
#include "retarget/so3.h"
#include "retarget/text.h"
#include "robot/model/check_model.h"
#include "robot/model/load_model.h"
#include "robot/model/model_values.h"
#include "scene/read_scene.h"
#include "scene/scene_shapes.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Type = SceneShape::Type;

class MjcfSceneReader {
 public:
  MjcfSceneReader(const std::string& file, const LoadedModel& loaded, double reach)
      : file_(file), model_(*loaded.model), meshes_(loaded.meshes), reach_(reach) {
    for (int geom = 0; geom < model_.ngeom; ++geom) has_contacts_ |= collides(geom);
  }

  Result<std::vector<SceneBody>> read() {
    std::vector<SceneLink> links(static_cast<std::size_t>(model_.nbody));
    for (int body = 0; body < model_.nbody; ++body) {
      SceneLink& link = links[static_cast<std::size_t>(body)];
      link.body.name = name_in_model(model_, mjOBJ_BODY, body);
      if (body == 0) continue;
      // The world's own pose is the identity, so it needs no link.
      link.parent = model_.body_parentid[body];
      link.parent_from_link = pose_at(model_.body_pos, model_.body_quat, body);
      link.body.moves =
          model_.body_jntnum[body] > 0 && model_.jnt_type[model_.body_jntadr[body]] == mjJNT_FREE;
    }
    for (int geom = 0; geom < model_.ngeom; ++geom) {
      if (has_contacts_ && !collides(geom)) continue;
      SceneBody& body = links[static_cast<std::size_t>(model_.geom_bodyid[geom])].body;
      TRY(add_shapes(geom, body.shapes));
    }
    return bodies_of_links(links);
  }

 private:
  [[nodiscard]] bool collides(int geom) const {
    return model_.geom_contype[geom] != 0 || model_.geom_conaffinity[geom] != 0;
  }

  Result<void> add_shapes(int geom, std::vector<SceneShape>& shapes) {
    const Pose pose = pose_at(model_.geom_pos, model_.geom_quat, geom);
    const auto mesh = std::ranges::find(meshes_, geom, &ModelMesh::geom);
    if (mesh != meshes_.end()) {
      TRY_ASSIGN(const TriangleMesh triangles,
                 find_scene_mesh(mesh->file, file_, ColladaAxes::kOfFile, reach_, mesh->scale,
                                 mesh->file_from_mesh));
      for (SceneShape& shape : shapes_of_mesh(triangles, pose)) shapes.push_back(std::move(shape));
      return {};
    }
    const Vector3d size = vector_at(model_.geom_size, geom);
    SceneShape shape;
    shape.body_from_shape = pose;
    switch (model_.geom_type[geom]) {
      case mjGEOM_PLANE:
        shape.type = Type::kPlane;
        break;
      case mjGEOM_BOX:
        shape.type = Type::kBox;
        shape.half_size = size;
        break;
      case mjGEOM_SPHERE:
        shape.type = Type::kSphere;
        shape.radius = size.x();
        break;
      case mjGEOM_CAPSULE:
      case mjGEOM_CYLINDER:
        shape.type = model_.geom_type[geom] == mjGEOM_CAPSULE ? Type::kCapsule : Type::kCylinder;
        shape.radius = size.x();
        shape.half_length = size.y();
        break;
      case mjGEOM_ELLIPSOID:
        shape.type = Type::kMesh;
        shape.mesh = std::make_shared<TriangleMesh>(ellipsoid_mesh(size));
        break;
      case mjGEOM_HFIELD:
        shape.type = Type::kMesh;
        shape.mesh = std::make_shared<TriangleMesh>(heights_of(model_.geom_dataid[geom]));
        break;
      default:
        return input_failure(file_, fmt::format("the body {} has a geom of an unsupported type",
                                                model_.geom_bodyid[geom]));
    }
    shapes.push_back(std::move(shape));
    return {};
  }

  // A height field is centred about its geom.
  [[nodiscard]] TriangleMesh heights_of(int field) const {
    const double* size = model_.hfield_size + 4 * static_cast<std::ptrdiff_t>(field);
    const auto rows = static_cast<std::size_t>(model_.hfield_nrow[field]);
    const auto columns = static_cast<std::size_t>(model_.hfield_ncol[field]);
    const float* data = model_.hfield_data + model_.hfield_adr[field];
    std::vector<double> heights(data, data + rows * columns);
    for (double& height : heights) height *= size[2];
    const Eigen::Vector2d spacing(2.0 * size[0] / static_cast<double>(columns - 1),
                                  2.0 * size[1] / static_cast<double>(rows - 1));
    TriangleMesh mesh = height_mesh(heights, columns, spacing, -std::max(size[3], kHeightDepth));
    for (Vector3d& vertex : mesh.vertices) vertex -= Vector3d(size[0], size[1], 0.0);
    return mesh;
  }

  const std::string& file_;
  const mjModel& model_;
  const std::vector<ModelMesh>& meshes_;
  double reach_;
  bool has_contacts_ = false;
};

}  // namespace

Result<std::vector<SceneBody>> read_mjcf_scene(const std::string& file, double reach) {
  ModelChanges changes;
  changes.name_all = true;
  changes.find_meshes = true;
  changes.keep_heights = true;
  TRY_ASSIGN(const LoadedModel loaded, load_model(file, changes));
  if (!loaded.dropped.empty()) {
    return input_failure(
        file,
        "the body \"" + loaded.dropped.front() +
            "\" has a geom whose shape is not in a mesh file or in the model itself",
        "supported are primitives, meshes from STL, OBJ or COLLADA files, and "
        "height fields with an elevation");
  }
  return MjcfSceneReader(file, loaded, reach).read();
}

namespace {

using tinyxml2::XMLElement;

class UrdfSceneReader {
 public:
  UrdfSceneReader(const std::string& file, double reach) : file_(file), reach_(reach) {}

  Result<std::vector<SceneBody>> read() {
    TRY(check_model(file_, true));
    TRY_ASSIGN(const auto text, read_file(file_, ErrorKind::kInput, kMaxTextBytes));
    tinyxml2::XMLDocument document;
    TRY(parse_xml(text.view(), document));
    const XMLElement& robot = *document.RootElement();
    TRY(read_joints(robot));
    // Without collisions, visuals describe the bodies.
    kind_ = has_collisions(robot) ? "collision" : "visual";
    for (const XMLElement* link : children_of(robot, "link")) {
      const std::string name = attribute_of(link, "name");
      if (!elements_.emplace(name, link).second) {
        return fault(*link, "two links have the name \"" + name + "\"");
      }
      order_.push_back(name);
    }
    for (const std::string& name : order_) TRY(add_link(name));
    return bodies_of_links(links_);
  }

 private:
  struct Joint {
    std::string parent;
    Pose parent_from_child;
    bool floats = false;
  };

  [[nodiscard]] Failure fault(const XMLElement& element, const std::string& message) const {
    const auto line = static_cast<std::size_t>(std::max(0, element.GetLineNum()));
    return failure({ErrorKind::kInput,
                    {file_, line, 0},
                    fmt::format("<{}> {}", element.Name(), message),
                    {},
                    {}});
  }

  static bool has_collisions(const XMLElement& robot) {
    for (const XMLElement* link : children_of(robot, "link")) {
      if (link->FirstChildElement("collision") != nullptr) return true;
    }
    return false;
  }

  Result<void> read_joints(const XMLElement& robot) {
    for (const XMLElement* joint : children_of(robot, "joint")) {
      TRY_ASSIGN(const Pose pose, origin_of(*joint));
      const std::string child = attribute_of(joint->FirstChildElement("child"), "link");
      const std::string parent = attribute_of(joint->FirstChildElement("parent"), "link");
      const bool floats = attribute_of(joint, "type") == "floating";
      if (!joints_.emplace(child, Joint{parent, pose, floats}).second) {
        return fault(*joint, "gives the link \"" + child + "\" a second parent");
      }
    }
    return {};
  }

  // Adds a link after its parents.
  Result<void> add_link(const std::string& name) {
    std::vector<std::string> chain;
    std::set<std::string> seen;
    for (std::string at = name; !at.empty() && !index_of_.contains(at);) {
      const auto element = elements_.find(at);
      if (element == elements_.end()) {
        return input_failure(file_, "a joint names the link \"" + at + "\", which does not exist");
      }
      if (!seen.insert(at).second) {
        return input_failure(file_, "the joints of the link \"" + at + "\" form a cycle");
      }
      chain.push_back(at);
      const auto joint = joints_.find(at);
      at = joint == joints_.end() ? std::string() : joint->second.parent;
    }
    for (auto at = chain.rbegin(); at != chain.rend(); ++at) {
      TRY_ASSIGN(SceneLink link, link_of(*elements_.at(*at)));
      if (const auto joint = joints_.find(*at); joint != joints_.end()) {
        link.parent = index_of_.at(joint->second.parent);
        link.parent_from_link = joint->second.parent_from_child;
        link.body.moves = joint->second.floats;
      }
      index_of_[*at] = static_cast<int>(links_.size());
      links_.push_back(std::move(link));
    }
    return {};
  }

  Result<SceneLink> link_of(const XMLElement& element) {
    SceneLink link;
    link.body.name = attribute_of(&element, "name");
    if (const XMLElement* inertial = element.FirstChildElement("inertial")) {
      const auto mass =
          number_from_text(attribute_of(inertial->FirstChildElement("mass"), "value"));
      link.body.mass = mass ? std::max(*mass, 0.0) : 0.0;
    }
    for (const XMLElement* shape : children_of(element, kind_)) {
      TRY_ASSIGN(const Pose pose, origin_of(*shape));
      const XMLElement* geometry = shape->FirstChildElement("geometry");
      const XMLElement* form = geometry == nullptr ? nullptr : geometry->FirstChildElement();
      if (form == nullptr) return fault(*shape, "has no geometry");
      TRY(add_shape(*form, pose, link.body.shapes));
    }
    return link;
  }

  Result<void> add_shape(const XMLElement& form, const Pose& pose,
                         std::vector<SceneShape>& shapes) {
    const std::string kind = form.Name();
    if (kind == "mesh") {
      TRY_ASSIGN(const auto scale, numbers(form, "scale", {1.0, 1.0, 1.0}));
      TRY_ASSIGN(const TriangleMesh mesh,
                 find_scene_mesh(attribute_of(&form, "filename"), file_, ColladaAxes::kOfFile,
                                 reach_, Vector3d(scale.data())));
      for (SceneShape& shape : shapes_of_mesh(mesh, pose)) shapes.push_back(std::move(shape));
      return {};
    }
    SceneShape shape;
    shape.body_from_shape = pose;
    if (kind == "box") {
      TRY_ASSIGN(const auto size, numbers(form, "size", {0.0, 0.0, 0.0}));
      shape.type = Type::kBox;
      shape.half_size = 0.5 * Vector3d(size.data());
    } else if (kind == "sphere" || kind == "cylinder" || kind == "capsule") {
      TRY_ASSIGN(const auto radius, numbers(form, "radius", {0.0}));
      TRY_ASSIGN(const auto length, numbers(form, "length", {0.0}));
      shape.type = kind == "sphere"     ? Type::kSphere
                   : kind == "cylinder" ? Type::kCylinder
                                        : Type::kCapsule;
      shape.radius = radius[0];
      shape.half_length = 0.5 * length[0];
    } else {
      return fault(form,
                   "is not a supported shape: expected box, sphere, cylinder, capsule or mesh");
    }
    shapes.push_back(std::move(shape));
    return {};
  }

  // Parses as many numbers as `otherwise` has, which stands for a missing attribute.
  Result<std::vector<double>> numbers(const XMLElement& element, const char* name,
                                      std::vector<double> otherwise) const {
    if (element.Attribute(name) == nullptr) return otherwise;
    const std::string text = attribute_of(&element, name);
    std::string_view rest = text;
    std::vector<double> found;
    for (auto word = take_word(rest); !word.empty(); word = take_word(rest)) {
      const auto number = number_from_text(word);
      if (!number || found.size() == otherwise.size()) {
        found.clear();
        break;
      }
      found.push_back(*number);
    }
    if (found.size() == otherwise.size()) return found;
    return fault(element, fmt::format("{} is \"{}\": expected {}", name, text.substr(0, 60),
                                      count_text(otherwise.size(), "number")));
  }

  // Roll, pitch and yaw are about fixed axes.
  Result<Pose> origin_of(const XMLElement& element) const {
    const XMLElement* origin = element.FirstChildElement("origin");
    if (origin == nullptr) return Pose{};
    TRY_ASSIGN(const auto at, numbers(*origin, "xyz", {0.0, 0.0, 0.0}));
    TRY_ASSIGN(const auto turn, numbers(*origin, "rpy", {0.0, 0.0, 0.0}));
    return Pose{exp_so3(turn[2] * Vector3d::UnitZ()) * exp_so3(turn[1] * Vector3d::UnitY()) *
                    exp_so3(turn[0] * Vector3d::UnitX()),
                Vector3d(at.data())};
  }

  const std::string& file_;
  double reach_;
  const char* kind_ = "collision";
  std::vector<std::string> order_;  // Of the links in the file.
  std::map<std::string, const XMLElement*> elements_;
  std::map<std::string, Joint> joints_;  // By child link.
  std::map<std::string, int> index_of_;
  std::vector<SceneLink> links_;
};

}  // namespace

Result<std::vector<SceneBody>> read_urdf_scene(const std::string& file, double reach) {
  return UrdfSceneReader(file, reach).read();
}

}  // namespace retarget
