#include "rig/format_model.h"

#include <mujoco/mujoco.h>

#include <array>
#include <cmath>

#include "retarget/pose.h"
#include "rig/number_text.h"

namespace retarget {
namespace {

std::string xml_text(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

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

class ModelWriter {
 public:
  ModelWriter(const Robot& robot, const std::vector<RoughShape>& shapes)
      : robot_(robot), shapes_(shapes) {}

  void write_body(int body, int depth, std::string& text) const;

 private:
  void write_joints(int body, const std::string& indent, std::string& text) const;
  void write_geoms(int body, const std::string& indent, std::string& text) const;
  void write_inertial(int body, const std::string& indent, std::string& text) const;

  const Robot& robot_;
  const std::vector<RoughShape>& shapes_;
};

void ModelWriter::write_joints(int body, const std::string& indent, std::string& text) const {
  if (body == robot_.root_body()) text += indent + "<freejoint name=\"floating_base\"/>\n";
  for (std::size_t j = 0; j < robot_.joints().size(); ++j) {
    const RobotJoint& joint = robot_.joints()[j];
    if (joint.body != body) continue;
    text += indent + "<joint" + attribute("name", joint.name);
    text += attribute("type", joint.type == RobotJoint::Type::kHinge ? "hinge" : "slide");
    text += attribute("axis", joint.axis.data(), 3);
    if (!joint.anchor.isZero(0.0)) text += attribute("pos", joint.anchor.data(), 3);
    if (joint.reference != 0.0) text += attribute("ref", &joint.reference, 1);
    const std::array<double, 2> range = {robot_.model_limits().lower[j],
                                         robot_.model_limits().upper[j]};
    const bool limited = std::isfinite(range[0]) && std::isfinite(range[1]);
    text += attribute("limited", limited ? "true" : "false");
    if (limited) text += attribute("range", range.data(), 2);
    text += "/>\n";
  }
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
  const std::string indent(static_cast<std::size_t>(2 * depth), ' ');
  const std::string inner = indent + "  ";
  const std::string& name = robot_.bodies()[body].name;
  text += indent + "<body" + attribute("name", name);
  text += pose_attributes(robot_.bodies()[body].parent_from_body) + ">\n";
  write_joints(body, inner, text);
  write_inertial(body, inner, text);
  write_geoms(body, inner, text);
  for (std::size_t b = 1; b < robot_.bodies().size(); ++b) {
    if (robot_.bodies()[b].parent == body) write_body(static_cast<int>(b), depth + 1, text);
  }
  text += indent + "</body>\n";
}

}  // namespace

std::string format_model(const Robot& robot, const std::string& name,
                         const std::vector<RoughShape>& shapes) {
  std::string text = "<mujoco" + attribute("model", name) + ">\n";
  text += "  <compiler angle=\"radian\" boundmass=\"1e-6\" boundinertia=\"1e-9\"/>\n";
  text += "  <worldbody>\n";
  ModelWriter(robot, shapes).write_body(robot.root_body(), 2, text);
  return text + "  </worldbody>\n</mujoco>\n";
}

}  // namespace retarget
