#include "formats/scene/gltf_document.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <set>
#include <utility>

#include "base/json.h"
#include "base/try.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

Eigen::Vector4d interpolated_rotation(const Eigen::Vector4d& a, const Eigen::Vector4d& b,
                                      double share) {
  const Eigen::Quaterniond from(a), to(b);
  const Eigen::Quaterniond turn = from.conjugate() * to;
  return (from * exp_so3(share * log_so3(turn))).normalized().coeffs();
}

std::string text_member(const GltfJson& object, const char* key, std::string missing) {
  const GltfJson* found = gltf_member(object, key);
  return found != nullptr && found->is_string() ? found->get<std::string>() : std::move(missing);
}

// An index; larger than any list if it is invalid.
std::size_t number_of(const GltfJson* json) {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  return json == nullptr ? kNone : value_from<std::size_t>(*json).value_or(kNone);
}

std::optional<GltfPath> path_of(const std::string& text) {
  if (text == "translation") return GltfPath::kTranslation;
  if (text == "rotation") return GltfPath::kRotation;
  if (text == "scale") return GltfPath::kScale;
  return std::nullopt;
}

std::optional<GltfTrack::Kind> kind_of(const std::string& text) {
  if (text == "STEP") return GltfTrack::Kind::kStep;
  if (text == "LINEAR") return GltfTrack::Kind::kLinear;
  if (text == "CUBICSPLINE") return GltfTrack::Kind::kCubic;
  return std::nullopt;
}

}  // namespace

Eigen::Vector4d GltfTrack::value(std::size_t key, std::size_t part) const {
  const std::size_t parts = kind == Kind::kCubic ? 3 : 1;
  const std::size_t size = static_cast<std::size_t>(width);
  const double* first = values.data() + (key * parts + part) * size;
  Eigen::Vector4d result = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < size; ++i) result[static_cast<int>(i)] = first[i];
  return result;
}

bool GltfTrack::varies() const {
  constexpr double kSameValue = 1e-5;
  const std::size_t part = kind == Kind::kCubic ? 1 : 0;
  const Eigen::Vector4d first = value(0, part);
  const double tolerance = kSameValue * std::max(1.0, first.cwiseAbs().maxCoeff());
  for (std::size_t key = 1; key < times->size(); ++key) {
    Eigen::Vector4d now = value(key, part);
    // A quaternion and its negative are the same rotation.
    if (width == 4 && now.dot(first) < 0.0) now = -now;
    if ((now - first).cwiseAbs().maxCoeff() > tolerance) return true;
  }
  return false;
}

// glTF 2.0, appendix C.
Eigen::Vector4d GltfTrack::at(double seconds) const {
  const std::size_t part = kind == Kind::kCubic ? 1 : 0;
  const auto after = std::ranges::upper_bound(*times, seconds);
  const bool is_rotation = width == 4;
  const auto plain = [&](std::size_t key) {
    const Eigen::Vector4d found = value(key, part);
    return is_rotation ? Eigen::Vector4d(found.stableNormalized()) : found;
  };
  if (after == times->begin()) return plain(0);
  const auto key = static_cast<std::size_t>(after - times->begin()) - 1;
  if (after == times->end() || kind == Kind::kStep) return plain(key);
  const double gap = (*times)[key + 1] - (*times)[key];
  const double t = (seconds - (*times)[key]) / gap;
  if (kind == Kind::kLinear) {
    if (is_rotation) return interpolated_rotation(plain(key), plain(key + 1), t);
    return value(key, 0) + t * (value(key + 1, 0) - value(key, 0));
  }
  const double square = t * t, cube = square * t;
  const Eigen::Vector4d found = (2.0 * cube - 3.0 * square + 1.0) * value(key, 1) +
                                gap * (cube - 2.0 * square + t) * value(key, 2) +
                                (3.0 * square - 2.0 * cube) * value(key + 1, 1) +
                                gap * (cube - square) * value(key + 1, 0);
  return is_rotation ? Eigen::Vector4d(found.stableNormalized()) : found;
}

GltfMotion::GltfMotion(const std::vector<SceneNode>& nodes) {
  rest_.reserve(nodes.size());
  for (const SceneNode& node : nodes) rest_.push_back(node.rest);
}

Result<GltfTrack> GltfMotion::read_track(GltfDocument& document, const GltfJson& sampler,
                                         GltfPath path) {
  GltfTrack track;
  const std::string interpolation = text_member(sampler, "interpolation", "LINEAR");
  const auto kind = kind_of(interpolation);
  const GltfJson* input = gltf_member(sampler, "input");
  const GltfJson* output = gltf_member(sampler, "output");
  if (!kind || input == nullptr || output == nullptr) {
    return document.fault("an animation sampler is invalid");
  }
  track.kind = *kind;
  track.width = path == GltfPath::kRotation ? 4 : 3;
  TRY_ASSIGN(auto times, document.numbers(*input, 1));
  TRY_ASSIGN(track.values, document.numbers(*output, track.width));
  const std::size_t parts = track.kind == GltfTrack::Kind::kCubic ? 3 : 1;
  const std::size_t size = static_cast<std::size_t>(track.width);
  if (times.empty() || track.values.size() != times.size() * parts * size) {
    return document.fault("an animation has different numbers of times and values");
  }
  // Equal times occur in files and mean a jump.
  if (!std::ranges::is_sorted(times))
    return document.fault("the times of an animation do not ascend");
  for (std::size_t key = 0; path == GltfPath::kRotation && key < times.size(); ++key) {
    const double* rotation = track.values.data() + (key * parts + (parts == 3 ? 1 : 0)) * size;
    if (Eigen::Map<const Eigen::Vector4d>(rotation).norm() < 1e-3) {
      return document.fault("an animation has a zero quaternion");
    }
  }
  track.times = std::make_shared<const std::vector<double>>(std::move(times));
  return track;
}

Result<SceneTake> GltfMotion::add(GltfDocument& document, const GltfJson& animation,
                                  const std::vector<int>& scene_nodes) {
  SceneTake take;
  take.name = text_member(animation, "name", "");
  take.has_keys.resize(rest_.size(), false);
  take.moves.resize(rest_.size(), false);
  take.begin = HUGE_VAL;
  take.end = -HUGE_VAL;
  const GltfJson* channels = gltf_member(animation, "channels");
  const GltfJson* samplers = gltf_member(animation, "samplers");
  if (channels == nullptr || !channels->is_array() || samplers == nullptr ||
      !samplers->is_array()) {
    return document.fault("an animation has no channels or no samplers");
  }
  Channels found;
  std::set<std::pair<int, GltfPath>> targets;
  for (const GltfJson& channel : *channels) {
    const GltfJson* target = gltf_member(channel, "target");
    if (target == nullptr) return document.fault("an animation channel has no target");
    // Skip morph targets and paths of extensions, which do not affect a skeleton.
    const auto path = path_of(text_member(*target, "path", ""));
    const GltfJson* node = gltf_member(*target, "node");
    if (!path || node == nullptr) continue;
    const std::size_t index = number_of(node), sampler = number_of(gltf_member(channel, "sampler"));
    if (index >= scene_nodes.size() || sampler >= samplers->size()) {
      return document.fault("an animation channel refers to a missing node or sampler");
    }
    const int place = scene_nodes[index];
    if (!targets.emplace(place, *path).second) {
      return document.fault("two channels of an animation move the " +
                            text_member(*target, "path", "") + " of node " + std::to_string(index));
    }
    TRY_ASSIGN(GltfTrack track, read_track(document, (*samplers)[sampler], *path));
    const auto node_place = static_cast<std::size_t>(place);
    take.begin = std::min(take.begin, track.times->front());
    take.end = std::max(take.end, track.times->back());
    take.has_keys[node_place] = true;
    take.moves[node_place] = take.moves[node_place] || track.varies();
    found.push_back({place, *path, std::move(track)});
  }
  if (found.empty()) take.begin = take.end = 0.0;
  std::ranges::stable_sort(found, {}, &Channel::node);
  takes_.push_back(std::move(found));
  return take;
}

NodeTransform GltfMotion::at(int take, int node, double seconds) const {
  const auto index = static_cast<std::size_t>(node);
  NodeTransform place = rest_[index];
  const std::vector<Channel>& channels = takes_[static_cast<std::size_t>(take)];
  for (auto channel = std::ranges::lower_bound(channels, node, {}, &Channel::node);
       channel != channels.end() && channel->node == node; ++channel) {
    const Eigen::Vector4d value = channel->track.at(seconds);
    if (channel->path == GltfPath::kTranslation) place.translation = value.head<3>();
    if (channel->path == GltfPath::kScale) place.scale = value.head<3>();
    if (channel->path == GltfPath::kRotation) place.rotation = Eigen::Quaterniond(value);
  }
  return place;
}

std::vector<double> GltfMotion::key_times(int take, const std::vector<bool>& nodes) const {
  std::vector<double> times;
  const std::vector<double>* last = nullptr;
  for (const Channel& channel : takes_[static_cast<std::size_t>(take)]) {
    if (!nodes[static_cast<std::size_t>(channel.node)]) continue;
    // Most channels share the times of the previous one.
    if (last != nullptr && *last == *channel.track.times) continue;
    last = channel.track.times.get();
    times.insert(times.end(), last->begin(), last->end());
  }
  return times;
}

namespace {

struct Shape {
  std::string_view name;
  int width, columns;
};
constexpr std::array<Shape, 7> kShapes = {{{"SCALAR", 1, 1},
                                           {"VEC2", 2, 1},
                                           {"VEC3", 3, 1},
                                           {"VEC4", 4, 1},
                                           {"MAT2", 4, 2},
                                           {"MAT3", 9, 3},
                                           {"MAT4", 16, 4}}};

// The integer that represents 1.
double largest(GltfComponent component) {
  switch (component) {
    case GltfComponent::kInt8:
      return 127.0;
    case GltfComponent::kUint8:
      return 255.0;
    case GltfComponent::kInt16:
      return 32767.0;
    case GltfComponent::kUint16:
      return 65535.0;
    default:
      return 1.0;
  }
}

}  // namespace

std::optional<GltfComponent> gltf_component(const nlohmann::ordered_json& type) {
  const auto number = value_from<int>(type);
  if (!number || *number < 5120 || *number > 5126 || *number == 5124) return std::nullopt;
  return static_cast<GltfComponent>(*number);
}

std::size_t gltf_size(GltfComponent component) {
  switch (component) {
    case GltfComponent::kInt8:
    case GltfComponent::kUint8:
      return 1;
    case GltfComponent::kInt16:
    case GltfComponent::kUint16:
      return 2;
    default:
      return 4;
  }
}

double gltf_number(std::string_view bytes, GltfComponent component) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < gltf_size(component); ++i) {
    bits |= std::uint32_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
  }
  switch (component) {
    case GltfComponent::kInt8:
      return static_cast<std::int8_t>(bits);
    case GltfComponent::kInt16:
      return static_cast<std::int16_t>(bits);
    case GltfComponent::kFloat:
      return std::bit_cast<float>(bits);
    default:
      return bits;
  }
}

std::size_t GltfLayout::column_bytes() const {
  const std::size_t bytes = static_cast<std::size_t>(width / columns) * gltf_size(component);
  return columns == 1 ? bytes : (bytes + 3) / 4 * 4;
}

std::size_t GltfLayout::bytes() const {
  return column_bytes() * static_cast<std::size_t>(columns);
}

void GltfLayout::append(std::string_view bytes, std::vector<double>& numbers) const {
  const double one = normalized ? largest(component) : 1.0;
  const std::size_t rows = static_cast<std::size_t>(width / columns);
  for (std::size_t column = 0; column < static_cast<std::size_t>(columns); ++column) {
    for (std::size_t row = 0; row < rows; ++row) {
      const std::size_t at = column * column_bytes() + row * gltf_size(component);
      const double value = gltf_number(bytes.substr(at), component);
      numbers.push_back(normalized ? std::max(value / one, -1.0) : value);
    }
  }
}

std::optional<GltfLayout> gltf_layout(const nlohmann::ordered_json& accessor) {
  const auto type = accessor.find("type"), kind = accessor.find("componentType");
  if (type == accessor.end() || kind == accessor.end() || !type->is_string()) return std::nullopt;
  const auto component = gltf_component(*kind);
  const auto* shape = std::ranges::find(kShapes, type->get_ref<const std::string&>(), &Shape::name);
  if (!component || shape == kShapes.end()) return std::nullopt;
  const auto normalized = accessor.find("normalized");
  const bool is_normalized =
      normalized != accessor.end() && value_from<bool>(*normalized).value_or(false);
  return GltfLayout{*component, shape->width, shape->columns,
                    is_normalized && *component != GltfComponent::kFloat};
}

}  // namespace retarget
