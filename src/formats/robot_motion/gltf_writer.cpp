#include "formats/robot_motion/gltf_writer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "retarget/bytes.h"
#include "retarget/so3.h"
#include "retarget/trigonometry.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr std::uint32_t kGlbMagic = 0x46546C67, kGlbVersion = 2, kJsonChunk = 0x4E4F534A,
                        kBinaryChunk = 0x004E4942;

void pad(std::string& bytes, char filler) {
  while (bytes.size() % 4 != 0) bytes += filler;
}

const char* type_name(int components) {
  switch (components) {
    case 1:
      return "SCALAR";
    case 3:
      return "VEC3";
    case 4:
      return "VEC4";
    default:
      return "MAT4";
  }
}

// Converts an sRGB channel to linear light with a polynomial, which gives the same result on every
// machine (error below 1/255).
double linear_light(int channel) {
  const double c = channel / 255.0;
  return c * (c * (c * 0.305306011 + 0.682171111) + 0.012522878);
}

}  // namespace

GltfWriter::GltfWriter() {
  document_["asset"] = {{"version", "2.0"}, {"generator", "retarget"}};
}

void GltfWriter::mark_robot(const std::string& name) {
  document_["asset"]["extras"] = {{"robot", name}};
}

int GltfWriter::add(const char* list, Json object) {
  Json& all = document_[list];
  all.push_back(std::move(object));
  return static_cast<int>(all.size()) - 1;
}

Json& GltfWriter::at(const char* list, int index) {
  return document_[list][static_cast<std::size_t>(index)];
}

int GltfWriter::add_accessor(int components, int component_type, std::size_t count, int target,
                             std::size_t first_byte) {
  Json view = {
      {"buffer", 0}, {"byteOffset", first_byte}, {"byteLength", bytes_.size() - first_byte}};
  if (target != 0) view["target"] = target;
  pad(bytes_, '\0');
  return add("accessors", {{"bufferView", add("bufferViews", std::move(view))},
                           {"componentType", component_type},
                           {"count", count},
                           {"type", type_name(components)}});
}

int GltfWriter::add_floats(std::span<const float> values, int components, Use use) {
  const std::size_t first_byte = bytes_.size(), width = static_cast<std::size_t>(components);
  for (const float value : values) {
    append_little_endian(bytes_, value);
  }
  const int accessor = add_accessor(components, kFloat, values.size() / width,
                                    use == Use::kVertices ? kArrayBuffer : 0, first_byte);
  // glTF requires the range of positions and of key times.
  if (components == 1 || (components == 3 && use == Use::kVertices)) {
    std::vector<double> min(width, std::numeric_limits<double>::infinity());
    std::vector<double> max(width, -std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < values.size(); ++i) {
      min[i % width] = std::min<double>(min[i % width], values[i]);
      max[i % width] = std::max<double>(max[i % width], values[i]);
    }
    at("accessors", accessor)["min"] = min;
    at("accessors", accessor)["max"] = max;
  }
  return accessor;
}

int GltfWriter::add_indices(std::span<const std::uint32_t> values) {
  const std::size_t first_byte = bytes_.size();
  // glTF reserves the highest value of an index type.
  const bool small = values.empty() || std::ranges::max(values) < 0xFFFF;
  for (const std::uint32_t value : values) append_little_endian(bytes_, value, small ? 2 : 4);
  return add_accessor(1, small ? kUnsignedShort : kUnsignedInt, values.size(), kElementArrayBuffer,
                      first_byte);
}

int GltfWriter::add_joints(std::span<const std::uint16_t> values) {
  const std::size_t first_byte = bytes_.size();
  for (const std::uint16_t value : values) append_little_endian(bytes_, value, 2);
  return add_accessor(4, kUnsignedShort, values.size() / 4, kArrayBuffer, first_byte);
}

Result<std::string> GltfWriter::finish(std::span<const int> roots) {
  document_["scene"] = 0;
  document_["scenes"] =
      Json::array({Json{{"nodes", std::vector<int>(roots.begin(), roots.end())}}});
  document_["buffers"] = Json::array({Json{{"byteLength", bytes_.size()}}});
  // Names may contain invalid UTF-8, which is replaced.
  std::string json = document_.dump(-1, ' ', false, Json::error_handler_t::replace);
  pad(json, ' ');
  const std::size_t size = 12 + 8 + json.size() + 8 + bytes_.size();
  if (size > std::numeric_limits<std::uint32_t>::max()) {
    return run_failure("", "a GLB is limited to 4 GiB", "write a part of the motion");
  }
  std::string file;
  file.reserve(size);
  for (const std::uint32_t value : {kGlbMagic, kGlbVersion, static_cast<std::uint32_t>(size),
                                    static_cast<std::uint32_t>(json.size()), kJsonChunk}) {
    append_little_endian(file, value, 4);
  }
  file += json;
  append_little_endian(file, static_cast<std::uint32_t>(bytes_.size()), 4);
  append_little_endian(file, kBinaryChunk, 4);
  return file + bytes_;
}

Json gltf_vector(const Eigen::Vector3d& vector) {
  const Eigen::Vector3f v = vector.cast<float>();
  return {v.x(), v.y(), v.z()};
}

Json gltf_rotation(const Eigen::Quaterniond& rotation) {
  const Eigen::Vector4f q = rotation.coeffs().cast<float>();
  return {q.x(), q.y(), q.z(), q.w()};
}

Eigen::Quaterniond y_up_from_z_up() {
  const double half = std::sqrt(0.5);
  return {half, -half, 0.0, 0.0};
}

int add_gltf_material(GltfWriter& writer, std::string_view name, int colour) {
  const Json factor = {static_cast<float>(linear_light((colour >> 16) & 0xFF)),
                       static_cast<float>(linear_light((colour >> 8) & 0xFF)),
                       static_cast<float>(linear_light(colour & 0xFF)), 1.0};
  return writer.add(
      "materials",
      {{"name", name},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", factor}, {"metallicFactor", 0}, {"roughnessFactor", 0.75}}}});
}

Result<void> check_key_times(const FrameRate& rate, int frames) {
  for (int frame = 1; frame < frames; ++frame) {
    if (static_cast<float>(rate.time_of(frame)) > static_cast<float>(rate.time_of(frame - 1)))
      continue;
    return run_failure("",
                       "GLB times are too coarse for a motion of this length: frames " +
                           std::to_string(frame - 1) + " and " + std::to_string(frame) +
                           " have equal times",
                       "write it in parts");
  }
  return {};
}

GltfAnimation::GltfAnimation(GltfWriter& writer, std::string_view name)
    : writer_(writer),
      animation_({{"name", name}, {"channels", Json::array()}, {"samplers", Json::array()}}) {}

int GltfAnimation::add_times(const FrameRate& rate, int frames) {
  std::vector<float> times;
  for (int frame = 0; frame < frames; ++frame) {
    times.push_back(static_cast<float>(rate.time_of(frame)));
  }
  return writer_.add_floats(times, 1, GltfWriter::Use::kOther);
}

void GltfAnimation::add_channel(int node, const char* path, int times, int values) {
  animation_["channels"].push_back(
      {{"sampler", animation_["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
  animation_["samplers"].push_back(
      {{"input", times}, {"output", values}, {"interpolation", "LINEAR"}});
}

void GltfAnimation::add_translations(int node, int times, std::span<const float> xyz) {
  add_channel(node, "translation", times, writer_.add_floats(xyz, 3, GltfWriter::Use::kOther));
}

void GltfAnimation::add_rotations(int node, int times, std::span<float> xyzw) {
  for (std::size_t i = 4; i < xyzw.size(); i += 4) {
    float dot = 0.0F;
    for (std::size_t k = 0; k < 4; ++k) dot += xyzw[i + k] * xyzw[i + k - 4];
    if (dot >= 0.0F) continue;
    for (std::size_t k = 0; k < 4; ++k) xyzw[i + k] = -xyzw[i + k];
  }
  add_channel(node, "rotation", times, writer_.add_floats(xyzw, 4, GltfWriter::Use::kOther));
}

void GltfAnimation::finish() {
  if (!animation_["channels"].empty()) writer_.add("animations", std::move(animation_));
}

namespace {

using Eigen::Vector3d;

constexpr std::uint32_t kSegments = 20;  // Around the axis.
constexpr int kRings = 5;                // Of a hemisphere, including its equator.

}  // namespace

void GltfMesh::add_vertex(const Pose& pose, const Vector3d& place, const Vector3d& normal) {
  const Vector3d in_body = pose * place, turned = pose.rotation * normal;
  for (const double value : in_body) positions.push_back(static_cast<float>(value));
  for (const double value : turned) normals.push_back(static_cast<float>(value));
}

void GltfMesh::add_capsule(const Pose& pose, double radius, double half_length) {
  const auto first = static_cast<std::uint32_t>(vertex_count());
  const auto add_ring = [&](int ring, double end) {
    const auto [sine, cosine] = portable::sin_cos(0.5 * std::numbers::pi * ring / kRings);
    for (std::uint32_t segment = 0; segment < kSegments; ++segment) {
      const auto around = portable::sin_cos(2.0 * std::numbers::pi * segment / kSegments);
      const Vector3d normal(cosine * around.cosine, cosine * around.sine, sine);
      add_vertex(pose, radius * normal + end * Vector3d::UnitZ(), normal);
    }
  };
  // Rings run from pole to pole, with a separate equator for each end.
  add_vertex(pose, {0.0, 0.0, -radius - half_length}, -Vector3d::UnitZ());
  std::uint32_t rings = 0;
  for (int ring = 1 - kRings; ring <= 0; ++ring, ++rings) add_ring(ring, -half_length);
  for (int ring = half_length > 0.0 ? 0 : 1; ring < kRings; ++ring, ++rings) {
    add_ring(ring, half_length);
  }
  add_vertex(pose, {0.0, 0.0, radius + half_length}, Vector3d::UnitZ());

  const std::uint32_t last = first + 1 + rings * kSegments;
  for (std::uint32_t segment = 0; segment < kSegments; ++segment) {
    const std::uint32_t next = (segment + 1) % kSegments;
    const std::uint32_t top = last - kSegments;
    triangles.insert(triangles.end(), {first, first + 1 + next, first + 1 + segment});
    for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
      const std::uint32_t low = first + 1 + ring * kSegments, high = low + kSegments;
      triangles.insert(triangles.end(), {low + segment, low + next, high + next, low + segment,
                                         high + next, high + segment});
    }
    triangles.insert(triangles.end(), {last, top + segment, top + next});
  }
}

void GltfMesh::add_line(const Vector3d& from, const Vector3d& to, double radius) {
  const Vector3d way = to - from;
  add_capsule({rotation_between(Vector3d::UnitZ(), way), 0.5 * (from + to)}, radius,
              0.5 * way.norm());
}

void GltfMesh::add_box(const Pose& pose, const Vector3d& half_size) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const auto corner = static_cast<std::uint32_t>(vertex_count());
      const Vector3d normal = sign * Vector3d::Unit(axis);
      Vector3d a = Vector3d::Unit((axis + 1) % 3), b = Vector3d::Unit((axis + 2) % 3);
      if (sign < 0.0) std::swap(a, b);
      for (const Vector3d& place : {Vector3d(normal - a - b), Vector3d(normal + a - b),
                                    Vector3d(normal + a + b), Vector3d(normal - a + b)}) {
        add_vertex(pose, half_size.cwiseProduct(place), normal);
      }
      triangles.insert(triangles.end(),
                       {corner, corner + 1, corner + 2, corner, corner + 2, corner + 3});
    }
  }
}

void GltfMesh::add_shape(const CollisionShape& shape) {
  if (shape.type == CollisionShape::Type::kBox) {
    add_box(shape.body_from_shape, shape.half_size);
  } else {
    add_capsule(shape.body_from_shape, shape.radius,
                shape.type == CollisionShape::Type::kCapsule ? shape.half_length : 0.0);
  }
}

GltfWriter::Json gltf_primitive(GltfWriter& writer, const GltfMesh& mesh, int material) {
  const int positions = writer.add_floats(mesh.positions, 3, GltfWriter::Use::kVertices);
  const int normals = writer.add_floats(mesh.normals, 3, GltfWriter::Use::kVertices);
  return {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}},
          {"indices", writer.add_indices(mesh.triangles)},
          {"material", material}};
}

}  // namespace retarget
