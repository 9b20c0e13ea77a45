#include <mujoco/mujoco.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "retarget/pose.h"
#include "solve/robot_setup/format_model.h"

namespace retarget {

double rounded(double value, int decimals) {
  double unit = 1.0;
  for (int i = 0; i < decimals; ++i) unit *= 10.0;
  return std::round(value * unit) / unit + 0.0;
}

std::string json_text(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

namespace {

std::string attribute(const std::string& name, const std::string& value) {
  return " " + name + "=\"" + xml_text(value) + "\"";
}

template <typename Number>
std::string attribute(const std::string& name, const Number* values, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += (i == 0 ? "" : " ") + number_text(values[i] + 0.0);
  return attribute(name, text);
}

std::string pose_attributes(const Pose& pose) {
  std::string text;
  if (!pose.translation.isZero(0.0)) text += attribute("pos", pose.translation.data(), 3);
  const Eigen::Quaterniond& q = pose.rotation;
  const std::array<double, 4> wxyz = {q.w(), q.x(), q.y(), q.z()};
  if (wxyz != std::array<double, 4>{1.0, 0.0, 0.0, 0.0}) {
    text += attribute("quat", wxyz.data(), 4);
  }
  return text;
}

std::string indent_of(int depth) {
  return std::string(static_cast<std::size_t>(2 * depth), ' ');
}

// Frames of joints have no mass. A stated negligible one distinguishes them from bodies whose mass
// is missing.
constexpr const char* kFrameInertial =
    "<inertial mass=\"1e-06\" pos=\"0 0 0\" diaginertia=\"1e-09 1e-09 1e-09\"/>\n";

class ModelWriter {
 public:
  ModelWriter(const Robot& robot, const std::vector<RoughShape>& shapes)
      : robot_(robot), shapes_(shapes), frames_(joint_frames(robot)) {}

  void write_body(int body, int depth, std::string& text) const;

 private:
  void write_joint(std::size_t j, const std::string& indent, std::string& text) const;
  void write_geoms(int body, const std::string& indent, std::string& text) const;
  void write_inertial(int body, const std::string& indent, std::string& text) const;

  const Robot& robot_;
  const std::vector<RoughShape>& shapes_;
  const std::vector<std::string> frames_;  // joint_frames() of the robot.
};

// Writes type, axis and range of every joint explicitly, for readers other than MuJoCo that do not
// apply defaults. A hinge without limits has the range of a full turn, which limits nothing. MuJoCo
// rejects "limited" for a range of a single position, to which load_model limits the joint.
void ModelWriter::write_joint(std::size_t j, const std::string& indent, std::string& text) const {
  const RobotJoint& joint = robot_.joints()[j];
  const bool hinge = joint.type == RobotJoint::Type::kHinge;
  text += indent + "<joint" + attribute("name", joint.name);
  text += attribute("type", hinge ? "hinge" : "slide");
  text += attribute("axis", joint.axis.data(), 3);
  if (joint.reference != 0.0) text += attribute("ref", &joint.reference, 1);
  std::array<double, 2> range = {robot_.model_limits().lower[j], robot_.model_limits().upper[j]};
  const bool limited = std::isfinite(range[0]) && std::isfinite(range[1]);
  if (!limited || range[0] < range[1]) text += attribute("limited", limited ? "true" : "false");
  if (!limited) range = {-std::numbers::pi, std::numbers::pi};
  if (limited || hinge) text += attribute("range", range.data(), 2);
  text += "/>\n";
}

void ModelWriter::write_inertial(int body, const std::string& indent, std::string& text) const {
  const mjModel* model = robot_.model();
  const double mass = model->body_mass[body];
  if (!(mass > 0.0)) return;
  text += indent + "<inertial" + attribute("mass", &mass, 1);
  text += attribute("pos", model->body_ipos + 3 * body, 3);
  text += attribute("quat", model->body_iquat + 4 * body, 4);
  text += attribute("diaginertia", model->body_inertia + 3 * body, 3) + "/>\n";
}

void ModelWriter::write_geoms(int body, const std::string& indent, std::string& text) const {
  for (const RoughShape& rough : shapes_) {
    const CollisionShape& shape = rough.shape;
    if (shape.body != body) continue;
    text += indent + "<geom";
    const std::array<double, 2> size = {shape.radius, shape.half_length};
    switch (shape.type) {
      case CollisionShape::Type::kSphere:
        text += attribute("type", "sphere") + attribute("size", size.data(), 1);
        break;
      case CollisionShape::Type::kCapsule:
        text += attribute("type", "capsule") + attribute("size", size.data(), 2);
        break;
      case CollisionShape::Type::kBox:
        text += attribute("type", "box") + attribute("size", shape.half_size.data(), 3);
        break;
    }
    text += pose_attributes(shape.body_from_shape) + attribute("mass", "0") + "/>\n";
  }
}

void ModelWriter::write_body(int body, int depth, std::string& text) const {
  const int outermost = depth;
  Pose pose = robot_.bodies()[body].parent_from_body;
  std::vector<std::size_t> held;
  for (std::size_t j = 0; j < robot_.joints().size(); ++j) {
    if (robot_.joints()[j].body != body) continue;
    if (frames_[j].empty()) {
      held.push_back(j);
      continue;
    }
    pose = pose * Pose{Eigen::Quaterniond::Identity(), robot_.joints()[j].anchor};
    text +=
        indent_of(depth) + "<body" + attribute("name", frames_[j]) + pose_attributes(pose) + ">\n";
    text += indent_of(depth + 1) + kFrameInertial;
    write_joint(j, indent_of(++depth), text);
    pose = {Eigen::Quaterniond::Identity(), -robot_.joints()[j].anchor};
  }
  const std::string inner = indent_of(depth + 1);
  text += indent_of(depth) + "<body" + attribute("name", robot_.bodies()[body].name);
  text += pose_attributes(pose) + ">\n";
  if (body == robot_.root_body()) text += inner + "<freejoint name=\"floating_base\"/>\n";
  for (const std::size_t j : held) write_joint(j, inner, text);
  write_inertial(body, inner, text);
  write_geoms(body, inner, text);
  for (std::size_t b = 1; b < robot_.bodies().size(); ++b) {
    if (robot_.bodies()[b].parent == body) write_body(static_cast<int>(b), depth + 1, text);
  }
  for (; depth >= outermost; --depth) text += indent_of(depth) + "</body>\n";
}

}  // namespace

std::vector<std::string> joint_frames(const Robot& robot) {
  const std::vector<RobotJoint>& joints = robot.joints();
  std::vector<std::string> taken = robot.body_names();
  std::vector<std::string> frames(joints.size());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const bool last = j + 1 == joints.size() || joints[j + 1].body != joints[j].body;
    if (last && joints[j].anchor.isZero(0.0)) continue;
    frames[j] = joints[j].name + "_frame";
    while (std::ranges::count(taken, frames[j]) > 0) frames[j] += "_";
    taken.push_back(frames[j]);
  }
  return frames;
}

std::string format_model(const Robot& robot, const std::string& name,
                         const std::vector<RoughShape>& shapes) {
  std::string text = "<mujoco" + attribute("model", name) + ">\n";
  text += "  <compiler angle=\"radian\" boundmass=\"1e-6\" boundinertia=\"1e-9\"/>\n";
  text += "  <worldbody>\n";
  ModelWriter(robot, shapes).write_body(robot.root_body(), 2, text);
  return text + "  </worldbody>\n</mujoco>\n";
}

}  // namespace retarget
