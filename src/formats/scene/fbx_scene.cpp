#include "formats/scene/read_scene.h"

#include <ufbx/ufbx.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "base/try.h"
#include "formats/scene/clip_builder.h"
#include "motion/clip.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// Limit on the unpacked size of arrays relative to the file, beyond a size that is always accepted.
constexpr std::size_t kMaxUnpacking = 64;
constexpr std::size_t kFreeFbxBytes = std::size_t{128} << 20U;
constexpr std::uint32_t kMaxFbxDepth = 1000;

struct SceneDeleter {
  void operator()(ufbx_scene* scene) const { ufbx_free_scene(scene); }
};
using FbxFile = std::unique_ptr<ufbx_scene, SceneDeleter>;

std::string fbx_text(const ufbx_string& text) {
  return {text.data, text.length};
}

Eigen::Vector3d fbx_vector(const ufbx_vec3& v) {
  return {v.x, v.y, v.z};
}

NodeTransform fbx_transform(const ufbx_transform& transform) {
  const ufbx_quat& q = transform.rotation;
  return {fbx_vector(transform.translation), Eigen::Quaterniond(q.w, q.x, q.y, q.z),
          fbx_vector(transform.scale)};
}

Eigen::Affine3d affine_of(const ufbx_matrix& matrix) {
  Eigen::Affine3d affine = Eigen::Affine3d::Identity();
  for (int column = 0; column < 3; ++column) {
    affine.linear().col(column) = fbx_vector(matrix.cols[column]);
  }
  affine.translation() = fbx_vector(matrix.cols[3]);
  return affine;
}

std::optional<Eigen::Vector3d> direction_of(ufbx_coordinate_axis axis) {
  if (axis >= UFBX_COORDINATE_AXIS_UNKNOWN) return std::nullopt;
  // The enumeration is +x, -x, +y, -y, +z, -z.
  const int number = static_cast<int>(axis);
  return Eigen::Vector3d::Unit(number / 2) * (number % 2 == 0 ? 1.0 : -1.0);
}

bool is_transform(const ufbx_string& property) {
  const std::string_view name(property.data, property.length);
  return name == UFBX_Lcl_Translation || name == UFBX_Lcl_Rotation || name == UFBX_Lcl_Scaling;
}

// Calls call(node, curve) for the curves of node transforms in a take.
template <typename Do>
void for_each_curve(const ufbx_anim_stack& stack, Do&& call) {
  for (const ufbx_anim_layer* layer : stack.layers) {
    for (const ufbx_anim_prop& property : layer->anim_props) {
      const ufbx_node* node = ufbx_as_node(property.element);
      if (node == nullptr || property.anim_value == nullptr || !is_transform(property.prop_name)) {
        continue;
      }
      for (const ufbx_anim_curve* curve : property.anim_value->curves) {
        if (curve != nullptr && curve->keyframes.count > 0) {
          call(static_cast<int>(node->typed_id), *curve);
        }
      }
    }
  }
}

class FbxMotion : public SceneMotion {
 public:
  explicit FbxMotion(FbxFile file) : file_(std::move(file)) {}

  NodeTransform at(int take, int node, double seconds) const override {
    return fbx_transform(
        ufbx_evaluate_transform(file_->anim_stacks.data[static_cast<std::size_t>(take)]->anim,
                                file_->nodes.data[static_cast<std::size_t>(node)], seconds));
  }

  std::vector<double> key_times(int take, const std::vector<bool>& nodes) const override {
    std::vector<double> times;
    for_each_curve(*file_->anim_stacks.data[static_cast<std::size_t>(take)],
                   [&](int node, const ufbx_anim_curve& curve) {
                     if (!nodes[static_cast<std::size_t>(node)]) return;
                     for (const ufbx_keyframe& key : curve.keyframes) times.push_back(key.time);
                   });
    return times;
  }

 private:
  FbxFile file_;
};

// Whether keys differ by more than rounding, in degrees or length units.
bool varies(const ufbx_anim_curve& curve) {
  constexpr double kSameValue = 1e-3, kRounding = 1e-6;
  const double first = curve.keyframes.data[0].value;
  return std::ranges::any_of(curve.keyframes, [&](const ufbx_keyframe& key) {
    return std::abs(key.value - first) > std::max(kSameValue, kRounding * std::abs(first));
  });
}

SceneTake take_of(const ufbx_anim_stack& stack, std::size_t node_count) {
  SceneTake take;
  take.name = fbx_text(stack.name);
  take.has_keys.resize(node_count, false);
  take.moves.resize(node_count, false);
  double first = HUGE_VAL, last = -HUGE_VAL;
  for_each_curve(stack, [&](int node, const ufbx_anim_curve& curve) {
    const auto index = static_cast<std::size_t>(node);
    take.has_keys[index] = true;
    take.moves[index] = take.moves[index] || varies(curve);
    const ufbx_keyframe_list& keys = curve.keyframes;
    first = std::min(first, keys.data[0].time);
    last = std::max(last, keys.data[keys.count - 1].time);
  });
  if (!std::isfinite(first) || !std::isfinite(last)) return take;
  take.begin = first;
  take.end = std::max(first, last);
  // Use the take's own interval where it overlaps the keys; outside the keys nothing moves.
  const double begin = std::max(first, stack.time_begin), end = std::min(last, stack.time_end);
  if (std::isfinite(begin) && std::isfinite(end) && begin < end) {
    take.begin = begin;
    take.end = end;
  }
  return take;
}

// The node of a curve of a take whose keys do not ascend; nothing if all do.
const ufbx_node* unsorted_node(const ufbx_scene& file, const ufbx_anim_stack& stack) {
  const ufbx_node* found = nullptr;
  for_each_curve(stack, [&](int node, const ufbx_anim_curve& curve) {
    if (!std::ranges::is_sorted(curve.keyframes, {}, &ufbx_keyframe::time)) {
      found = file.nodes.data[static_cast<std::size_t>(node)];
    }
  });
  return found;
}

// Pre- and post-rotation of a limb, if they are active.
Eigen::Quaterniond unturned(const ufbx_node& node) {
  if (!ufbx_find_bool(&node.props, "RotationActive", false)) {
    return Eigen::Quaterniond::Identity();
  }
  const auto turn = [&node](const char* name) {
    const ufbx_vec3 angles = ufbx_find_vec3(&node.props, name, ufbx_zero_vec3);
    const ufbx_quat q = ufbx_euler_to_quat(angles, UFBX_ROTATION_ORDER_XYZ);
    return Eigen::Quaterniond(q.w, q.x, q.y, q.z);
  };
  const Eigen::Quaterniond found = turn("PreRotation") * turn("PostRotation").conjugate();
  return found.coeffs().allFinite() ? found : Eigen::Quaterniond::Identity();
}

SceneNode node_of(const ufbx_node& node) {
  SceneNode result;
  result.name = fbx_text(node.name);
  result.parent = node.parent == nullptr ? -1 : static_cast<int>(node.parent->typed_id);
  result.rest = fbx_transform(node.local_transform);
  result.unturned = unturned(node);
  result.is_bone = node.attrib_type == UFBX_ELEMENT_BONE;
  result.is_object = node.mesh != nullptr || node.camera != nullptr || node.light != nullptr;
  return result;
}

void bind(SceneGraph& scene, const ufbx_node* node, const ufbx_matrix& world_from_bone) {
  if (node == nullptr) return;
  SceneNode& bone = scene.nodes[node->typed_id];
  if (!bone.world_from_bind) bone.world_from_bind = usable_bind(affine_of(world_from_bone));
}

// Adds the bone poses at which skins were bound.
void add_bind_poses(const ufbx_scene& file, SceneGraph& scene) {
  for (const ufbx_skin_deformer* skin : file.skin_deformers) {
    for (const ufbx_skin_cluster* cluster : skin->clusters) {
      if (cluster->bone_node == nullptr) continue;
      scene.nodes[cluster->bone_node->typed_id].is_bone = true;
      bind(scene, cluster->bone_node, cluster->bind_to_world);
    }
  }
  for (const ufbx_pose* pose : file.poses) {
    if (!pose->is_bind_pose) continue;
    for (const ufbx_bone_pose& bone : pose->bone_poses) {
      bind(scene, bone.bone_node, bone.bone_to_world);
    }
  }
}

ufbx_load_opts load_options(std::size_t file_bytes, std::size_t max_bytes) {
  ufbx_load_opts options = {};
  const std::size_t most =
      std::min(max_bytes,
               kFreeFbxBytes + kMaxUnpacking * std::min(file_bytes, SIZE_MAX / kMaxUnpacking / 2));
  options.temp_allocator.memory_limit = most;
  options.result_allocator.memory_limit = most;
  options.ignore_geometry = true;
  options.ignore_embedded = true;
  options.skip_skin_vertices = true;
  options.skip_mesh_parts = true;
  options.node_depth_limit = kMaxFbxDepth;
  options.force_single_thread_ascii_parsing = true;
  options.file_format = UFBX_FILE_FORMAT_FBX;
  // Request plain composition: world_from_child is world_from_parent times parent_from_child.
  options.inherit_mode_handling = UFBX_INHERIT_MODE_HANDLING_COMPENSATE;
  return options;
}

Failure load_failure(const ufbx_error& error, const std::string& file_name) {
  if (error.type == UFBX_ERROR_MEMORY_LIMIT || error.type == UFBX_ERROR_OUT_OF_MEMORY) {
    return input_failure(file_name, "the unpacked FBX file exceeds the memory limit for its size",
                         "export only the skeleton and its animation, without meshes and textures");
  }
  if (error.type == UFBX_ERROR_NODE_DEPTH_LIMIT) {
    return input_failure(file_name, "the FBX file's nodes are nested more than 1000 deep");
  }
  std::string what = printable(fbx_text(error.description));
  if (error.info_length > 0) {
    what += " (" + printable({error.info, error.info_length}) + ")";
  }
  return input_failure(file_name, "the FBX file cannot be read: " + what,
                       "the file may be cut off or damaged: export it again");
}

// The name before the brace of a node: `Connections` in a line `Connections:  {`.
std::string_view node_name(std::string_view text, std::size_t brace) {
  const std::string_view before = text.substr(0, brace);
  const std::size_t line = before.find_last_of('\n');
  std::string_view name = line == std::string_view::npos ? before : before.substr(line + 1);
  name = name.substr(0, name.find(':'));
  name.remove_prefix(std::min(name.find_first_not_of(" \t"), name.size()));
  return name;
}

// Checks that all nodes of a text FBX file are closed. ufbx also reads files that are cut off
// inside their last section, which then lack the motion of some limbs.
// @return kInput errors with the last line.
Result<void> check_fbx_text(std::string_view text, const std::string& file_name) {
  std::size_t depth = 0, line = 1, opening = 0, opening_line = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char letter = text[at];
    if (letter == '\n') ++line;
    if (letter == ';') {
      // A comment; its line end counts next.
      at = std::min(text.find('\n', at), text.size()) - 1;
    } else if (letter == '"') {
      const std::size_t end = std::min(text.find('"', at + 1), text.size());
      for (; at < end; ++at) line += text[at] == '\n' ? 1 : 0;
    } else if (letter == '{') {
      if (depth == 0) {
        opening = at;
        opening_line = line;
      }
      ++depth;
    } else if (letter == '}' && depth > 0) {
      --depth;
    }
  }
  if (depth == 0) return {};
  if (text.ends_with('\n')) --line;
  Error error{ErrorKind::kInput, {file_name, line, 0}, {}, {}, {}};
  error.message = "the FBX file ends inside \"" + printable(std::string(node_name(text, opening))) +
                  "\", which begins in line " + std::to_string(opening_line);
  error.hint = "the file is truncated: copy or export it again";
  return failure(std::move(error));
}

}  // namespace

Result<SceneGraph> read_fbx(std::string_view bytes, const std::string& file_name,
                            std::size_t max_bytes) {
  bytes = without_byte_order_mark(bytes);
  if (!bytes.starts_with("Kaydara FBX Binary")) TRY(check_fbx_text(bytes, file_name));
  const ufbx_load_opts options = load_options(bytes.size(), max_bytes);
  ufbx_error error;
  FbxFile file(ufbx_load_memory(bytes.data(), bytes.size(), &options, &error));
  if (file == nullptr) return load_failure(error, file_name);
  SceneGraph scene;
  scene.format = "FBX";
  scene.nodes.reserve(file->nodes.count);
  for (const ufbx_node* node : file->nodes) {
    scene.nodes.push_back(node_of(*node));
    if (scene.nodes.back().parent >= static_cast<int>(scene.nodes.size()) - 1) {
      return input_failure(file_name, "the nodes of the FBX file do not form a tree");
    }
  }
  add_bind_poses(*file, scene);
  for (const ufbx_anim_stack* stack : file->anim_stacks) {
    if (const ufbx_node* node = unsorted_node(*file, *stack)) {
      return input_failure(
          file_name, "the key times of \"" + printable(fbx_text(node->name)) + "\" do not ascend",
          "the file may be damaged: export it again");
    }
    scene.takes.push_back(take_of(*stack, scene.nodes.size()));
  }
  const ufbx_scene_settings& settings = file->settings;
  if (std::isfinite(settings.unit_meters) && settings.unit_meters > 0.0) {
    scene.metres_per_unit = settings.unit_meters;
  }
  scene.up = direction_of(settings.axes.up);
  if (is_plausible_rate(settings.frames_per_second)) {
    scene.fps = settings.frames_per_second;
  }
  scene.motion = std::make_unique<FbxMotion>(std::move(file));
  return scene;
}

}  // namespace retarget
