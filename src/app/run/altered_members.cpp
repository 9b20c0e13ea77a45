// Compares the facts and metrics of two sidecars.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "app/run/sidecar.h"
#include "base/json.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

// Files may have moved, such as that of a limit set, so paths agree if their last parts do.
bool name_same_file(const std::string& a, const std::string& b) {
  return a == b || std::filesystem::path(a).filename() == std::filesystem::path(b).filename();
}

bool agree(const Json& a, const Json& b) {
  constexpr double kRelative = 1e-6, kAbsolute = 1e-9;
  if (a.is_number() && b.is_number()) {
    const double first = a.get<double>(), second = b.get<double>();
    const double size = std::max(std::abs(first), std::abs(second));
    return std::abs(first - second) <= kAbsolute + kRelative * size;
  }
  if (a.is_string() && b.is_string())
    return name_same_file(a.get<std::string>(), b.get<std::string>());
  if (a.size() != b.size()) return false;
  if (a.is_array() && b.is_array()) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (!agree(a[i], b[i])) return false;
    }
    return true;
  }
  if (!a.is_object() || !b.is_object()) return a == b;
  for (const auto& [key, value] : a.items()) {
    bool found = false;
    for (const auto& [other_key, other] : b.items()) {
      found = found || (name_same_file(key, other_key) && agree(value, other));
    }
    if (!found) return false;
  }
  return true;
}

// Whether a gate agrees with its bounds and with the mean of its metric.
bool is_sound(const Json& gate, const Json& report) {
  if (!gate.is_object()) return false;
  const Json value = gate.value("value", Json()), passed = gate.value("passed", Json());
  const Json metric = gate.value("metric", Json());
  if (!passed.is_boolean() || !metric.is_string()) return false;
  Json measured = report.value(metric.get<std::string>(), Json());
  if (measured.is_array() && !measured.empty()) measured = measured[0];
  if (!agree(value, measured)) return false;
  if (!value.is_number()) return true;  // The metric was not measured.
  const auto bound = [&](const char* key, double none) {
    const Json found = gate.value(key, Json());
    return found.is_number() ? found.get<double>() : none;
  };
  const double number = value.get<double>();
  const bool inside = number >= bound("min", -HUGE_VAL) && number <= bound("max", HUGE_VAL);
  return inside == passed.get<bool>();
}

bool has_sound_gates(const Json& report) {
  const Json gates = report.value("gates", Json()), passed = report.value("passed", Json());
  if (!gates.is_array() || !passed.is_boolean()) return false;
  const bool sound =
      std::ranges::all_of(gates, [&](const Json& gate) { return is_sound(gate, report); });
  return sound && passed == std::ranges::all_of(
                                gates, [](const Json& gate) { return gate["passed"].get<bool>(); });
}

// Appends the members that differ or that only one of the objects has.
void compare(const std::string& of, const Json& before, const Json& after,
             std::vector<std::string>& altered) {
  // Gates and faults depend on options of the command, and solver failures on the other formats of
  // the run. The hash of the configuration is among the inputs.
  constexpr std::array<std::string_view, 6> kOthers = {"file",    "gates",  "passed",
                                                       "mapping", "faults", "solver_failures"};
  std::set<std::string> keys;
  for (const auto& [key, value] : before.items()) keys.insert(key);
  for (const auto& [key, value] : after.items()) keys.insert(key);
  for (const std::string& key : keys) {
    if (std::ranges::count(kOthers, key) > 0) continue;
    const Json then = before.value(key, Json()), now = after.value(key, Json());
    if (!agree(then, now)) altered.push_back(of + "." + key);
  }
}

}  // namespace

std::optional<std::vector<std::string>> altered_members(std::string_view recorded,
                                                        std::string_view repeated) {
  const Json then = Json::parse(recorded, nullptr, false);
  const Json now = Json::parse(repeated, nullptr, false);
  if (!then.is_object() || !now.is_object()) return std::nullopt;
  if (then.value("build", Json()) != now.value("build", Json())) return std::nullopt;
  std::vector<std::string> altered;
  compare("found", object_at(then, "found"), object_at(now, "found"), altered);
  const Json report = report_in(then);
  compare("quality", report, report_in(now), altered);
  if (!has_sound_gates(report)) altered.emplace_back("quality.gates");
  return altered;
}

}  // namespace retarget
