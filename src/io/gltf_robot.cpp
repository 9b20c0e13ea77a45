#include <array>
#include <map>
#include <vector>

#include "io/gltf_mesh.h"
#include "io/gltf_motion.h"
#include "robot/visible_shapes.h"

namespace retarget {
namespace {

using Json = GltfWriter::Json;

// keys of a body in its parent's frame
struct BodyTrack {
  bool turns = false, slides = false;
  std::vector<float> rotations, translations;
};

// what the joints of each body can change of its pose
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

// the shapes of each body that has any
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

// @return the node of the robot as a whole; that of body b is b behind it
int add_nodes(const RobotClip& clip, GltfWriter& writer) {
  const Robot& robot = clip.robot();
  const std::map<int, int> meshes = add_meshes(robot, writer);
  const int base =
      writer.add("nodes", {{"name", robot.name()}, {"rotation", gltf_rotation(y_up_from_z_up())}});
  // where nothing plays it stands as in the first frame
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

}  // namespace

Result<std::string> format_robot_glb(const RobotClip& clip, const HumanInWorld* human,
                                     const std::string& name) {
  GltfWriter writer;
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

}  // namespace retarget
