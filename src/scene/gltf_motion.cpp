#include "scene/gltf_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/json_members.h"
#include "base/printable.h"
#include "base/try.h"
#include "math/so3.h"

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

// larger than any list: no number
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
    // a quaternion and its negative are one rotation
    if (width == 4 && now.dot(first) < 0.0) now = -now;
    if ((now - first).cwiseAbs().maxCoeff() > tolerance) return true;
  }
  return false;
}

// glTF 2.0, appendix C
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
    return document.fault("an animation's sampler is broken");
  }
  track.kind = *kind;
  track.width = path == GltfPath::kRotation ? 4 : 3;
  TRY_ASSIGN(auto times, document.numbers(*input, 1));
  TRY_ASSIGN(track.values, document.numbers(*output, track.width));
  const std::size_t parts = track.kind == GltfTrack::Kind::kCubic ? 3 : 1;
  const std::size_t size = static_cast<std::size_t>(track.width);
  if (times.empty() || track.values.size() != times.size() * parts * size) {
    return document.fault("an animation has other numbers of times and of values");
  }
  // equal times are seen in files, and stand for a jump
  if (!std::ranges::is_sorted(times)) return document.fault("an animation's times do not ascend");
  for (std::size_t key = 0; path == GltfPath::kRotation && key < times.size(); ++key) {
    const double* rotation = track.values.data() + (key * parts + (parts == 3 ? 1 : 0)) * size;
    if (Eigen::Map<const Eigen::Vector4d>(rotation).norm() < 1e-3) {
      return document.fault("an animation has a rotation of no length");
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
  for (const GltfJson& channel : *channels) {
    const GltfJson* target = gltf_member(channel, "target");
    if (target == nullptr) return document.fault("an animation's channel has no target");
    // shapes of faces, and what extensions animate, are none of a skeleton's
    const auto path = path_of(text_member(*target, "path", ""));
    const GltfJson* node = gltf_member(*target, "node");
    if (!path || node == nullptr) continue;
    const std::size_t index = number_of(node), sampler = number_of(gltf_member(channel, "sampler"));
    if (index >= scene_nodes.size() || sampler >= samplers->size()) {
      return document.fault("an animation's channel leads nowhere");
    }
    TRY_ASSIGN(GltfTrack track, read_track(document, (*samplers)[sampler], *path));
    const int place = scene_nodes[index];
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
    // most channels have the same times as the one before
    if (last != nullptr && *last == *channel.track.times) continue;
    last = channel.track.times.get();
    times.insert(times.end(), last->begin(), last->end());
  }
  return times;
}

}  // namespace retarget
