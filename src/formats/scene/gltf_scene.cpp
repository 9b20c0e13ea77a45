#include "formats/scene/read_scene.h"

#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "base/json.h"
#include "base/try.h"
#include "formats/scene/clip_builder.h"
#include "formats/scene/gltf_document.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr int kMaxDepth = 1000;
// Libraries with a thousand animations of a body stay far below this.
constexpr std::size_t kMaxTakesTimesNodes = 20'000'000;

std::optional<std::vector<double>> numbers_of(const GltfJson& node, const char* key,
                                              std::size_t count) {
  const GltfJson* list = gltf_member(node, key);
  auto numbers = list == nullptr ? std::nullopt : value_from<std::vector<double>>(*list);
  return numbers && numbers->size() == count ? numbers : std::nullopt;
}

NodeTransform rest_of(const GltfJson& node) {
  NodeTransform rest;
  if (const auto matrix = numbers_of(node, "matrix", 16)) {
    Eigen::Affine3d affine = Eigen::Affine3d::Identity();
    affine.matrix() = Eigen::Map<const Eigen::Matrix4d>(matrix->data());
    return decomposed(affine);
  }
  if (const auto t = numbers_of(node, "translation", 3))
    rest.translation = {(*t)[0], (*t)[1], (*t)[2]};
  if (const auto s = numbers_of(node, "scale", 3)) rest.scale = {(*s)[0], (*s)[1], (*s)[2]};
  if (const auto r = numbers_of(node, "rotation", 4)) {
    rest.rotation = Eigen::Quaterniond((*r)[3], (*r)[0], (*r)[1], (*r)[2]);
  }
  return rest;
}

// Beginnings of the names of extensions that change only meshes, textures, lights and metadata, or
// name bones. Compressed numbers are rejected where they are read.
constexpr std::string_view kHarmless[] = {
    "EXT_lights_", "EXT_mesh",       "EXT_texture_",  "KHR_draco_mesh_compression",
    "KHR_lights_", "KHR_materials_", "KHR_mesh",      "KHR_texture_",
    "KHR_xmp",     "MSFT_packing_",  "MSFT_texture_", "VRM"};

bool is_harmless(const std::string& extension) {
  return std::ranges::any_of(kHarmless,
                             [&](std::string_view start) { return extension.starts_with(start); });
}

// Builds a scene from a document.
class GltfReader {
 public:
  explicit GltfReader(GltfDocument& document) : document_(document) {}

  Result<SceneGraph> read() {
    scene_.format = "glTF";
    scene_.up = Eigen::Vector3d::UnitY();
    TRY(check_not_of_robot());
    TRY(check_version());
    TRY(check_extensions());
    TRY(find_parents());
    TRY(add_nodes());
    TRY(add_skins());
    name_bones();
    auto motion = std::make_unique<GltfMotion>(scene_.nodes);
    const std::size_t takes = document_.list("animations").size();
    if (takes > kMaxTakesTimesNodes / std::max<std::size_t>(scene_.nodes.size(), 1)) {
      return document_.fault(
          fmt::format("{} of {} exceed the limit", count_text(takes, "animation"),
                      count_text(scene_.nodes.size(), "node")),
          "export the armature with only the required animation");
    }
    for (const GltfJson& animation : document_.list("animations")) {
      TRY_ASSIGN(SceneTake take, motion->add(document_, animation, place_));
      if (take.name.empty()) take.name = "animation " + std::to_string(scene_.takes.size() + 1);
      scene_.takes.push_back(std::move(take));
    }
    scene_.motion = std::move(motion);
    return std::move(scene_);
  }

 private:
  // retarget marks the files that it writes of robots, whose bodies are not a skeleton to retarget.
  Result<void> check_not_of_robot() const {
    const GltfJson* asset = gltf_member(document_.json(), "asset");
    const GltfJson* extras = asset == nullptr ? nullptr : gltf_member(*asset, "extras");
    const GltfJson* robot = extras == nullptr ? nullptr : gltf_member(*extras, "robot");
    if (robot == nullptr || !robot->is_string()) return {};
    return input_failure(document_.file_name(),
                         "the file shows the robot " + printable(robot->get<std::string>()) +
                             " and is not a human motion",
                         "give the motion file that it was made from, such as walk.csv");
  }

  // Files of some programs lack the version.
  Result<void> check_version() const {
    const GltfJson* asset = gltf_member(document_.json(), "asset");
    const GltfJson* version = asset == nullptr ? nullptr : gltf_member(*asset, "version");
    if (version == nullptr) return {};
    const std::string text = version->is_string() ? version->get<std::string>() : version->dump();
    if (text == "2" || text.starts_with("2.")) return {};
    return document_.fault("expected version 2, found version " + printable(text),
                           "convert it to glTF 2.0, or import it in Blender and export it as GLB");
  }

  // A required extension may change how nodes and animations are read.
  Result<void> check_extensions() const {
    std::vector<std::string> unknown;
    for (const GltfJson& each : document_.list("extensionsRequired")) {
      const std::string name = each.is_string() ? each.get<std::string>() : each.dump();
      if (!is_harmless(name)) unknown.push_back(printable(name));
    }
    if (unknown.empty()) return {};
    return document_.fault(
        "it requires " + std::string(unknown.size() == 1 ? "the extension " : "the extensions ") +
            list_names(unknown, 8) + ", which retarget does not read",
        "export it without " + std::string(unknown.size() == 1 ? "it" : "them"));
  }

  Result<void> find_parents() {
    const GltfJson& nodes = document_.list("nodes");
    parent_.assign(nodes.size(), -1);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const GltfJson* children = gltf_member(nodes[i], "children");
      if (children == nullptr) continue;
      const auto list = value_from<std::vector<std::size_t>>(*children);
      if (!list) return document_.fault("the children of a node are not a list of nodes");
      for (const std::size_t child : *list) {
        if (child >= nodes.size()) return document_.fault("a node refers to a missing child");
        if (parent_[child] != -1) return document_.fault("a node has two parents");
        parent_[child] = static_cast<int>(i);
      }
    }
    return {};
  }

  // Adds nodes with parents first. Nodes in a cycle are never reached.
  Result<void> add_nodes() {
    const GltfJson& nodes = document_.list("nodes");
    std::vector<std::vector<std::size_t>> children(nodes.size());
    std::vector<std::pair<std::size_t, int>> waiting;  // Node and its depth.
    for (std::size_t i = nodes.size(); i-- > 0;) {
      if (parent_[i] < 0) waiting.emplace_back(i, 0);
      if (parent_[i] >= 0) children[static_cast<std::size_t>(parent_[i])].push_back(i);
    }
    place_.assign(nodes.size(), -1);
    while (!waiting.empty()) {
      const auto [index, depth] = waiting.back();
      waiting.pop_back();
      if (depth > kMaxDepth) return document_.fault("its nodes are nested more than 1000 deep");
      place_[index] = static_cast<int>(scene_.nodes.size());
      scene_.nodes.push_back(node_of(nodes[index], parent_[index]));
      if (!is_sound(scene_.nodes.back().rest)) {
        return document_.fault("the transform of " + name_of(index) +
                               " is not finite or has a zero rotation");
      }
      for (const std::size_t child : children[index]) waiting.emplace_back(child, depth + 1);
    }
    if (scene_.nodes.size() != nodes.size())
      return document_.fault("its nodes form a cycle instead of a tree");
    return {};
  }

  std::string name_of(std::size_t index) const {
    const GltfJson* name = gltf_member(document_.list("nodes")[index], "name");
    return name != nullptr && name->is_string() && !name->empty()
               ? "the node \"" + printable(name->get<std::string>()) + "\""
               : "node " + std::to_string(index);
  }

  SceneNode node_of(const GltfJson& json, int parent) const {
    SceneNode node;
    const GltfJson* name = gltf_member(json, "name");
    if (name != nullptr && name->is_string()) node.name = name->get<std::string>();
    node.parent = parent < 0 ? -1 : place_[static_cast<std::size_t>(parent)];
    node.rest = rest_of(json);
    node.is_object = gltf_member(json, "mesh") != nullptr || gltf_member(json, "camera") != nullptr;
    return node;
  }

  // Adds skins, the largest first: several skins of one skeleton may have different bind spaces.
  Result<void> add_skins() {
    const GltfJson& skins = document_.list("skins");
    std::vector<std::vector<std::size_t>> joints(skins.size());
    for (std::size_t i = 0; i < skins.size(); ++i) {
      const GltfJson* list = gltf_member(skins[i], "joints");
      auto found = list == nullptr ? std::nullopt : value_from<std::vector<std::size_t>>(*list);
      if (!found) return document_.fault("a skin has no joints");
      for (const std::size_t joint : *found) {
        if (joint >= place_.size()) return document_.fault("a skin refers to a missing joint");
      }
      joints[i] = *std::move(found);
    }
    std::vector<std::size_t> order(skins.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::greater{},
                             [&](std::size_t i) { return joints[i].size(); });
    for (const std::size_t i : order) TRY(add_skin(skins[i], joints[i]));
    return {};
  }

  Result<void> add_skin(const GltfJson& skin, const std::vector<std::size_t>& joints) {
    bool is_bound = false;
    for (const std::size_t joint : joints) {
      SceneNode& node = node_at(joint);
      node.is_bone = true;
      is_bound = is_bound || node.world_from_bind.has_value();
    }
    const GltfJson* matrices = gltf_member(skin, "inverseBindMatrices");
    if (matrices == nullptr || is_bound) return {};
    TRY_ASSIGN(const auto numbers, document_.numbers(*matrices, 16));
    if (numbers.size() < joints.size() * 16) {
      return document_.fault("a skin has fewer matrices than joints");
    }
    for (std::size_t i = 0; i < joints.size(); ++i) {
      Eigen::Affine3d bone_from_world = Eigen::Affine3d::Identity();
      bone_from_world.matrix() = Eigen::Map<const Eigen::Matrix4d>(numbers.data() + 16 * i);
      bone_from_world.makeAffine();
      if (usable_bind(bone_from_world)) {
        node_at(joints[i]).world_from_bind = usable_bind(bone_from_world.inverse());
      }
    }
    return {};
  }

  SceneNode& node_at(std::size_t index) {
    return scene_.nodes[static_cast<std::size_t>(place_[index])];
  }

  // Maps bones to nodes as VRM defines: a list with "bone" and "node", or an object of bones.
  std::map<std::string, std::size_t> vrm_bones() const {
    std::map<std::string, std::size_t> bones;
    const auto add = [&](const std::string& bone, const GltfJson* node) {
      const auto index = node == nullptr ? std::nullopt : value_from<std::size_t>(*node);
      if (index && *index < place_.size() && !bone.empty()) bones.emplace(bone, *index);
    };
    const GltfJson* extensions = gltf_member(document_.json(), "extensions");
    for (const char* name : {"VRMC_vrm", "VRM", "VRMC_vrm_animation"}) {
      const GltfJson* extension = extensions == nullptr ? nullptr : gltf_member(*extensions, name);
      const GltfJson* humanoid =
          extension == nullptr ? nullptr : gltf_member(*extension, "humanoid");
      const GltfJson* all = humanoid == nullptr ? nullptr : gltf_member(*humanoid, "humanBones");
      if (all == nullptr) continue;
      for (const auto& [key, bone] : all->items()) {
        const GltfJson* word = gltf_member(bone, "bone");
        add(all->is_object()                       ? key
            : word != nullptr && word->is_string() ? word->get<std::string>()
                                                   : "",
            gltf_member(bone, "node"));
      }
    }
    return bones;
  }

  void name_bones() {
    const auto bones = vrm_bones();
    if (bones.empty()) return;
    scene_.format = "VRM";
    std::set<std::size_t> named;
    for (const auto& [bone, node] : bones) named.insert(node);
    for (std::size_t i = 0; i < place_.size(); ++i) {
      if (!named.contains(i) && bones.contains(node_at(i).name)) node_at(i).name += "_node";
    }
    for (const auto& [bone, node] : bones) {
      node_at(node).name = bone;
      node_at(node).is_bone = true;
    }
  }

  GltfDocument& document_;
  SceneGraph scene_;
  std::vector<int> parent_;  // Parent of each node of the document; -1: none.
  std::vector<int> place_;   // Index in the scene of each node of the document.
};

}  // namespace

Result<SceneGraph> read_gltf(std::string_view bytes, const std::string& file_name,
                             std::size_t max_bytes) {
  TRY_ASSIGN(GltfDocument document, GltfDocument::open(bytes, file_name, max_bytes));
  return GltfReader(document).read();
}

}  // namespace retarget
