// GLB files of robots and humans.

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "base/try.h"
#include "formats/robot_motion/gltf_writer.h"
#include "formats/robot_motion/motion_writers.h"
#include "retarget/appearance.h"
#include "retarget/motion_io.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

// Keys of a body in its parent's frame.
struct BodyTrack {
  bool turns = false, slides = false;
  std::vector<float> rotations, translations;
};

// Finds which bodies rotate or translate relative to their parents.
std::vector<BodyTrack> tracks_of(const Robot& robot) {
  std::vector<BodyTrack> tracks(robot.bodies().size());
  BodyTrack& root = tracks[static_cast<std::size_t>(robot.root_body())];
  root.turns = root.slides = true;
  for (const RobotJoint& joint : robot.joints()) {
    BodyTrack& track = tracks[static_cast<std::size_t>(joint.body)];
    const bool hinge = joint.type == RobotJoint::Type::kHinge;
    track.turns |= hinge;
    track.slides |= !hinge || joint.anchor.norm() > 0.0;
  }
  return tracks;
}

std::vector<Pose> poses_in_parents(const Robot& robot, std::span<const double> qpos) {
  std::vector<Pose> world_from_body(robot.bodies().size());
  forward_kinematics(robot, qpos, world_from_body);
  std::vector<Pose> parent_from_body(world_from_body);
  for (std::size_t b = 1; b < world_from_body.size(); ++b) {
    const auto parent = static_cast<std::size_t>(robot.bodies()[b].parent);
    if (parent > 0) parent_from_body[b] = world_from_body[parent].inverse() * world_from_body[b];
  }
  return parent_from_body;
}

void add_keys(const RobotClip& clip, std::vector<BodyTrack>& tracks) {
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const std::vector<Pose> parent_from_body = poses_in_parents(clip.robot(), clip.qpos(frame));
    for (std::size_t b = 1; b < tracks.size(); ++b) {
      const Pose& pose = parent_from_body[b];
      if (tracks[b].turns) {
        const Eigen::Vector4d rotation = pose.rotation.normalized().coeffs();
        for (const double value : rotation) {
          tracks[b].rotations.push_back(static_cast<float>(value));
        }
      }
      if (!tracks[b].slides) continue;
      for (const double value : pose.translation) {
        tracks[b].translations.push_back(static_cast<float>(value));
      }
    }
  }
}

// Adds a mesh per body that has shapes. Maps bodies to meshes.
std::map<int, int> add_meshes(const Robot& robot, GltfWriter& writer) {
  std::map<int, GltfMesh> meshes;
  for (const CollisionShape& shape : visible_shapes(robot)) meshes[shape.body].add_shape(shape);
  const int material = add_gltf_material(writer, "robot", kRobotColour);
  std::map<int, int> of_body;
  for (const auto& [body, mesh] : meshes) {
    of_body[body] = writer.add(
        "meshes", {{"name", robot.bodies()[static_cast<std::size_t>(body)].name},
                   {"primitives", Json::array({gltf_primitive(writer, mesh, material)})}});
  }
  return of_body;
}

// @return the node of the whole robot; the node of body b is the return value plus b
int add_nodes(const RobotClip& clip, GltfWriter& writer) {
  const Robot& robot = clip.robot();
  const std::map<int, int> meshes = add_meshes(robot, writer);
  const int base =
      writer.add("nodes", {{"name", robot.name()}, {"rotation", gltf_rotation(y_up_from_z_up())}});
  // Without an animation player, show the pose of the first frame.
  const std::vector<double> zero = robot.zero_configuration();
  const std::vector<Pose> parent_from_body = poses_in_parents(
      robot, clip.frame_count() > 0 ? clip.qpos(0) : std::span<const double>(zero));
  for (std::size_t b = 1; b < robot.bodies().size(); ++b) {
    const RobotBody& body = robot.bodies()[b];
    const Pose& pose = parent_from_body[b];
    Json node = {{"name", body.name},
                 {"translation", gltf_vector(pose.translation)},
                 {"rotation", gltf_rotation(pose.rotation.normalized())}};
    if (const auto mesh = meshes.find(static_cast<int>(b)); mesh != meshes.end()) {
      node["mesh"] = mesh->second;
    }
    const int index = writer.add("nodes", std::move(node));
    writer.at("nodes", base + body.parent)["children"].push_back(index);
  }
  return base;
}

using Eigen::Vector3d;

constexpr double kMinBoneLength = 0.001;                // Metres; shorter bones are not drawn.
constexpr double kThickness = 0.15;                     // Ratio of radius to length.
constexpr double kThinnest = 0.006, kThickest = 0.035;  // Bounds of the radius, metres.

// Vertices of one colour and their skin weights.
struct SkinPart {
  GltfMesh mesh;
  std::vector<std::uint16_t> joints;
  std::vector<float> weights;

  void add_bone(const Vector3d& from, const Vector3d& to, int joint) {
    const double length = (to - from).norm();
    if (!(length > kMinBoneLength)) return;
    mesh.add_line(from, to, std::clamp(kThickness * length, kThinnest, kThickest));
    while (joints.size() < 4 * mesh.vertex_count()) {
      joints.insert(joints.end(), {static_cast<std::uint16_t>(joint), 0, 0, 0});
      weights.insert(weights.end(), {1.0F, 0.0F, 0.0F, 0.0F});
    }
  }
};

// Joint positions in the rest pose, metres, in the frame of the skeleton's node.
std::vector<Vector3d> rest_places(const HumanInWorld& human) {
  std::vector<Vector3d> places;
  for (const Joint& joint : human.clip->skeleton().joints()) {
    const Vector3d offset = human.metres_per_unit * joint.offset;
    places.push_back(joint.parent < 0 ? offset
                                      : places[static_cast<std::size_t>(joint.parent)] + offset);
  }
  return places;
}

// Meshes of the bones by colour. Each bone turns with the joint at its start.
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
  // glTF ignores the node transform of a skinned mesh, so the node needs no parent.
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

// Adds a human's skeleton as a skin of simple bones, and its motion to an animation.
// @return the scene's root nodes: that of the skeleton, and that of the mesh if it has bones.
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

// Formats a robot's motion as GLB: a root node that turns Z up into Y up, below it a node per body
// with a mesh of the body's shapes, and an animation. If `human` is given, its skeleton is added.
// @param name  name of the animation.
Result<std::string> format_robot_glb(const RobotClip& clip, const HumanInWorld* human,
                                     const std::string& name) {
  TRY(check_key_times(clip.rate(), clip.frame_count()));
  if (human != nullptr) TRY(check_key_times(human->clip->rate(), human->clip->frame_count()));
  GltfWriter writer;
  writer.mark_robot(clip.robot().name());
  GltfAnimation animation(writer, name.empty() ? "motion" : name);
  std::vector<int> roots = {add_nodes(clip, writer)};
  std::vector<BodyTrack> tracks = tracks_of(clip.robot());
  add_keys(clip, tracks);
  if (clip.frame_count() > 0) {
    const int times = animation.add_times(clip.rate(), clip.frame_count());
    for (std::size_t b = 1; b < tracks.size(); ++b) {
      const int node = roots.front() + static_cast<int>(b);
      if (tracks[b].slides) animation.add_translations(node, times, tracks[b].translations);
      if (tracks[b].turns) animation.add_rotations(node, times, tracks[b].rotations);
    }
  }
  if (human != nullptr) {
    const std::vector<int> others = add_gltf_human(writer, *human, animation);
    roots.insert(roots.end(), others.begin(), others.end());
  }
  animation.finish();
  return writer.finish(roots);
}

}  // namespace

MotionFiles write_glb(const RobotClip& clip, MotionFormat /*format*/,
                      const WriteMotionOptions& options) {
  return one_file(format_robot_glb(clip, options.human ? &*options.human : nullptr, options.name));
}

Result<std::string> format_human_glb(const HumanInWorld& human, const std::string& name) {
  TRY(check_key_times(human.clip->rate(), human.clip->frame_count()));
  GltfWriter writer;
  GltfAnimation animation(writer, name.empty() ? "motion" : name);
  const std::vector<int> roots = add_gltf_human(writer, human, animation);
  animation.finish();
  return writer.finish(roots);
}

}  // namespace retarget
