// Scenes as JSON lists of primitives (docs/world.md).

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/faults.h"
#include "base/json.h"
#include "base/try.h"
#include "retarget/text.h"
#include "scene/read_scene.h"
#include "scene/scene_shapes.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;
using Type = SceneShape::Type;

constexpr std::size_t kMaxHeights = 1'000'000;
constexpr double kMaxMass = 1e6;  // kg.

class JsonSceneReader {
 public:
  JsonSceneReader(std::string file, double reach) : file_(std::move(file)), reach_(reach) {}

  Result<std::vector<SceneBody>> read() {
    TRY_ASSIGN(const Json json, load_json(file_));
    if (!json.is_object()) return input_failure(file_, "expected a JSON object with \"bodies\"");
    const JsonMembers top(json, faults_);
    top.check_keys({"bodies", "comment"});
    std::vector<SceneBody> bodies;
    if (const Json* list = top.list("bodies")) {
      for (std::size_t i = 0; i < list->size(); ++i) {
        TRY_ASSIGN(SceneBody body, read_body((*list)[i], i));
        bodies.push_back(std::move(body));
      }
    } else if (faults_.empty()) {
      faults_.add("\"bodies\" is missing");
    }
    if (!faults_.empty()) return faults_.failure_in(file_, "the scene");
    return bodies;
  }

 private:
  Result<SceneBody> read_body(const Json& json, std::size_t index) {
    SceneBody body;
    std::string where = fmt::format("body {}: ", index);
    if (!json.is_object()) {
      faults_.add(where + "expected an object");
      return body;
    }
    const JsonMembers members(json, faults_, where);
    members.check_keys({"name", "position", "quaternion", "moves", "mass", "shapes", "comment"});
    body.name = members.text("name");
    if (!body.name.empty()) where = fmt::format("body \"{}\": ", body.name);
    body.world_from_body = pose_of(members, where);
    body.moves = members.flag("moves");
    if (members.find("mass") != nullptr) body.mass = size_of(members, "mass", where, kMaxMass);
    const Json* shapes = members.list("shapes");
    if (shapes == nullptr || shapes->empty())
      faults_.add(where + "\"shapes\" must list its shapes");
    for (std::size_t i = 0; shapes != nullptr && i < shapes->size(); ++i) {
      TRY(read_shape((*shapes)[i], fmt::format("{}shape {}: ", where, i), body.shapes));
    }
    return body;
  }

  Result<void> read_shape(const Json& json, const std::string& where,
                          std::vector<SceneShape>& shapes) {
    if (!json.is_object()) {
      faults_.add(where + "expected an object");
      return {};
    }
    const JsonMembers members(json, faults_, where);
    const std::string type = members.text("type");
    std::vector<std::string> keys = {"type", "position", "quaternion", "comment"};
    const auto known = [&](std::vector<std::string> more) {
      keys.insert(keys.end(), more.begin(), more.end());
      members.check_keys(keys);
    };
    SceneShape shape;
    shape.body_from_shape = pose_of(members, where);
    if (type == "mesh") {
      if (members.find("file") == nullptr && members.find("vertices") != nullptr) {
        known({"vertices", "triangles"});
        read_triangles(members, where, shape.body_from_shape, shapes);
        return {};
      }
      known({"file", "scale"});
      return read_mesh(members, where, shape.body_from_shape, shapes);
    }
    if (type == "heights") {
      known({"heights", "spacing"});
      read_heights(members, where, shape);
    } else if (type == "box") {
      known({"size"});
      shape.type = Type::kBox;
      shape.half_size = 0.5 * sizes_of(members, "size", where);
    } else if (type == "plane") {
      known({});
      shape.type = Type::kPlane;
    } else if (type == "sphere") {
      known({"radius"});
      shape.type = Type::kSphere;
      shape.radius = size_of(members, "radius", where);
    } else if (type == "capsule" || type == "cylinder") {
      known({"radius", "length"});
      shape.type = type == "capsule" ? Type::kCapsule : Type::kCylinder;
      shape.radius = size_of(members, "radius", where);
      shape.half_length = 0.5 * size_of(members, "length", where);
    } else {
      static const std::vector<std::string> kTypes = {"box",   "sphere", "capsule", "cylinder",
                                                      "plane", "mesh",   "heights"};
      faults_.add(fmt::format("{}\"type\" must be one of {}, found \"{}\"{}", where,
                              list_names(kTypes), type, faults_.suggestion(type, kTypes)));
    }
    shapes.push_back(std::move(shape));
    return {};
  }

  Result<void> read_mesh(const JsonMembers& members, const std::string& where, const Pose& pose,
                         std::vector<SceneShape>& shapes) {
    const std::string named = members.text("file");
    Vector3d scale = Vector3d::Ones();
    if (const Json* found = members.find("scale")) {
      scale = found->is_number() ? Vector3d::Constant(size_of(members, "scale", where))
                                 : sizes_of(members, "scale", where);
    }
    if (named.empty()) faults_.add(where + "\"file\" must name a mesh");
    // Read files only if there are no errors so far.
    if (!faults_.empty()) return {};
    TRY_ASSIGN(const TriangleMesh mesh,
               find_scene_mesh(named, file_, ColladaAxes::kZUp, reach_, scale));
    for (SceneShape& shape : shapes_of_mesh(mesh, pose)) shapes.push_back(std::move(shape));
    return {};
  }

  // Reads a mesh whose triangles are in the scene's file itself.
  void read_triangles(const JsonMembers& members, const std::string& where, const Pose& pose,
                      std::vector<SceneShape>& shapes) {
    TriangleMesh mesh;
    const Json* vertices = members.list("vertices");
    const Json* triangles = members.list("triangles");
    for (std::size_t i = 0; vertices != nullptr && i < vertices->size(); ++i) {
      const auto vertex = vector_from((*vertices)[i]);
      if (!vertex || !(vertex->cwiseAbs().maxCoeff() <= reach_)) {
        faults_.add(
            fmt::format("{}vertex {} must be [x, y, z], within {}", where, i, reach_text(reach_)));
        return;
      }
      mesh.vertices.push_back(*vertex);
    }
    const auto count = static_cast<int>(mesh.vertices.size());
    const auto is_vertex = [count](int index) { return index >= 0 && index < count; };
    for (std::size_t i = 0; triangles != nullptr && i < triangles->size(); ++i) {
      const auto corners = value_from<std::vector<int>>((*triangles)[i]);
      if (!corners || corners->size() != 3 || !std::ranges::all_of(*corners, is_vertex)) {
        faults_.add(
            fmt::format("{}triangle {} must be three indices of \"vertices\", from 0", where, i));
        return;
      }
      mesh.triangles.push_back({(*corners)[0], (*corners)[1], (*corners)[2]});
    }
    if (mesh.triangles.empty() || mesh.triangles.size() > kMaxSceneTriangles) {
      faults_.add(
          fmt::format("{}\"triangles\" must list 1 to {} triangles", where, kMaxSceneTriangles));
      return;
    }
    for (SceneShape& shape : shapes_of_mesh(mesh, pose)) shapes.push_back(std::move(shape));
  }

  void read_heights(const JsonMembers& members, const std::string& where, SceneShape& shape) {
    shape.type = Type::kMesh;
    auto mesh = std::make_shared<TriangleMesh>();
    shape.mesh = mesh;
    const double spacing = size_of(members, "spacing", where);
    const Json* rows = members.list("heights");
    std::vector<double> heights;
    std::size_t columns = 0;
    for (std::size_t r = 0; rows != nullptr && r < rows->size(); ++r) {
      const auto row = value_from<std::vector<double>>((*rows)[r]);
      if (!row || (r > 0 && row->size() != columns)) {
        faults_.add(fmt::format("{}row {} of \"heights\" must be a list of {} numbers", where, r,
                                r > 0 ? std::to_string(columns) : "at least two"));
        return;
      }
      columns = row->size();
      heights.insert(heights.end(), row->begin(), row->end());
    }
    const auto in_reach = [&](double height) { return std::abs(height) <= reach_; };
    if (columns < 2 || heights.size() < 2 * columns || heights.size() > kMaxHeights ||
        !std::ranges::all_of(heights, in_reach)) {
      faults_.add(fmt::format(
          "{}\"heights\" must be two or more rows of two or more numbers, {} in all at most", where,
          kMaxHeights));
      return;
    }
    const double bottom = *std::ranges::min_element(heights) - kHeightDepth;
    *mesh = height_mesh(heights, columns, {spacing, spacing}, bottom);
  }

  // Reads "position" and "quaternion"; both may be missing.
  Pose pose_of(const JsonMembers& members, const std::string& where) {
    Pose pose;
    if (const Json* found = members.find("position")) {
      const auto position = vector_from(*found);
      if (position && position->cwiseAbs().maxCoeff() <= reach_) {
        pose.translation = *position;
      } else {
        faults_.add(fmt::format("{}\"position\" must be [x, y, z], within {}, found {}", where,
                                reach_text(reach_), short_text(*found)));
      }
    }
    if (const Json* found = members.find("quaternion")) {
      const auto q = value_from<std::vector<double>>(*found);
      const double norm =
          q && q->size() == 4 ? Eigen::Map<const Eigen::Vector4d>(q->data()).norm() : 0.0;
      constexpr double kMinNorm = 1e-6, kMaxNorm = 1e6;
      if (norm > kMinNorm && norm < kMaxNorm) {
        pose.rotation = Eigen::Quaterniond((*q)[0], (*q)[1], (*q)[2], (*q)[3]).normalized();
      } else {
        faults_.add(fmt::format("{}\"quaternion\" must be [w, x, y, z], not zero, found {}", where,
                                short_text(*found)));
      }
    }
    return pose;
  }

  double size_of(const JsonMembers& members, const std::string& key, const std::string& where) {
    return size_of(members, key, where, reach_);
  }
  double size_of(const JsonMembers& members, const std::string& key, const std::string& where,
                 double at_most) {
    const Json* found = members.find(key);
    const auto size = found == nullptr ? std::nullopt : value_from<double>(*found);
    if (size && *size > 0.0 && *size <= at_most) return *size;
    add_size_fault(found, key, where, "a positive number", at_most);
    return 1.0;
  }

  Vector3d sizes_of(const JsonMembers& members, const std::string& key, const std::string& where) {
    const Json* found = members.find(key);
    const auto sizes = found == nullptr ? std::nullopt : vector_from(*found);
    if (sizes && sizes->minCoeff() > 0.0 && sizes->maxCoeff() <= reach_) return *sizes;
    add_size_fault(found, key, where, "three positive numbers", reach_);
    return Vector3d::Ones();
  }

  void add_size_fault(const Json* found, const std::string& key, const std::string& where,
                      const char* wanted, double at_most) {
    faults_.add(fmt::format("{}\"{}\" must be {} of at most {}, {}", where, key, wanted, at_most,
                            found == nullptr ? "but is missing" : "found " + short_text(*found)));
  }

  std::string file_;
  double reach_;
  Faults faults_;
};

}  // namespace

Result<std::vector<SceneBody>> read_json_scene(const std::string& file, double reach) {
  return JsonSceneReader(file, reach).read();
}

}  // namespace retarget
