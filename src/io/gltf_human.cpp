#include <algorithm>
#include <map>
#include <vector>

#include "io/gltf_mesh.h"
#include "io/gltf_motion.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Json = GltfWriter::Json;

constexpr double kLeastBone = 0.001;                    // metres; shorter ones are not shown
constexpr double kThickness = 0.15;                     // radius by length,
constexpr double kThinnest = 0.006, kThickest = 0.035;  // and its bounds, metres

// vertices that move with joints, in one colour
struct SkinPart {
  GltfMesh mesh;
  std::vector<std::uint16_t> joints;
  std::vector<float> weights;

  void add_bone(const Vector3d& from, const Vector3d& to, int joint) {
    const double length = (to - from).norm();
    if (!(length > kLeastBone)) return;
    mesh.add_line(from, to, std::clamp(kThickness * length, kThinnest, kThickest));
    while (joints.size() < 4 * mesh.vertex_count()) {
      joints.insert(joints.end(), {static_cast<std::uint16_t>(joint), 0, 0, 0});
      weights.insert(weights.end(), {1.0F, 0.0F, 0.0F, 0.0F});
    }
  }
};

// at rest, metres, in the frame of the skeleton's node
std::vector<Vector3d> rest_places(const HumanInWorld& human) {
  std::vector<Vector3d> places;
  for (const Joint& joint : human.clip->skeleton().joints()) {
    const Vector3d offset = human.metres_per_unit * joint.offset;
    places.push_back(joint.parent < 0 ? offset
                                      : places[static_cast<std::size_t>(joint.parent)] + offset);
  }
  return places;
}

// the bones by colour; each turns with the joint that it starts from
std::map<int, SkinPart> bones_of(const HumanInWorld& human, const std::vector<Vector3d>& places) {
  std::map<int, SkinPart> parts;
  const Skeleton& skeleton = human.clip->skeleton();
  const auto colour_of = [&](int joint) {
    const auto index = static_cast<std::size_t>(joint);
    return index < human.colours.size() ? human.colours[index] : kPlainColour;
  };
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const Joint& joint = skeleton.joint(j);
    const Vector3d& place = places[static_cast<std::size_t>(j)];
    if (joint.parent >= 0) {
      parts[colour_of(j)].add_bone(places[static_cast<std::size_t>(joint.parent)], place,
                                   joint.parent);
    }
    for (const Vector3d& end : joint.end_sites) {
      parts[colour_of(j)].add_bone(place, place + human.metres_per_unit * end, j);
    }
  }
  std::erase_if(parts, [](const auto& part) { return part.second.joints.empty(); });
  return parts;
}

int add_skin(GltfWriter& writer, const std::vector<Vector3d>& places, int first_joint) {
  std::vector<float> inverse_binds;
  std::vector<int> joints;
  for (std::size_t j = 0; j < places.size(); ++j) {
    Eigen::Matrix4f inverse = Eigen::Matrix4f::Identity();
    inverse.topRightCorner<3, 1>() = -places[j].cast<float>();
    inverse_binds.insert(inverse_binds.end(), inverse.data(), inverse.data() + 16);
    joints.push_back(first_joint + static_cast<int>(j));
  }
  const int matrices = writer.add_floats(inverse_binds, 16, GltfWriter::Use::kOther);
  return writer.add("skins", {{"name", "human"},
                              {"inverseBindMatrices", matrices},
                              {"skeleton", first_joint},
                              {"joints", joints}});
}

int add_skinned_mesh(GltfWriter& writer, const std::map<int, SkinPart>& parts, int skin) {
  Json primitives = Json::array();
  for (const auto& [colour, part] : parts) {
    const int material = add_gltf_material(writer, "human", colour);
    Json primitive = gltf_primitive(writer, part.mesh, material);
    primitive["attributes"]["JOINTS_0"] = writer.add_joints(part.joints);
    primitive["attributes"]["WEIGHTS_0"] =
        writer.add_floats(part.weights, 4, GltfWriter::Use::kVertices);
    primitives.push_back(std::move(primitive));
  }
  const int mesh = writer.add("meshes", {{"name", "human"}, {"primitives", std::move(primitives)}});
  // of a skinned mesh only the joints say where it is, so its node has no parent
  return writer.add("nodes", {{"name", "human mesh"}, {"mesh", mesh}, {"skin", skin}});
}

void add_keys(const HumanInWorld& human, int first_joint, GltfAnimation& animation) {
  const Clip& clip = *human.clip;
  if (clip.frame_count() == 0) return;
  const int times = animation.add_times(clip.rate(), clip.frame_count());
  std::vector<float> keys;
  for (int j = 0; j < clip.skeleton().joint_count(); ++j) {
    const int node = first_joint + j;
    if (clip.skeleton().translation_slot(j) >= 0) {
      keys.clear();
      for (int frame = 0; frame < clip.frame_count(); ++frame) {
        for (const double value : clip.translation(frame, j)) {
          keys.push_back(static_cast<float>(human.metres_per_unit * value));
        }
      }
      animation.add_translations(node, times, keys);
    }
    keys.clear();
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      const Eigen::Vector4d rotation =
          clip.rotations(frame)[static_cast<std::size_t>(j)].normalized().coeffs();
      for (const double value : rotation) {
        keys.push_back(static_cast<float>(value));
      }
    }
    animation.add_rotations(node, times, keys);
  }
}

}  // namespace

std::vector<int> add_gltf_human(GltfWriter& writer, const HumanInWorld& human,
                                GltfAnimation& animation) {
  const Skeleton& skeleton = human.clip->skeleton();
  const Eigen::Quaterniond up = y_up_from_z_up();
  const Pose& pose = human.world_from_clip;
  const int base = writer.add("nodes", {{"name", "human"},
                                        {"translation", gltf_vector(up * pose.translation)},
                                        {"rotation", gltf_rotation(up * pose.rotation)}});
  for (const Joint& joint : skeleton.joints()) {
    const Vector3d offset = human.metres_per_unit * joint.offset;
    const int node =
        writer.add("nodes", {{"name", joint.name}, {"translation", gltf_vector(offset)}});
    writer.at("nodes", base + 1 + joint.parent)["children"].push_back(node);
  }
  std::vector<int> roots = {base};
  const std::vector<Vector3d> places = rest_places(human);
  const std::map<int, SkinPart> parts = bones_of(human, places);
  if (!parts.empty()) {
    roots.push_back(add_skinned_mesh(writer, parts, add_skin(writer, places, base + 1)));
  }
  add_keys(human, base + 1, animation);
  return roots;
}

Result<std::string> format_human_glb(const HumanInWorld& human, const std::string& name) {
  GltfWriter writer;
  GltfAnimation animation(writer, name.empty() ? "motion" : name);
  const std::vector<int> roots = add_gltf_human(writer, human, animation);
  animation.finish();
  return writer.finish(roots);
}

}  // namespace retarget
