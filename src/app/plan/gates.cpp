#include "retarget/measure.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <string_view>
#include <system_error>

#include "base/option_name.h"
#include "base/try.h"
#include "retarget/file.h"
#include "retarget/option_table.h"
#include "retarget/text.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// The parts of `METRIC<=NUMBER`.
struct GateText {
  std::string figure, relation, bound;
};

GateText split_gate(const std::string& text) {
  const std::size_t at = text.find_first_of("<>=");
  if (at == std::string::npos) return {text, {}, {}};
  const std::size_t length = text.find_first_not_of("<>=", at) - at;
  const std::string relation = text.substr(at, length);
  return {text.substr(0, at), relation, text.substr(at + relation.size())};
}

// The key without its suffix after the last `_`, a unit or a kind.
std::string_view short_key(std::string_view key) {
  return key.substr(0, key.rfind('_'));
}

// Finds a metric by its key or short key; of several matches, prefers the one with a gate.
Result<std::string> figure_of(const std::string& name, const Gates& gates) {
  if (find_metric(name) != nullptr) return name;
  std::vector<std::string> meant, with_gate;
  for (const Metric& metric : quality_metrics()) {
    if (short_key(metric.key) != name) continue;
    meant.emplace_back(metric.key);
    if (std::ranges::find(gates.all(), metric.key, &Gate::metric) != gates.all().end()) {
      with_gate.emplace_back(metric.key);
    }
  }
  if (meant.size() == 1) return meant.front();
  if (with_gate.size() == 1) return with_gate.front();
  if (!meant.empty()) {
    return usage_failure(
        fmt::format(OPTION("gate") ": \"{}\" is ambiguous: {}", name, list_names(meant)),
        "give the full name");
  }
  std::vector<std::string> known = metric_keys();
  for (const Metric& metric : quality_metrics()) known.emplace_back(short_key(metric.key));
  return usage_failure(
      fmt::format(OPTION("gate") ": unknown metric \"{}\"{}", name, did_you_mean(name, known)),
      "give a metric of the report, such as jumps<=0, or a gate file");
}

class GateChanges {
 public:
  explicit GateChanges(Gates gates) : gates_(std::move(gates)), defaults_(gates_) {}

  Result<void> take(const std::string& text) {
    std::error_code ignored;
    if (text == "default") return {};
    if (text == "none") {
      gates_.clear();
      return {};
    }
    const GateText gate = split_gate(text);
    if (gate.relation.empty() || fs::exists(text, ignored)) return take_file(text);
    return take_gate(gate);
  }

  [[nodiscard]] Gates result() && { return std::move(gates_); }

 private:
  Result<void> take_file(const std::string& text) {
    // A metric without a bound is not a missing file.
    if (!is_file(text) && (find_metric(text) != nullptr)) {
      return usage_failure(OPTION("gate") " " + text + " needs a bound",
                           "as in " + text + "<=0, in quotes");
    }
    TRY(gates_.add_file(text));
    given_.clear();
    return {};
  }

  Result<void> take_gate(const GateText& text) {
    TRY_ASSIGN(std::string figure, figure_of(text.figure, defaults_));
    Gate gate{figure, std::nullopt, std::nullopt};
    const bool is_none = text.relation == "=" && text.bound == "none";
    auto bound = parse_number<double>(text.bound);
    // A comparison with NaN never fails.
    if (bound && !std::isfinite(*bound)) bound.reset();
    const bool known = text.relation == "=" || text.relation == "<=" || text.relation == ">=";
    if (!known) {
      return usage_failure(
          fmt::format(OPTION("gate") " {}: invalid relation \"{}\"", figure, text.relation),
          "use <=, >= or =");
    }
    if (!bound && !is_none) {
      return usage_failure(fmt::format(OPTION("gate") " {}{} must be followed by a number{}, "
                                                      "found \"{}\"",
                                       figure, text.relation,
                                       text.relation == "=" ? " or none" : "", text.bound));
    }
    const auto before = std::ranges::find(gates_.all(), figure, &Gate::metric);
    // All bounds that texts set apply, so the stricter of two decides.
    if (!is_none && given_.contains(figure) && before != gates_.all().end()) gate = *before;
    if (text.relation == ">=") {
      gate.min = std::max(*bound, gate.min.value_or(*bound));
    } else if (!is_none) {
      gate.max = std::min(*bound, gate.max.value_or(*bound));
    }
    gate.named = true;
    gates_.set(std::move(gate));
    given_.insert(std::move(figure));
    return {};
  }

  Gates gates_;
  const Gates defaults_;
  std::set<std::string> given_;  // Metrics whose gates were set individually.
};

}  // namespace

Result<Gates> default_gates(const std::string& data_folder) {
  Gates gates;
  TRY(gates.add_file((fs::path(data_folder) / "configs" / "quality" / "default.json").string()));
  return gates;
}

Result<Gates> changed_gates(const std::vector<std::string>& texts, const std::string& data_folder) {
  TRY_ASSIGN(Gates defaults, default_gates(data_folder));
  GateChanges changes(std::move(defaults));
  for (const std::string& text : texts) TRY(changes.take(text));
  return std::move(changes).result();
}

Option gate_row(std::vector<std::string>& texts, const std::string& help) {
  return option("gate", texts, kOutputGroup, "FILE|METRIC<=N", help,
                {.decides = false, .basic = true});
}

}  // namespace retarget
