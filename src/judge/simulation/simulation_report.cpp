#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "retarget/simulate.h"
#include "retarget/text.h"

namespace retarget {
namespace {

std::string row(const char* label, const std::string& text) {
  return fmt::format("{:<22}{}\n", label, text);
}

std::string row(const char* label, const MeanAndP95& value, const char* unit) {
  return row(label, fmt::format("{:.2f} {} (p95 {:.2f})", value.mean, unit, value.p95));
}

nlohmann::ordered_json to_json(const MeanAndP95& value) {
  return {{"mean", value.mean}, {"p95", value.p95}};
}

}  // namespace

std::string simulation_text(const SimulationReport& report) {
  std::string text = row("robot", printable(report.robot));
  text += row("time", fmt::format("{} frames at {} fps, steps of {:.3f} ms", report.frames,
                                  fmt::format("{:g}", report.fps), 1000.0 * report.time_step));
  text += row("fall", report.fell ? fmt::format("at {:.2f} s, frame {} ({})", report.fall_time_s,
                                                report.fall_frame, report.fall_reason)
                                  : std::string("none"));
  text += row("joint error", report.joint_deg, "deg");
  text += row("root position error", report.root_cm, "cm");
  text += row("root rotation error", report.root_deg, "deg");
  text += row("body position error", report.body_cm, "cm");
  if (report.knows_torque_limits) {
    text += row("torque at limit", fmt::format("{:.2f} % of the time", report.torque_limit_pct));
    text += row("torque p99", fmt::format("{:.2f} of the limit", report.torque_p99_ratio));
  }
  text += row("foot slip", fmt::format("{:.2f} cm/s", report.slip_cm_s));
  if (report.unsolved_steps > 0)
    text += row("unsolved steps", std::to_string(report.unsolved_steps));
  return text;
}

std::string simulation_json(const SimulationReport& report) {
  nlohmann::ordered_json json = {{"robot", report.robot},
                                 {"frames", report.frames},
                                 {"fps", report.fps},
                                 {"time_step", report.time_step},
                                 {"fell", report.fell}};
  json["fall_frame"] = report.fell ? nlohmann::ordered_json(report.fall_frame) : nullptr;
  json["fall_time_s"] = report.fell ? nlohmann::ordered_json(report.fall_time_s) : nullptr;
  json["fall_reason"] = report.fell ? nlohmann::ordered_json(report.fall_reason) : nullptr;
  json["joint_error_deg"] = to_json(report.joint_deg);
  json["root_error_cm"] = to_json(report.root_cm);
  json["root_error_deg"] = to_json(report.root_deg);
  json["body_error_cm"] = to_json(report.body_cm);
  const auto if_known = [&](double value) {
    return report.knows_torque_limits ? nlohmann::ordered_json(value) : nullptr;
  };
  json["torque_limit_pct"] = if_known(report.torque_limit_pct);
  json["torque_p99_ratio"] = if_known(report.torque_p99_ratio);
  json["slip_cm_s"] = report.slip_cm_s;
  json["unsolved_steps"] = report.unsolved_steps;
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace retarget
