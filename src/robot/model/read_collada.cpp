// Reads the shapes in COLLADA files: nodes, geometries, triangles.

#include <tinyxml2.h>
#include <algorithm>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/parse_xml.h"
#include "retarget/so3.h"
#include "retarget/text.h"
#include "robot/model/read_mesh.h"

namespace retarget {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;
using tinyxml2::XMLElement;

constexpr int kDeepestNode = 100;
constexpr std::size_t kMostTriangles = 20'000'000;

template <typename Number>
std::optional<std::vector<Number>> numbers_of(const XMLElement* element) {
  const char* raw = element == nullptr ? nullptr : element->GetText();
  std::string_view text = raw == nullptr ? std::string_view() : raw;
  std::vector<Number> numbers;
  for (auto word = take_word(text); !word.empty(); word = take_word(text)) {
    const auto number = parse_number<Number>(word);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

// Returns the id in a `url="#name"` reference.
std::string target(const XMLElement& element, const char* name) {
  const std::string text = attribute_of(&element, name);
  return text.starts_with('#') ? text.substr(1) : text;
}

// Calls a function for every child element of a given name.
template <typename Call>
void each(const XMLElement* parent, const char* name, const Call& call) {
  if (parent == nullptr) return;
  for (const XMLElement* e : children_of(*parent, name)) {
    call(*e);
  }
}

// The rotation that keeps the directions right, up and toward the viewer. With X up, right is -Y and
// toward the viewer Z; with Y up, X and Z; with Z up, X and -Y.
Eigen::Matrix3d z_up_from_file(const XMLElement* asset) {
  const XMLElement* stated = asset == nullptr ? nullptr : asset->FirstChildElement("up_axis");
  std::string_view text =
      stated == nullptr || stated->GetText() == nullptr ? "" : stated->GetText();
  const std::string_view up = take_word(text);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (up == "Z_UP") return turn;
  if (up == "X_UP") {
    turn << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  } else {
    turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  }
  return turn;
}

class ColladaReader {
 public:
  ColladaReader(const XMLElement& root, ColladaAxes axes) {
    each(root.FirstChildElement("library_geometries"), "geometry", [&](const XMLElement& geometry) {
      geometries_[attribute_of(&geometry, "id")] = &geometry;
    });
    const XMLElement* asset = root.FirstChildElement("asset");
    const XMLElement* unit = asset == nullptr ? nullptr : asset->FirstChildElement("unit");
    if (unit != nullptr) {
      if (const auto metres = parse_number<double>(attribute_of(unit, "meter"))) metres_ = *metres;
    }
    Matrix4d from_file = Matrix4d::Identity();
    if (axes == ColladaAxes::kZUp) from_file.topLeftCorner<3, 3>() = z_up_from_file(asset);
    each(root.FirstChildElement("library_visual_scenes"), "visual_scene",
         [&](const XMLElement& scene) {
           each(&scene, "node", [&](const XMLElement& node) { add_node(node, from_file, 0); });
         });
  }

  [[nodiscard]] bool sound() const { return sound_; }
  TriangleMesh take() { return std::move(mesh_); }

 private:
  void add_node(const XMLElement& node, const Matrix4d& world_from_parent, int depth);
  void add_geometry(const XMLElement& geometry, const Matrix4d& world_from_node);
  bool add_triangles(const XMLElement& primitive, std::size_t first, std::size_t count);
  std::optional<Matrix4d> pose_of(const XMLElement& node) const;

  std::map<std::string, const XMLElement*> geometries_;
  double metres_ = 1.0;
  bool sound_ = true;
  TriangleMesh mesh_;
};

// Returns the product of all transforms of a node, in document order.
std::optional<Matrix4d> ColladaReader::pose_of(const XMLElement& node) const {
  Matrix4d pose = Matrix4d::Identity();
  for (const XMLElement* e : children_of(node)) {
    const std::string_view what = e->Name();
    if (what != "matrix" && what != "translate" && what != "rotate" && what != "scale") continue;
    const auto numbers = numbers_of<double>(e);
    const std::size_t wanted = what == "matrix" ? 16 : what == "rotate" ? 4 : 3;
    if (!numbers || numbers->size() != wanted) return std::nullopt;
    Matrix4d step = Matrix4d::Identity();
    if (what == "matrix") {
      step = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers->data());
    } else if (what == "translate") {
      step.topRightCorner<3, 1>() = Eigen::Map<const Vector3d>(numbers->data());
    } else if (what == "scale") {
      step.diagonal().head<3>() = Eigen::Map<const Vector3d>(numbers->data());
    } else {
      const Vector3d axis = Eigen::Map<const Vector3d>(numbers->data()).normalized();
      const double angle = (*numbers)[3] * std::numbers::pi / 180.0;
      step.topLeftCorner<3, 3>() = exp_so3(angle * axis).toRotationMatrix();
    }
    pose *= step;
  }
  return pose;
}

void ColladaReader::add_node(const XMLElement& node, const Matrix4d& world_from_parent, int depth) {
  const auto pose = pose_of(node);
  if (!pose || depth > kDeepestNode) {
    sound_ = false;
    return;
  }
  const Matrix4d world_from_node = world_from_parent * *pose;
  each(&node, "instance_geometry", [&](const XMLElement& instance) {
    const auto found = geometries_.find(target(instance, "url"));
    if (found != geometries_.end()) add_geometry(*found->second, world_from_node);
  });
  each(&node, "node",
       [&](const XMLElement& child) { add_node(child, world_from_node, depth + 1); });
}

void ColladaReader::add_geometry(const XMLElement& geometry, const Matrix4d& world_from_node) {
  const XMLElement* mesh = geometry.FirstChildElement("mesh");
  if (mesh == nullptr) return;
  std::string positions;
  each(mesh->FirstChildElement("vertices"), "input", [&](const XMLElement& input) {
    if (attribute_of(&input, "semantic") == "POSITION") positions = target(input, "source");
  });
  const XMLElement* array = nullptr;
  each(mesh, "source", [&](const XMLElement& source) {
    if (attribute_of(&source, "id") == positions) array = source.FirstChildElement("float_array");
  });
  const auto numbers = numbers_of<double>(array);
  if (!numbers || numbers->size() % 3 != 0) {
    sound_ = false;
    return;
  }
  const std::size_t first = mesh_.vertices.size();
  for (std::size_t i = 0; i < numbers->size(); i += 3) {
    const Vector3d vertex = Eigen::Map<const Vector3d>(numbers->data() + i);
    mesh_.vertices.push_back(metres_ * (world_from_node * vertex.homogeneous()).head<3>());
  }
  for (const char* kind : {"triangles", "polylist", "polygons"}) {
    each(mesh, kind, [&](const XMLElement& primitive) {
      if (!add_triangles(primitive, first, numbers->size() / 3)) sound_ = false;
    });
  }
}

// Corners are consecutive, with one index per input; polygons are triangulated as fans.
bool ColladaReader::add_triangles(const XMLElement& primitive, std::size_t first,
                                  std::size_t count) {
  std::size_t stride = 0, offset = 0;
  each(&primitive, "input", [&](const XMLElement& input) {
    const std::size_t at = parse_number<unsigned>(attribute_of(&input, "offset")).value_or(0);
    stride = std::max(stride, at + 1);
    if (attribute_of(&input, "semantic") == "VERTEX") offset = at;
  });
  const auto sizes = numbers_of<unsigned>(primitive.FirstChildElement("vcount"));
  if (stride == 0 || stride > 100 || !sizes) return false;
  bool sound = true;
  each(&primitive, "p", [&](const XMLElement& list) {
    const auto indices = numbers_of<unsigned>(&list);
    if (!indices) {
      sound = false;
      return;
    }
    const std::size_t corners = indices->size() / stride;
    const bool is_polygon = std::string_view(primitive.Name()) == "polygons";
    std::size_t at = 0;
    for (std::size_t face = 0; at < corners; ++face) {
      const std::size_t size = is_polygon ? corners : face < sizes->size() ? (*sizes)[face] : 3;
      if (size == 0 || size > corners - at || mesh_.triangles.size() > kMostTriangles) {
        sound = false;
        return;
      }
      const auto corner = [&](std::size_t i) { return (*indices)[(at + i) * stride + offset]; };
      for (std::size_t i = 0; i < size; ++i) sound = sound && corner(i) < count;
      for (std::size_t i = 2; sound && i < size; ++i) {
        mesh_.triangles.push_back({static_cast<int>(first + corner(0)),
                                   static_cast<int>(first + corner(i - 1)),
                                   static_cast<int>(first + corner(i))});
      }
      at += size;
    }
  });
  return sound;
}

}  // namespace

Result<TriangleMesh> read_collada(std::string_view bytes, const std::string& file,
                                  ColladaAxes axes) {
  tinyxml2::XMLDocument document;
  const auto parsed = parse_xml(bytes, document);
  const XMLElement* root = document.RootElement();
  if (!parsed || root == nullptr || std::string_view(root->Name()) != "COLLADA") {
    return input_failure(file, "is not a COLLADA file");
  }
  ColladaReader reader(*root, axes);
  if (!reader.sound()) return input_failure(file, "the COLLADA file is damaged");
  return reader.take();
}

}  // namespace retarget
