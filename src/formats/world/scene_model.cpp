// Robots and their scenes as MJCF.

#include <mujoco/mujoco.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/try.h"
#include "retarget/robot.h"
#include "retarget/write_scene.h"
#include "robot/model/model_values.h"
#include "robot/model/mujoco_messages.h"

namespace retarget {
namespace {

using Type = SceneShape::Type;

constexpr double kLeastRange = 1e-6;  // Radians or metres.

template <typename From, typename To>
void copy(const From* from, To* to, int count) {
  for (int i = 0; i < count; ++i) to[i] = static_cast<To>(from[i]);
}

void put_pose(const Pose& pose, double* position, double* quaternion) {
  for (int i = 0; i < 3; ++i) position[i] = pose.translation[i];
  quaternion[0] = pose.rotation.w();
  for (int i = 0; i < 3; ++i) quaternion[1 + i] = pose.rotation.vec()[i];
}

// Since MuJoCo 4, stiffness and damping are polynomials.
template <typename Member>
void put_linear(Member& member, double value) {
  if constexpr (std::is_array_v<Member>) {
    member[0] = value;
  } else {
    member = value;
  }
}

// Writes a compiled robot into an empty model.
class RobotCopy {
 public:
  RobotCopy(const Robot& robot, mjSpec* spec)
      : robot_(robot), model_(*robot.model()), spec_(spec) {}

  void write() {
    bodies_.push_back(mjs_findBody(spec_, "world"));
    add_geoms(0);
    for (int body = 1; body < model_.nbody; ++body) {
      add_body(body);
      add_joints(body);
      add_geoms(body);
    }
  }

  [[nodiscard]] bool has_plane() const {
    return std::any_of(model_.geom_type, model_.geom_type + model_.ngeom,
                       [](int type) { return type == mjGEOM_PLANE; });
  }

 private:
  void set_name(mjsElement* element, mjtObj kind, int index) {
    const char* name = mj_id2name(&model_, kind, index);
    if (name != nullptr) mjs_setName(element, name);
  }

  void add_body(int index) {
    mjsBody* body =
        mjs_addBody(bodies_[static_cast<std::size_t>(model_.body_parentid[index])], nullptr);
    set_name(body->element, mjOBJ_BODY, index);
    copy(model_.body_pos + 3 * index, body->pos, 3);
    copy(model_.body_quat + 4 * index, body->quat, 4);
    body->explicitinertial = 1;
    body->mass = model_.body_mass[index];
    copy(model_.body_ipos + 3 * index, body->ipos, 3);
    copy(model_.body_iquat + 4 * index, body->iquat, 4);
    copy(model_.body_inertia + 3 * index, body->inertia, 3);
    bodies_.push_back(body);
  }

  void add_joints(int body) {
    mjsBody* of = bodies_.back();
    const int first = model_.body_jntadr[body];
    for (int j = first; j < first + model_.body_jntnum[body]; ++j) {
      const bool is_free = model_.jnt_type[j] == mjJNT_FREE;
      mjsJoint* joint = is_free ? mjs_addFreeJoint(of) : mjs_addJoint(of, nullptr);
      set_name(joint->element, mjOBJ_JOINT, j);
      if (!is_free) fill_joint(j, *joint);
    }
  }

  void fill_joint(int j, mjsJoint& joint) {
    joint.type = static_cast<mjtJoint>(model_.jnt_type[j]);
    copy(model_.jnt_pos + 3 * j, joint.pos, 3);
    copy(model_.jnt_axis + 3 * j, joint.axis, 3);
    joint.ref = model_.qpos0[model_.jnt_qposadr[j]];
    joint.springref = model_.qpos_spring[model_.jnt_qposadr[j]];
    const bool limited = model_.jnt_limited[j] != 0;
    joint.limited = limited ? mjLIMITED_TRUE : mjLIMITED_FALSE;
    copy(model_.jnt_range + 2 * j, joint.range, 2);
    // MuJoCo rejects limits to a single position.
    if (limited && joint.range[0] == joint.range[1]) joint.range[1] += kLeastRange;
    const int dof = model_.jnt_dofadr[j];
    put_linear(joint.stiffness, model_.jnt_stiffness[j]);
    put_linear(joint.damping, model_.dof_damping[dof]);
    joint.frictionloss = model_.dof_frictionloss[dof];
    // Robot::joints() has all joints but the free one, which is the first.
    const double torque = robot_.torque_limit(j - 1);
    joint.armature = robot_.rotor_inertia(j - 1);
    if (!std::isfinite(torque)) return;
    joint.actfrclimited = mjLIMITED_TRUE;
    joint.actfrcrange[0] = -torque;
    joint.actfrcrange[1] = torque;
  }

  void add_geoms(int body) {
    const int first = model_.body_geomadr[body];
    for (int g = first; g < first + model_.body_geomnum[body]; ++g) {
      const int type = model_.geom_type[g];
      if (type == mjGEOM_MESH || type == mjGEOM_HFIELD || type == mjGEOM_SDF) continue;
      mjsGeom* geom = mjs_addGeom(bodies_.back(), nullptr);
      set_name(geom->element, mjOBJ_GEOM, g);
      geom->type = static_cast<mjtGeom>(type);
      copy(model_.geom_pos + 3 * g, geom->pos, 3);
      copy(model_.geom_quat + 4 * g, geom->quat, 4);
      copy(model_.geom_size + 3 * g, geom->size, 3);
      copy(model_.geom_rgba + 4 * g, geom->rgba, 4);
      copy(model_.geom_friction + 3 * g, geom->friction, 3);
      geom->contype = model_.geom_contype[g];
      geom->conaffinity = model_.geom_conaffinity[g];
      geom->condim = model_.geom_condim[g];
      geom->priority = model_.geom_priority[g];
      geom->margin = model_.geom_margin[g];
      geom->group = model_.geom_group[g];
      geom->density = 0.0;  // The bodies have their own masses.
    }
  }

  const Robot& robot_;
  const mjModel& model_;
  mjSpec* spec_;
  std::vector<mjsBody*> bodies_;  // By index.
};

// Adds the bodies of a scene to the model of a robot.
class SceneCopy {
 public:
  SceneCopy(const SceneClip& scene, mjSpec* spec) : scene_(scene), spec_(spec) {}

  void write(bool with_floor) {
    if (with_floor) add_floor();
    for (std::size_t i = 0; i < scene_.scene->bodies.size(); ++i) add_body(i);
  }

  // Gives moving bodies their masses. @param model  compiled with the density of all geoms.
  void set_masses(const mjModel& model) {
    for (const Object& object : objects_) {
      const double wanted = scene_.scene->bodies[object.body].mass;
      const int id = mj_name2id(&model, mjOBJ_BODY, object.name.c_str());
      if (wanted <= 0.0 || id < 0 || !(model.body_mass[id] > 0.0)) continue;
      for (mjsGeom* geom : object.geoms) geom->density *= wanted / model.body_mass[id];
    }
  }

  // Appends the objects' part of a configuration.
  void append(int frame, std::vector<double>& qpos) const {
    for (const Object& object : objects_) {
      std::array<double, 7> values{};
      put_pose(scene_.pose(frame, object.body), values.data(), values.data() + 3);
      qpos.insert(qpos.end(), values.begin(), values.end());
    }
  }

 private:
  struct Object {
    std::size_t body;
    std::string name;
    std::vector<mjsGeom*> geoms;
  };

  // Returns the name, with a number if another element of this kind in the model has it.
  std::string unique(mjtObj kind, const std::string& name) const {
    std::string found = name;
    for (int number = 2; mjs_findElement(spec_, kind, found.c_str()) != nullptr; ++number) {
      found = name + "_" + std::to_string(number);
    }
    return found;
  }

  void add_floor() {
    mjsGeom* geom = mjs_addGeom(mjs_findBody(spec_, "world"), nullptr);
    mjs_setName(geom->element, unique(mjOBJ_GEOM, "floor").c_str());
    geom->type = mjGEOM_PLANE;
    geom->size[2] = 0.05;
    copy(std::array{0.8F, 0.8F, 0.8F, 1.0F}.data(), geom->rgba, 4);
  }

  void add_body(std::size_t index) {
    const SceneBody& of_scene = scene_.scene->bodies[index];
    mjsBody* body = mjs_addBody(mjs_findBody(spec_, "world"), nullptr);
    const std::string name = unique(mjOBJ_BODY, of_scene.name);
    mjs_setName(body->element, name.c_str());
    put_pose(scene_.frame_count > 0 ? scene_.pose(0, index) : of_scene.world_from_body, body->pos,
             body->quat);
    std::vector<mjsGeom*> geoms;
    for (const SceneShape& shape : of_scene.shapes) {
      geoms.push_back(add_shape(shape, of_scene.moves, name, body));
    }
    if (!of_scene.moves) return;
    mjsJoint* joint = mjs_addFreeJoint(body);
    mjs_setName(joint->element, unique(mjOBJ_JOINT, name + "_free").c_str());
    objects_.push_back({index, name, std::move(geoms)});
  }

  mjsGeom* add_shape(const SceneShape& shape, bool moves, const std::string& body_name,
                     mjsBody* body) {
    mjsGeom* geom = mjs_addGeom(body, nullptr);
    put_pose(shape.body_from_shape, geom->pos, geom->quat);
    geom->density = kObjectDensity;
    copy((moves ? std::array{0.85F, 0.6F, 0.3F, 1.0F} : std::array{0.6F, 0.65F, 0.7F, 1.0F}).data(),
         geom->rgba, 4);
    geom->size[0] = shape.radius;
    geom->size[1] = shape.half_length;
    switch (shape.type) {
      case Type::kPlane:
        geom->type = mjGEOM_PLANE;
        copy(std::array{0.0, 0.0, 0.05}.data(), geom->size, 3);
        break;
      case Type::kBox:
        geom->type = mjGEOM_BOX;
        copy(shape.half_size.data(), geom->size, 3);
        break;
      case Type::kSphere:
        geom->type = mjGEOM_SPHERE;
        break;
      case Type::kCapsule:
        geom->type = shape.half_length > 0.0 ? mjGEOM_CAPSULE : mjGEOM_SPHERE;
        break;
      case Type::kCylinder:
        geom->type = mjGEOM_CYLINDER;
        break;
      case Type::kMesh:
        geom->type = mjGEOM_MESH;
        mjs_setString(geom->meshname, add_mesh(*shape.mesh, moves, body_name).c_str());
        break;
    }
    return geom;
  }

  std::string add_mesh(const TriangleMesh& triangles, bool moves, const std::string& body_name) {
    std::string name = unique(mjOBJ_MESH, body_name);
    mjsMesh* mesh = mjs_addMesh(spec_, nullptr);
    mjs_setName(mesh->element, name.c_str());
    // Terrain may be open; only the mass of moving bodies matters.
    mesh->inertia = moves ? mjMESH_INERTIA_CONVEX : mjMESH_INERTIA_SHELL;
    std::vector<float> vertices;
    for (const Eigen::Vector3d& vertex : triangles.vertices) {
      for (const double value : vertex) vertices.push_back(static_cast<float>(value));
    }
    std::vector<int> faces;
    for (const auto& corners : triangles.triangles) {
      const auto& [a, b, c] = corners;
      if (a != b && b != c && c != a) faces.insert(faces.end(), corners.begin(), corners.end());
    }
    mjs_setFloat(mesh->uservert, vertices.data(), static_cast<int>(vertices.size()));
    mjs_setInt(mesh->userface, faces.data(), static_cast<int>(faces.size()));
    return name;
  }

  const SceneClip& scene_;
  mjSpec* spec_;
  std::vector<Object> objects_;
};

void add_key(const char* name, const RobotClip& motion, int frame, const SceneCopy& objects,
             mjSpec* spec) {
  mjsKey* key = mjs_addKey(spec);
  mjs_setName(key->element, name);
  key->time = motion.rate().time_of(frame);
  const auto robot = motion.qpos(frame);
  std::vector<double> qpos(robot.begin(), robot.end());
  objects.append(frame, qpos);
  mjs_setDouble(key->qpos, qpos.data(), static_cast<int>(qpos.size()));
}

Failure scene_failure(mjSpec* spec, const MessageGuard& guard) {
  const std::string said = mjs_getError(spec);
  return run_failure(
      "", "MuJoCo cannot compile the scene: " +
              one_line(said.empty() && !guard.errors().empty() ? guard.errors()[0] : said));
}

Result<ModelPtr> compile(mjSpec* spec, const MessageGuard& guard) {
  ModelPtr model(mj_compile(spec, nullptr));
  if (!model || !guard.errors().empty()) return scene_failure(spec, guard);
  return model;
}

Result<std::string> xml_of(const mjSpec* spec) {
  std::array<char, 1000> error{};
  std::string xml(1U << 16U, '\0');
  while (true) {
    const int needed = mj_saveXMLString(spec, xml.data(), static_cast<int>(xml.size()),
                                        error.data(), static_cast<int>(error.size()));
    if (needed < 0) {
      return run_failure("", "MuJoCo cannot write the scene: " + one_line(error.data()));
    }
    if (needed == 0) break;
    xml.resize(static_cast<std::size_t>(needed) + 1);
  }
  xml.resize(xml.find('\0'));
  return xml;
}

}  // namespace

Result<std::string> format_scene_mjcf(const RobotClip& motion, const SceneClip& scene) {
  const std::lock_guard lock(mujoco_mutex());
  const MessageGuard guard;
  const MujocoSpec spec(mj_makeSpec());
  mjs_setString(spec->modelname, motion.robot().name().c_str());
  spec->compiler.degree = 0;
  // Written inertias have fewer digits.
  spec->compiler.balanceinertia = 1;
  RobotCopy robot(motion.robot(), spec.get());
  robot.write();
  SceneCopy objects(scene, spec.get());
  objects.write(!robot.has_plane());
  TRY_ASSIGN(const ModelPtr model, compile(spec.get(), guard));
  objects.set_masses(*model);
  if (motion.frame_count() > 0) {
    add_key("start", motion, 0, objects, spec.get());
    add_key("end", motion, motion.frame_count() - 1, objects, spec.get());
  }
  TRY(compile(spec.get(), guard));
  return xml_of(spec.get());
}

}  // namespace retarget
