#include "robot/model/mesh_geoms.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <string>

#include "robot/model/model_values.h"

namespace retarget {
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
    const char* name = mj_id2name(&model, mjOBJ_BODY, body);
    carriers.push_back({name == nullptr ? "" : name, pose});
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
