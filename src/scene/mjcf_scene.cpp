// Scenes as MJCF: every body with geoms that take part in contacts is a body.

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "base/try.h"
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
  MjcfSceneReader(const std::string& file, const LoadedModel& loaded)
      : file_(file), model_(*loaded.model), meshes_(loaded.meshes) {
    for (int geom = 0; geom < model_.ngeom; ++geom) has_contacts_ |= collides(geom);
  }

  Result<std::vector<SceneBody>> read() {
    std::vector<SceneLink> links(static_cast<std::size_t>(model_.nbody));
    for (int body = 0; body < model_.nbody; ++body) {
      SceneLink& link = links[static_cast<std::size_t>(body)];
      const char* name = mj_id2name(&model_, mjOBJ_BODY, body);
      link.body.name = name == nullptr ? "" : name;
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
                 find_scene_mesh(mesh->file, file_, mesh->scale, mesh->file_from_mesh));
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
  bool has_contacts_ = false;
};

}  // namespace

Result<std::vector<SceneBody>> read_mjcf_scene(const std::string& file) {
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
  return MjcfSceneReader(file, loaded).read();
}

}  // namespace retarget
