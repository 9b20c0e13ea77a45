#include "io/gltf_writer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/byte_order.h"

namespace retarget {
namespace {

using Json = GltfWriter::Json;

constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2, kJsonChunk = 0x4E4F534A,
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

// a part of an sRGB colour as linear light, by a polynomial that is the same on every machine (off by
// less than 1/255)
double linear_light(int channel) {
  const double c = channel / 255.0;
  return c * (c * (c * 0.305306011 + 0.682171111) + 0.012522878);
}

}  // namespace

GltfWriter::GltfWriter() {
  document_["asset"] = {{"version", "2.0"}, {"generator", "retarget"}};
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
  // of places and times readers want to know the range
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
  // the highest value of a type is no index
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
  // names may be anything: what is no UTF-8 is replaced
  std::string json = document_.dump(-1, ' ', false, Json::error_handler_t::replace);
  pad(json, ' ');
  const std::size_t size = 12 + 8 + json.size() + 8 + bytes_.size();
  if (size > std::numeric_limits<std::uint32_t>::max()) {
    return run_failure("", "a GLB cannot hold 4 GiB or more", "write a part of the motion");
  }
  std::string file;
  file.reserve(size);
  for (const std::uint32_t value : {kMagic, kVersion, static_cast<std::uint32_t>(size),
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
                       "the times of a GLB are too coarse for so long a motion: those of frames " +
                           std::to_string(frame - 1) + " and " + std::to_string(frame) +
                           " are the same",
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

}  // namespace retarget
