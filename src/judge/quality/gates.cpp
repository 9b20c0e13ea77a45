#include "retarget/report.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/faults.h"
#include "base/json.h"
#include "base/try.h"
#include "retarget/file.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

Failure unknown_metric(const std::string& key) {
  return config_failure("", "unknown metric \"" + key + "\"" + did_you_mean(key, metric_keys()));
}

// Reads one member of `gates`.
Result<Gate> gate_from(const std::string& key, const Json& json) {
  if (find_metric(key) == nullptr) return unknown_metric(key);
  Gate gate{key, std::nullopt, std::nullopt};
  if (json.is_null()) return gate;
  if (json.is_number()) {
    gate.max = json.get<double>();
    return gate;
  }
  const bool known =
      json.is_object() && std::ranges::all_of(json.items(), [](const auto& member) {
        const std::string& name = member.key();
        return (name == "min" || name == "max" || name == "leg_m") && member.value().is_number();
      });
  if (!known || !(json.contains("min") || json.contains("max"))) {
    return config_failure("", "the gate on " + key +
                                  " must be a number, null or {\"min\": number, \"max\": number}, "
                                  "optionally with \"leg_m\", found " +
                                  short_text(json));
  }
  if (json.contains("leg_m")) {
    gate.leg = json["leg_m"].get<double>();
    if (!(*gate.leg > 0.0)) {
      return config_failure("", "leg_m of the gate on " + key + " must be above 0, found " +
                                    short_text(json["leg_m"]));
    }
  }
  if (json.contains("min")) gate.min = json["min"].get<double>();
  if (json.contains("max")) gate.max = json["max"].get<double>();
  return gate;
}

}  // namespace

void Gates::set(Gate gate) {
  std::erase_if(gates_, [&gate](const Gate& old) { return old.metric == gate.metric; });
  if (gate.min || gate.max) gates_.push_back(std::move(gate));
}

Result<void> Gates::add_json(std::string_view text, const std::string& file) {
  TRY_ASSIGN(const auto json, parse_json(text, file));
  if (!json.is_object() || !json.contains("gates") || !json["gates"].is_object()) {
    return config_failure(file, "the file must contain an object with the member \"gates\"",
                          R"(such as {"gates": {"jumps": 0}})");
  }
  Faults faults;
  std::vector<Gate> found;
  for (const auto& [key, value] : json["gates"].items()) {
    auto gate = gate_from(key, value);
    if (gate) {
      found.push_back(std::move(*gate));
    } else {
      faults.add(gate.error().message);
    }
  }
  if (!faults.empty()) return faults.failure_in(file, "the gates");
  for (Gate& gate : found) set(std::move(gate));
  return {};
}

Result<void> Gates::add_file(const std::string& path) {
  TRY_ASSIGN(const auto content, read_file(path, ErrorKind::kConfig, kMaxTextBytes));
  return add_json(content.view(), path);
}

bool Gates::need_dynamics() const {
  return std::ranges::any_of(gates_, [](const Gate& gate) {
    const Metric* metric = find_metric(gate.metric);
    return metric != nullptr && needs_dynamics(*metric);
  });
}

void Gates::judge(QualityReport& report) const {
  report.gates.clear();
  for (const Metric& metric : quality_metrics()) {
    const auto gate = std::ranges::find(gates_, metric.key, &Gate::metric);
    if (gate == gates_.end()) continue;
    if (metric.is_conditional && !gate->named && report.find(metric.key) == nullptr) continue;
    GateResult result{gate->metric, gate->min, gate->max, std::nullopt, true};
    if (gate->leg && report.leg) {
      const double size = *report.leg / *gate->leg;
      if (result.min) *result.min *= size;
      if (result.max) *result.max *= size;
    }
    if (const MetricValue* found = report.find(metric.key)) {
      result.value = found->value;
      // Both comparisons are false for NaN, which therefore misses the gate.
      result.passed = (!result.min || found->value >= *result.min) &&
                      (!result.max || found->value <= *result.max);
    } else {
      const bool is_lost = report.lost_stances && metric.key.starts_with("stance_");
      result.passed = !(gate->named || is_lost) || metric.is_conditional;
    }
    report.gates.push_back(result);
  }
}

}  // namespace retarget
