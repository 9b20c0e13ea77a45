#include <array>
#include <utility>

#include "view/page_data.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::pair<std::string_view, std::string_view>, 13> kKinds = {{
    {"jumps", "jump"},
    {"root_jumps", "jump"},
    {"foot_pen_1cm_pct", "penetration"},
    {"body_pen_1cm_pct", "penetration"},
    {"contact_slip_mean", "slip"},
    {"stance_slip_mean", "slip"},
    {"self_all_1cm_pct", "self-collision"},
    {"limit_pct", "limit"},
    {"at_limit_pct", "limit"},
    {"joint_at_limit_pct", "limit"},
    {"trunk_lean_error_deg", "lean"},
    {"speed_limit_pct", "speed"},
    {"float_planted_pct", "floating"},
}};

Json figure_json(const MetricValue& value) {
  Json json = {{"key", value.metric->key},
               {"unit", value.metric->unit},
               {"definition", value.metric->definition},
               {"value", value.value}};
  if (value.p95) json["p95"] = *value.p95;
  return json;
}

Json gate_json(const GateResult& gate) {
  Json json = {{"metric", gate.metric}, {"passed", gate.passed}};
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
          {"figures", std::move(figures)},
          {"gates", std::move(gates)},
          {"faults", std::move(faults)},
          {"fault_totals", std::move(totals)},
          {"tracking", std::move(tracking)}};
}

}  // namespace retarget
