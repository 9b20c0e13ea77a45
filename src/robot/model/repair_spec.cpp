#include "robot/model/repair_model.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <span>

#include "retarget/text.h"
#include "robot/model/model_values.h"

namespace retarget {
namespace {

std::string element_name(mjsElement* element) {
  return mjs_getString(mjs_getName(element));
}

int joints_below(mjsBody* body) {
  int count = 0;
  for (mjsElement* e = mjs_firstChild(body, mjOBJ_JOINT, 1); e != nullptr;
       e = mjs_nextChild(body, e, 1)) {
    ++count;
  }
  return count;
}

std::vector<mjsJoint*> joints_of(mjsBody* body) {
  std::vector<mjsJoint*> joints;
  for (mjsElement* e = mjs_firstChild(body, mjOBJ_JOINT, 0); e != nullptr;
       e = mjs_nextChild(body, e, 0)) {
    joints.push_back(mjs_asJoint(e));
  }
  return joints;
}

// Returns the child body if it is the only one, otherwise null.
mjsBody* only_child(mjsBody* body) {
  mjsElement* first = mjs_firstChild(body, mjOBJ_BODY, 0);
  if (first == nullptr || mjs_nextChild(body, first, 0) != nullptr) return nullptr;
  return mjs_asBody(first);
}

bool are_finite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
}

// MuJoCo marks numbers that the model does not give with NaN.
bool is_given(std::span<const double> values) {
  return !std::isnan(values.front());
}

bool has_finite_inertial(const mjsBody& body) {
  if (!std::isfinite(body.mass) || !are_finite(body.inertia) || !are_finite(body.iquat)) {
    return false;
  }
  const bool has_place = is_given(body.ipos) || body.explicitinertial != 0;
  return (!has_place || are_finite(body.ipos)) &&
         (!is_given(body.fullinertia) || are_finite(body.fullinertia));
}

// Returns the moments of inertia that a model gives, in any order.
Eigen::Vector3d principal_moments(const mjsBody& body) {
  const double* full = body.fullinertia;
  if (!is_given(body.fullinertia)) return Eigen::Vector3d(body.inertia);
  Eigen::Matrix3d inertia;
  inertia << full[0], full[3], full[4], full[3], full[1], full[5], full[4], full[5], full[2];
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia).eigenvalues();
}

bool has_negative_inertial(const mjsBody& body) {
  return body.mass < 0.0 || principal_moments(body).minCoeff() < 0.0;
}

// MuJoCo rejects inertia matrices without three positive moments, but can raise a zero matrix to
// its minimum.
bool has_degenerate_inertia(const mjsBody& body) {
  constexpr double kLeast = 1e-12;  // Above MuJoCo's threshold for zero.
  const Eigen::Vector3d moments = principal_moments(body);
  return is_given(body.fullinertia) && moments.norm() >= kLeast && moments.minCoeff() <= kLeast;
}

template <typename Predicate>
std::vector<std::string> replace_inertials(mjSpec* spec, Predicate is_faulty) {
  constexpr double kSmall = 1e-6;
  std::vector<std::string> replaced;
  for (mjsElement* element : elements_of(spec, mjOBJ_BODY)) {
    mjsBody& body = *mjs_asBody(element);
    if (!is_faulty(body)) continue;
    replaced.push_back(element_name(element));
    if (body.mass < 0.0) body.mass = kSmall;
    std::ranges::fill(body.fullinertia, std::numeric_limits<double>::quiet_NaN());
    std::ranges::fill(body.inertia, kSmall);
  }
  return replaced;
}

std::optional<std::string> body_named(mjSpec* spec, mjtObj kind, const std::string& name) {
  if (name.empty()) return std::nullopt;
  mjsElement* element = mjs_findElement(spec, kind, name.c_str());
  if (element == nullptr) return std::nullopt;
  mjsBody* body = kind == mjOBJ_BODY ? mjs_asBody(element) : mjs_getParent(element);
  return body == nullptr ? std::nullopt : std::optional(element_name(body->element));
}

}  // namespace

std::vector<mjsElement*> elements_of(mjSpec* spec, mjtObj kind) {
  std::vector<mjsElement*> elements;
  for (mjsElement* e = mjs_firstElement(spec, kind); e != nullptr; e = mjs_nextElement(spec, e)) {
    elements.push_back(e);
  }
  return elements;
}

std::vector<std::string> repair_negative_inertials(mjSpec* spec) {
  return replace_inertials(spec, has_negative_inertial);
}

std::vector<std::string> repair_degenerate_inertias(mjSpec* spec) {
  return replace_inertials(spec, has_degenerate_inertia);
}

std::optional<std::string> body_with_infinite_inertial(mjSpec* spec) {
  for (mjsElement* element : elements_of(spec, mjOBJ_BODY)) {
    if (!has_finite_inertial(*mjs_asBody(element))) return element_name(element);
  }
  return std::nullopt;
}

namespace {

// Calls visit(name, given moments of inertia, those of the compiled model) for bodies with a mass.
template <typename Visit>
void visit_moments(mjSpec* spec, const mjModel& model, Visit visit) {
  for (mjsElement* element : elements_of(spec, mjOBJ_BODY)) {
    const mjsBody& body = *mjs_asBody(element);
    const int index = mjs_getId(element);
    if (index <= 0 || index >= model.nbody || !(body.mass > 0.0)) continue;
    visit(element_name(element), principal_moments(body), vector_at(model.body_inertia, index));
  }
}

// Returns the bodies with a mass and a zero moment of inertia, which MuJoCo raises to the
// compiler's smallest.
std::vector<std::string> bodies_without_inertia(mjSpec* spec, const mjModel& model) {
  const double least = spec->compiler.boundinertia;
  std::vector<std::string> names;
  visit_moments(spec, model, [&](const std::string& name, const auto& given, const auto& used) {
    if (given.minCoeff() <= 0.0 && used.minCoeff() <= least) names.push_back(name);
  });
  return names;
}

// Returns the bodies whose moments of inertia no body can have: the largest exceeds the sum of the
// others. MuJoCo replaces all three by their mean.
std::vector<std::string> balanced_bodies(mjSpec* spec, const mjModel& model) {
  constexpr double kEqual = 1e-6;  // Fraction of the largest moment.
  std::vector<std::string> names;
  visit_moments(spec, model, [&](const std::string& name, const auto& given, const auto& used) {
    const bool is_impossible = 2.0 * given.maxCoeff() > given.sum() && given.minCoeff() > 0.0;
    const bool is_balanced = used.maxCoeff() - used.minCoeff() <= kEqual * used.maxCoeff();
    if (is_impossible && is_balanced) names.push_back(name);
  });
  return names;
}

// Returns the moving bodies without a mass, neither their own nor that of a body fixed to them,
// for which the model has the compiler's smallest mass. Meshes that were deleted have no mass.
std::vector<std::string> massless_bodies(mjSpec* spec, const mjModel& model) {
  const double least = spec->compiler.boundmass;
  std::vector<char> has_mass(static_cast<std::size_t>(model.nbody));
  for (int body = model.nbody - 1; body > 0; --body) {
    const auto index = static_cast<std::size_t>(body);
    if (model.body_mass[body] > least) has_mass[index] = 1;
    // A body without joints moves with its parent.
    if (has_mass[index] != 0 && model.body_jntnum[body] == 0) {
      has_mass[static_cast<std::size_t>(model.body_parentid[body])] = 1;
    }
  }
  std::vector<std::string> names;
  for (mjsElement* element : elements_of(spec, mjOBJ_BODY)) {
    const int body = mjs_getId(element);
    if (body <= 0 || body >= model.nbody || model.body_jntnum[body] == 0) continue;
    const bool stated = mjs_asBody(element)->mass > 0.0;
    if (!stated && has_mass[static_cast<std::size_t>(body)] == 0) {
      names.push_back(element_name(element));
    }
  }
  return names;
}

std::string quoted_list(std::vector<std::string> bodies) {
  for (std::string& body : bodies) body = "\"" + body + "\"";
  return list_names(bodies, 4);
}

}  // namespace

std::vector<std::string> notes_about_inertials(mjSpec* spec, const mjModel& model,
                                               const std::vector<std::string>& repaired) {
  std::vector<std::string> notes;
  const auto add = [&](const std::vector<std::string>& bodies, const std::string& fault,
                       const std::string& remedy) {
    if (!bodies.empty()) notes.push_back(fault + quoted_list(bodies) + ": " + remedy);
  };
  const std::string negligible = "replaced by a negligible value";
  add(repaired, "invalid mass or inertia of ", negligible);
  add(bodies_without_inertia(spec, model), "zero moments of inertia of ", negligible);
  add(balanced_bodies(spec, model), "impossible inertia of ",
      "the largest moment exceeds the sum of the others; replaced by their mean");
  add(massless_bodies(spec, model), "no mass of the moving bodies ", negligible);
  return notes;
}

std::vector<std::string> lock_single_positions(mjSpec* spec, mjModel& model, bool is_urdf) {
  std::vector<std::string> locked;
  for (mjsElement* element : elements_of(spec, mjOBJ_JOINT)) {
    const mjsJoint& joint = *mjs_asJoint(element);
    const bool turns = joint.type == mjJNT_HINGE || joint.type == mjJNT_SLIDE;
    const int index = mjs_getId(element);
    if (!turns || index < 0 || index >= model.njnt) continue;
    // MuJoCo's reader of URDF turns such a limit off.
    const bool may_limit = joint.limited == mjLIMITED_AUTO || is_urdf;
    const mjtNum* range = model.jnt_range + 2 * static_cast<std::ptrdiff_t>(index);
    if (!may_limit || range[0] != range[1] || range[0] == 0.0) continue;
    model.jnt_limited[index] = 1;
    locked.push_back(element_name(element));
  }
  return locked;
}

mjsBody* robot_base(mjSpec* spec) {
  mjsBody* world = mjs_findBody(spec, "world");
  mjsBody* base = nullptr;
  for (mjsElement* e = mjs_firstChild(world, mjOBJ_BODY, 0); e != nullptr;
       e = mjs_nextChild(world, e, 0)) {
    mjsBody* body = mjs_asBody(e);
    if (base == nullptr || joints_below(body) > joints_below(base)) base = body;
  }
  return base;
}

std::vector<std::string> free_sliding_root(mjSpec* spec) {
  std::vector<mjsJoint*> root;
  bool slides = false;
  for (mjsBody* body = robot_base(spec); body != nullptr; body = only_child(body)) {
    const std::vector<mjsJoint*> joints = joints_of(body);
    const bool first_slides = !joints.empty() && joints.front()->type == mjJNT_SLIDE;
    slides = slides || first_slides;
    // A root that turns before it slides may be a waist.
    if (!joints.empty() && !slides) break;
    root.insert(root.end(), joints.begin(), joints.end());
  }
  std::vector<std::string> names;
  for (mjsJoint* joint : root) {
    names.push_back(element_name(joint->element));
    mjs_delete(spec, joint->element);
  }
  return names;
}

std::vector<std::string> hold_loose_balls(mjSpec* spec) {
  std::vector<std::string> names;
  for (mjsElement* element : elements_of(spec, mjOBJ_JOINT)) {
    if (mjs_asJoint(element)->type != mjJNT_BALL) continue;
    mjsBody* body = mjs_getParent(element);
    if (body == nullptr || joints_below(body) > 1) continue;
    names.push_back(element_name(element));
    mjs_delete(spec, element);
  }
  return names;
}

std::vector<TiedBodies> tied_bodies(mjSpec* spec) {
  std::vector<TiedBodies> tied;
  for (mjsElement* element : elements_of(spec, mjOBJ_EQUALITY)) {
    const mjsEquality& equality = *mjs_asEquality(element);
    if (equality.type != mjEQ_CONNECT && equality.type != mjEQ_WELD) continue;
    const mjtObj kind = equality.objtype == mjOBJ_SITE ? mjOBJ_SITE : mjOBJ_BODY;
    const auto first = body_named(spec, kind, mjs_getString(equality.name1));
    const auto second = body_named(spec, kind, mjs_getString(equality.name2));
    if (first && second && *first != "world" && *second != "world")
      tied.push_back({*first, *second});
  }
  return tied;
}

namespace {

namespace fs = std::filesystem;

// MuJoCo versions keep meshdir in the compiler settings or in the model.
template <typename Spec>
std::string mesh_folder(Spec* spec) {
  if constexpr (requires { spec->compiler.meshdir; }) {
    return mjs_getString(spec->compiler.meshdir);
  } else {
    return mjs_getString(spec->meshdir);
  }
}

std::string text_of(const mjString* text) {
  return text == nullptr ? std::string() : std::string(mjs_getString(text));
}

// Returns the meshes by name; an unnamed mesh is named after its file.
std::map<std::string, ModelMesh> meshes_of(mjSpec* spec) {
  const fs::path folder = mesh_folder(spec);
  std::map<std::string, ModelMesh> meshes;
  for (mjsElement* e = mjs_firstElement(spec, mjOBJ_MESH); e != nullptr;
       e = mjs_nextElement(spec, e)) {
    const mjsMesh* mesh = mjs_asMesh(e);
    fs::path file = text_of(mesh->file);
    if (file.empty()) continue;
    const std::string name = text_of(mjs_getName(e));
    const std::string own_name = file.stem().string();
    if (spec->strippath != 0) file = file.filename();
    const double* q = mesh->refquat;
    ModelMesh found;
    found.file = (folder / file).string();
    found.file_from_mesh = {Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized(),
                            Eigen::Map<const Eigen::Vector3d>(mesh->refpos)};
    found.scale = Eigen::Map<const Eigen::Vector3d>(mesh->scale);
    meshes.emplace(name.empty() ? own_name : name, std::move(found));
  }
  return meshes;
}

// Returns the body of a geom and the ancestors that it is fixed to.
std::vector<ModelMesh::Carrier> carriers_of(const mjModel& model, int geom) {
  std::vector<ModelMesh::Carrier> carriers;
  Pose pose = pose_at(model.geom_pos, model.geom_quat, geom);
  for (int body = model.geom_bodyid[geom]; body > 0; body = model.body_parentid[body]) {
    carriers.push_back({name_in_model(model, mjOBJ_BODY, body), pose});
    if (model.body_jntnum[body] > 0) break;
    pose = pose_at(model.body_pos, model.body_quat, body) * pose;
  }
  return carriers;
}

}  // namespace

void MeshGeoms::replace(mjSpec* spec) {
  constexpr double kSmall = 1e-3;
  // MuJoCo would otherwise discard visual geoms.
  spec->compiler.discardvisual = 0;
  const std::map<std::string, ModelMesh> meshes = meshes_of(spec);
  for (mjsElement* e = mjs_firstElement(spec, mjOBJ_GEOM); e != nullptr;
       e = mjs_nextElement(spec, e)) {
    mjsGeom* geom = mjs_asGeom(e);
    if (geom->type != mjGEOM_MESH) continue;
    const auto found = meshes.find(text_of(geom->meshname));
    if (found == meshes.end()) continue;
    ModelMesh mesh = found->second;
    mesh.is_visual = geom->contype == 0 && geom->conaffinity == 0;
    geom->type = mjGEOM_SPHERE;
    std::fill_n(geom->size, 3, kSmall);
    geom->fromto[0] = std::numeric_limits<double>::quiet_NaN();
    mjs_setString(geom->meshname, "");
    replaced_.push_back({e, std::move(mesh)});
  }
}

std::vector<ModelMesh> MeshGeoms::find(const mjModel& model) const {
  std::vector<ModelMesh> meshes;
  for (const auto& [element, mesh] : replaced_) {
    const int geom = mjs_getId(element);
    if (geom < 0 || geom >= model.ngeom) continue;
    meshes.push_back(mesh);
    meshes.back().carriers = carriers_of(model, geom);
    meshes.back().geom = geom;
  }
  return meshes;
}

}  // namespace retarget
