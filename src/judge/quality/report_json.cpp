#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "retarget/human.h"
#include "retarget/report.h"
#include "solve/fit/fit_report.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const std::optional<double>& value) {
  return value ? Json(*value) : Json();
}

Json json_of(const LimitedJoint& joint) {
  Json json = {{"joint", joint.joint},
               {"side", joint.at_upper ? "upper" : "lower"},
               {"frames", joint.frames},
               {"frames_pct", joint.frames_pct}};
  json["task"] = joint.task.empty() ? Json() : Json(joint.task);
  if (!joint.task.empty()) {
    json["part"] = joint.rotation ? "rotation" : "position";
    json[joint.rotation ? "short_deg" : "short_cm"] = joint.shortfall;
  }
  json["wider_set"] = joint.wider_set.empty() ? Json() : Json(joint.wider_set);
  if (!joint.wider_set.empty()) json["wider_by"] = json_of(joint.wider);
  return json;
}

Json json_of(const std::optional<TrunkLean>& lean) {
  if (!lean) return {};
  return {{"human_deg", lean->human},
          {"robot_deg", lean->robot},
          {"human_line_deg", lean->human_line},
          {"robot_line_deg", lean->robot_line},
          {"between_deg", lean->between},
          {"human_standing_deg", lean->human_standing},
          {"robot_standing_deg", lean->robot_standing}};
}

Json json_of(const std::optional<JointMostAtLimit>& max) {
  if (!max) return {};
  return {{"joint", max->joint},
          {"side", max->at_upper ? "upper" : "lower"},
          {"frames_pct", max->frames_pct}};
}

// Each contact is [first frame, end frame (exclusive), height of the support surface in metres].
Json json_of(const SourceContacts& contacts) {
  Json json;
  for (std::size_t end = 0;
       const char* name : {"left_heel", "left_toe", "right_heel", "right_toe"}) {
    json[name] = Json::array();
    for (const ContactPhase& phase : contacts[end++]) {
      json[name].push_back({phase.begin, phase.end, phase.support});
    }
  }
  return json;
}

void add_lists(Json& json, const QualityReport& report) {
  json["limit_sets"] = Json::object();
  for (const LimitSetResult& set : report.limit_sets) {
    Json& entry = json["limit_sets"][set.name];
    entry["frames_pct"] = set.frames_pct;
    entry["frames_1mrad_pct"] = set.frames_1mrad_pct;
    entry["max_rad"] = set.worst_excess;
    entry["joint"] = set.joint.empty() ? Json() : Json(set.joint);
    entry["frame"] = set.joint.empty() ? Json() : Json(set.frame);
  }
  json["tracking"] = Json::array();
  for (const TrackingRow& row : report.tracking) {
    json["tracking"].push_back({{"table", row.table},
                                {"body", row.body},
                                {"bone", row.bone},
                                {"position_cm", json_of(row.position_cm)},
                                {"position_p95_cm", json_of(row.position_p95_cm)},
                                {"rotation_deg", json_of(row.rotation_deg)},
                                {"rotation_p95_deg", json_of(row.rotation_p95_deg)}});
  }
  json["limited_joints"] = Json::array();
  for (const LimitedJoint& joint : report.limited_joints) {
    json["limited_joints"].push_back(json_of(joint));
  }
  json["segments"] = Json::array();
  for (const SegmentAngle& segment : report.segments) {
    json["segments"].push_back(
        {{"name", segment.name}, {"mean_deg", segment.mean_deg}, {"p95_deg", segment.p95_deg}});
  }
  json["trunk_lean"] = json_of(report.trunk_lean);
  json["at_limit"] = json_of(report.at_limit);
  json["beyond_range"] = json_of(report.beyond_range);
  if (!report.source.empty()) json["contacts"] = json_of(report.contacts);
}

Json json_of(const FitStatus& status) {
  return {{"begin", status.begin},
          {"end", status.end},
          {"converged", status.converged},
          {"steps", status.steps},
          {"failed_blocks", status.failed_blocks},
          {"failed", status.failed},
          {"dynamics_failed", status.dynamics_failed},
          {"predicted_decrease", status.predicted_decrease},
          {"cost_before", status.cost_before},
          {"cost_after", status.cost_after}};
}

Json json_of(const FitReport& fit) {
  Json json;
  json["floor_height_m"] = fit.floor_height;
  json["floor_found"] = fit.floor_found;
  json["contact_phases"] = fit.contact_phases;
  json["terms"] = Json::array();
  for (const FitTermReport& term : fit.terms) {
    json["terms"].push_back({{"name", term.name},
                             {"before", term.before},
                             {"after", term.after},
                             {"worst_frames", term.worst}});
  }
  json["bounded"] = Json::array();
  for (const FitBoundReport& bound : fit.bounded) {
    json["bounded"].push_back({{"joint", bound.joint},
                               {"frames", bound.frames},
                               {"worst_frame", bound.worst_frame},
                               {"largest", bound.largest}});
  }
  json["solver"] = json_of(fit.status);
  json["solver"]["windows"] = Json::array();
  for (const FitStatus& part : fit.windows) json["solver"]["windows"].push_back(json_of(part));
  json["notes"] = fit.notes;
  if (std::string note = convergence_note(fit); !note.empty()) {
    json["notes"].push_back(std::move(note));
  }
  return json;
}

Json json_of(const TravelReport& travel) {
  return {{"factor", travel.factor}, {"least", travel.least}, {"greatest", travel.greatest}};
}

Json json_of(const std::vector<SlowedStretch>& stretches) {
  Json json = Json::array();
  for (const SlowedStretch& stretch : stretches) {
    json.push_back({{"begin", stretch.begin},
                    {"end", stretch.end},
                    {"factor", stretch.factor},
                    {"cause", stretch.cause}});
  }
  return json;
}

Json json_of(const TimeScale& scale) {
  return {{"least", scale.least_factor()},
          {"longer_s", scale.longer},
          {"stretches", json_of(scale.stretches)},
          {"not_slowed", json_of(scale.left)}};
}

void add_verdict(Json& json, const QualityReport& report) {
  json["passed"] = report.passed();
  json["gates"] = Json::array();
  for (const GateResult& gate : report.gates) {
    Json& entry = json["gates"].emplace_back();
    entry = {{"metric", gate.metric},
             {"min", json_of(gate.min)},
             {"max", json_of(gate.max)},
             {"value", json_of(gate.value)},
             {"passed", gate.passed}};
  }
  json["faults"] = Json::array();
  for (const Fault& fault : report.faults) {
    json["faults"].push_back({{"metric", fault.metric},
                              {"where", fault.where},
                              {"begin", fault.begin},
                              {"end", fault.end},
                              {"worst_frame", fault.worst_frame},
                              {"amount", fault.amount},
                              {"unit", fault.unit}});
  }
}

Json json_of(const QualityReport& report) {
  Json json;
  json["file"] = report.file;
  json["robot"] = report.robot;
  json["frames"] = report.frames;
  json["fps"] = report.fps;
  json["limits"] = report.limits;
  json["source"] = report.source.empty() ? Json() : Json(report.source);
  json["source_frames"] = report.source_frames;
  json["mapping"] = report.config.empty() ? Json() : Json(report.config);
  if (report.travel) json["travel"] = json_of(*report.travel);
  if (report.time_scale) json["time_scale"] = json_of(*report.time_scale);
  json["leg_m"] = json_of(report.leg);
  json["speed_limits"] = {{"given", report.speed_limits_given},
                          {"assumed", report.speed_limits_assumed},
                          {"assumed_rad_s", report.assumed_speed_limit}};
  json["estimated_soles"] = report.estimated_soles.empty() ? Json() : Json(report.estimated_soles);
  for (const MetricValue& value : report.values) {
    const std::string key(value.metric->key);
    if (value.p95) {
      json[key] = {value.value, *value.p95};
    } else {
      json[key] = value.value;
    }
  }
  add_lists(json, report);
  if (report.fit) json["fit"] = json_of(*report.fit);
  add_verdict(json, report);
  return json;
}

}  // namespace

std::string report_json(std::span<const QualityReport> reports) {
  Json json;
  json["schema"] = "retarget-quality-1";
  json["motions"] = Json::array();
  for (const QualityReport& report : reports) json["motions"].push_back(json_of(report));
  for (const Metric& metric : quality_metrics()) {
    json["metrics"][std::string(metric.key)] = {
        {"unit", metric.unit}, {"definition", metric.definition}, {"source", metric.source}};
  }
  // `replace`, because names may be invalid UTF-8, for which dump() would throw.
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace retarget
