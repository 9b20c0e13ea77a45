#include <array>
#include <optional>

#include "retarget/appearance.h"
#include "retarget/bytes.h"
#include "retarget/kinematic_tree.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "retarget/view.h"
#include "view/figure.h"
#include "view/page.h"
#include "view/page_data.h"

namespace retarget {

std::string PageAsset::text() const {
  std::string whole;
  for (const std::string_view piece : pieces) whole += piece;
  return whole;
}

std::string PageAsset::policy_source() const {
  return "'sha256-" + base64_text(bytes_from_hex(sha256).value_or(std::string())) + "'";
}

std::string fill_shell(const PageAsset& shell,
                       std::span<const std::pair<std::string_view, std::string>> parts) {
  const std::string whole = shell.text();
  std::string page;
  std::size_t begin = 0;
  for (const auto& [mark, text] : parts) {
    const std::size_t at = whole.find(mark, begin);
    if (at == std::string::npos) continue;
    page.append(whole, begin, at - begin).append(text);
    begin = at + mark.size();
  }
  return page.append(whole, begin, std::string::npos);
}

const char* side_name(Side side) {
  return side == Side::kLeft ? "left" : side == Side::kRight ? "right" : "middle";
}

nlohmann::ordered_json page_figure() {
  using Json = nlohmann::ordered_json;
  Json colours = Json::object(), chains = Json::array();
  for (const Side side : {Side::kLeft, Side::kRight, Side::kNone}) {
    colours[side_name(side)] = side_colour(side);
  }
  for (const auto& [side, bones] : human_chains()) {
    chains.push_back({{"side", side_name(side)}, {"bones", bones}});
  }
  return {{"colours", std::move(colours)}, {"chains", std::move(chains)}};
}

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::pair<std::string_view, std::string_view>, 21> kKinds = {{
    {"jumps", "jump"},
    {"root_jumps", "jump"},
    {"foot_pen_1cm_pct", "penetration"},
    {"body_pen_1cm_pct", "penetration"},
    {"contact_slip_mean", "slip"},
    {"stance_slip_mean", "slip"},
    {"support_slip_mean", "slip"},
    {"self_crossing_max_cm", "self-collision"},
    {"self_all_1cm_pct", "self-collision"},
    {"limit_pct", "limit"},
    {"at_limit_pct", "limit"},
    {"joint_at_limit_pct", "limit"},
    {"trunk_lean_error_deg", "lean"},
    {"speed_limit_pct", "speed"},
    {"float_planted_pct", "floating"},
    {"hover_pct", "floating"},
    {"missing_surface_pct", "floating"},
    {"support_height_p95_cm", "floating"},
    {"scene_pen_1cm_pct", "scene"},
    {"scene_contact_kept_pct", "scene"},
    {"scene_slip_mean", "scene"},
}};

Json figure_json(const MetricValue& value) {
  Json json = {{"key", value.metric->key},
               {"label", metric_label(value.metric->key)},
               {"unit", value.metric->unit},
               {"definition", value.metric->definition},
               {"value", value.value}};
  if (value.p95) json["p95"] = *value.p95;
  return json;
}

Json gate_json(const GateResult& gate) {
  const Metric* metric = find_metric(gate.metric);
  Json json = {{"metric", gate.metric},
               {"label", metric_label(gate.metric)},
               {"unit", metric == nullptr ? std::string_view() : metric->unit},
               {"passed", gate.passed}};
  if (gate.min) json["min"] = *gate.min;
  if (gate.max) json["max"] = *gate.max;
  if (gate.value) json["value"] = *gate.value;
  return json;
}

// A fault refers to a body, two bodies as "a in b", or a joint.
Json fault_json(const Fault& fault, const Robot& robot) {
  constexpr std::string_view kIn = " in ";
  Json json = {{"kind", fault_kind(fault.metric)},
               {"metric", fault.metric},
               {"label", metric_label(fault.metric)},
               {"where", fault.where},
               {"begin", fault.begin},
               {"end", fault.end},
               {"worst", fault.worst_frame},
               {"amount", fault.amount},
               {"unit", fault.unit}};
  Json bodies = Json::array();
  const auto add = [&](std::string_view name) {
    if (const auto body = robot.find_body(name)) bodies.push_back(*body);
  };
  add(fault.where);
  if (const auto joint = robot.find_joint(fault.where)) {
    json["joint"] = *joint;
    if (bodies.empty()) bodies.push_back(robot.joints()[static_cast<std::size_t>(*joint)].body);
  }
  const std::size_t at = fault.where.find(kIn);
  if (bodies.empty() && at != std::string::npos) {
    add(std::string_view(fault.where).substr(0, at));
    add(std::string_view(fault.where).substr(at + kIn.size()));
  }
  json["bodies"] = std::move(bodies);
  return json;
}

Json tracking_json(const TrackingRow& row) {
  Json json = {{"table", row.table}, {"body", row.body}, {"bone", row.bone}};
  const auto set = [&](const char* key, const std::optional<double>& value) {
    if (value) json[key] = *value;
  };
  set("position_cm", row.position_cm);
  set("position_p95_cm", row.position_p95_cm);
  set("rotation_deg", row.rotation_deg);
  set("rotation_p95_deg", row.rotation_p95_deg);
  return json;
}

}  // namespace

std::string_view fault_kind(std::string_view metric) {
  for (const auto& [key, kind] : kKinds) {
    if (key == metric) return kind;
  }
  return "other";
}

Json page_report(const QualityReport& report, const Robot& robot) {
  Json figures = Json::array(), gates = Json::array(), faults = Json::array();
  Json tracking = Json::array();
  for (const MetricValue& value : report.values) figures.push_back(figure_json(value));
  for (const GateResult& gate : report.gates) gates.push_back(gate_json(gate));
  for (const Fault& fault : report.faults) faults.push_back(fault_json(fault, robot));
  Json totals = Json::object();
  for (const FaultTotal& total : report.fault_totals) totals[total.metric] = total.count;
  for (const TrackingRow& row : report.tracking) tracking.push_back(tracking_json(row));
  return {{"file", report.file},
          {"source", report.source},
          {"config", report.config},
          {"limits", report.limits},
          {"passed", report.passed()},
          {"estimated_soles", !report.estimated_soles.empty()},
          {"figures", std::move(figures)},
          {"gates", std::move(gates)},
          {"faults", std::move(faults)},
          {"fault_totals", std::move(totals)},
          {"tracking", std::move(tracking)}};
}

Json page_pose(const Pose& pose) {
  const auto& [q, p] = pose;
  return Json::array({p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()});
}

namespace {

Json vector_json(const Eigen::Vector3d& vector) {
  return Json::array({vector.x(), vector.y(), vector.z()});
}

Json link_json(const KinematicTree::Link& link) {
  Json json = {{"parent", link.parent}};
  if (link.joint < 0) return json;
  json["joint"] = link.joint;
  if (link.slides) json["slides"] = true;
  if (link.reference != 0.0) json["reference"] = link.reference;
  json["pose"] = page_pose(link.parent_from_link);
  return json;
}

Json shape_json(const CollisionShape& shape) {
  Json json = {{"body", shape.body}, {"pose", page_pose(shape.body_from_shape)}};
  switch (shape.type) {
    case CollisionShape::Type::kSphere:
      json["sphere"] = shape.radius;
      break;
    case CollisionShape::Type::kCapsule:
      json["capsule"] = {shape.radius, shape.half_length};
      break;
    case CollisionShape::Type::kBox:
      json["box"] = vector_json(shape.half_size);
      break;
  }
  return json;
}

}  // namespace

Json page_robot(const Robot& robot) {
  Json links = Json::array(), bodies = Json::array(), joints = Json::array();
  Json shapes = Json::array(), soles = Json::array();
  for (const KinematicTree::Link& link : robot.tree().links()) links.push_back(link_json(link));
  for (std::size_t i = 0; i < robot.bodies().size(); ++i) {
    const RobotBody& body = robot.bodies()[i];
    const auto& [link, pose] = robot.tree().attachment(static_cast<int>(i));
    bodies.push_back(
        {{"name", body.name}, {"parent", body.parent}, {"link", link}, {"pose", page_pose(pose)}});
  }
  for (std::size_t i = 0; i < robot.joints().size(); ++i) {
    const RobotJoint& joint = robot.joints()[i];
    Json json = {{"name", joint.name}, {"body", joint.body}};
    if (joint.type == RobotJoint::Type::kSlide) json["slides"] = true;
    const double speed = robot.speed_limit(static_cast<int>(i));
    if (std::isfinite(speed)) json["speed"] = speed;
    joints.push_back(std::move(json));
  }
  for (const CollisionShape& shape : visible_shapes(robot)) shapes.push_back(shape_json(shape));
  for (const Sole& sole : robot.profile().soles) {
    Json points = Json::array();
    for (const Eigen::Vector3d& point : sole.points) points.push_back(vector_json(point));
    soles.push_back({{"side", sole.side}, {"body", sole.body}, {"points", std::move(points)}});
  }
  return {{"name", robot.name()},
          {"variant", robot.variant().name},
          {"root", robot.root_body()},
          {"links", std::move(links)},
          {"bodies", std::move(bodies)},
          {"joints", std::move(joints)},
          {"outputs", robot.output_joints()},
          {"shapes", std::move(shapes)},
          {"soles", std::move(soles)}};
}

namespace {

std::string title_of(std::span<const PageMotion> motions) {
  std::vector<std::string> labels;
  for (const PageMotion& motion : motions) {
    labels.push_back(motion.label.empty() ? motion.clip->robot().name() : motion.label);
  }
  return list_names(labels);
}

}  // namespace

std::string assemble_page(const std::string& title, PageData data) {
  const std::string policy = "default-src 'none'; script-src " + kPageScript.policy_source() +
                             "; style-src " + kPageStyle.policy_source() +
                             "; base-uri 'none'; form-action 'none'";
  // In the order of the marks in the shell.
  const std::array<std::pair<std::string_view, std::string>, 6> parts = {
      {{"@POLICY@", policy},
       {"@TITLE@", xml_text(title)},
       {"@STYLE@", kPageStyle.text()},
       {"@HEADER@", std::move(data.header)},
       {"@TRACKS@", std::move(data.tracks)},
       {"@SCRIPT@", kPageScript.text()}}};
  return fill_shell(kPageShell, parts);
}

Result<std::string> view_page(std::span<const PageMotion> motions, const PageOptions& options) {
  PageOptions with_title = options;
  if (with_title.title.empty()) with_title.title = title_of(motions);
  RETARGET_TRY_ASSIGN(PageData data, page_data(motions, with_title));
  return assemble_page(with_title.title, std::move(data));
}

Result<std::string> view_page(const Motion& motion, const std::string& label,
                              const QualityReport* report, const RobotMeshes* meshes) {
  QualityReport measured;
  if (report == nullptr) {
    RETARGET_TRY_ASSIGN(measured, evaluate(motion));
    report = &measured;
  }
  const WrittenMotion written(motion);
  const std::optional<MotionScene> scene = motion_scene(motion);
  const PageMotion shown{
      label, &written.clip, &written.human,           report, &motion.plan.limits,
      {},    meshes,        scene ? &*scene : nullptr};
  return view_page({&shown, 1});
}

}  // namespace retarget
