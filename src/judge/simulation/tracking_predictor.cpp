#include "retarget/tracking_predictor.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/json.h"
#include "base/try.h"
#include "retarget/json.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMostRoots = 4;

// exp(x) with the same result on every machine: the power series for x / 1024, squared ten times.
double portable_exp(double x) {
  constexpr int kHalvings = 10, kTerms = 9;
  const double small = std::clamp(x, -500.0, 500.0) / (1 << kHalvings);
  double sum = 1.0;
  for (int n = kTerms; n > 0; --n) sum = 1.0 + sum * small / n;
  for (int i = 0; i < kHalvings; ++i) sum *= sum;
  return sum;
}

std::optional<double> value_of(const QualityReport& report, const PredictorFigure& figure) {
  const MetricValue* const found = report.find(figure.metric);
  if (found == nullptr || (figure.p95 && !found->p95)) return std::nullopt;
  return figure.p95 ? *found->p95 : found->value;
}

double number(const Json& json, const char* key, std::vector<std::string>& faults) {
  const auto found = json.find(key);
  const auto value = found == json.end() ? std::nullopt : value_from<double>(*found);
  if (!value) faults.push_back(std::string("\"") + key + "\": expected a number");
  return value.value_or(0.0);
}

bool flag(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_boolean() && found->get<bool>();
}

PredictorFigure figure_from(const Json& json, std::vector<std::string>& faults) {
  PredictorFigure figure;
  if (!json.is_object()) {
    faults.emplace_back("\"figures\": expected objects");
    return figure;
  }
  const auto metric = json.find("metric");
  if (metric != json.end() && metric->is_string()) figure.metric = metric->get<std::string>();
  if (find_metric(figure.metric) == nullptr) {
    faults.push_back("\"metric\": unknown metric \"" + figure.metric + "\"");
  }
  figure.p95 = flag(json, "p95");
  if (json.contains("roots")) {
    const double roots = number(json, "roots", faults);
    if (!(roots >= 0.0 && roots <= kMostRoots)) {
      faults.emplace_back("\"roots\": expected a number from 0 to 4");
    } else {
      figure.roots = static_cast<int>(roots);
    }
  }
  figure.least = number(json, "least", faults);
  figure.most = number(json, "most", faults);
  figure.middle = number(json, "middle", faults);
  figure.spread = number(json, "spread", faults);
  figure.coefficient = number(json, "coefficient", faults);
  if (!(figure.spread > 0.0)) faults.emplace_back("\"spread\": expected a number above 0");
  if (figure.most < figure.least || (figure.roots > 0 && figure.least < 0.0)) {
    faults.emplace_back("\"least\", \"most\": expected a range, not negative for a root");
  }
  return figure;
}

}  // namespace

std::optional<double> TrackingPredictor::probability(const QualityReport& report) const {
  double sum = intercept;
  for (const PredictorFigure& figure : figures) {
    const std::optional<double> value = value_of(report, figure);
    if (!value) return std::nullopt;
    // Replaces a value that is not finite by the end of the range with the lower probability.
    const double worst = figure.coefficient < 0.0 ? figure.most : figure.least;
    double x = std::isfinite(*value) ? std::clamp(*value, figure.least, figure.most) : worst;
    for (int i = 0; i < figure.roots; ++i) x = std::sqrt(x);
    sum += figure.coefficient * (x - figure.middle) / figure.spread;
  }
  return 1.0 / (1.0 + portable_exp(-sum));
}

Result<TrackingPredictor> parse_tracking_predictor(std::string_view text, const std::string& file) {
  TRY_ASSIGN(const Json json, parse_json(text, file));
  TrackingPredictor predictor;
  std::vector<std::string> faults;
  const auto list = [&](const char* key) {
    const auto found = json.is_object() ? json.find(key) : json.end();
    if (json.is_object() && found != json.end() && found->is_array()) return *found;
    faults.push_back(std::string("\"") + key + "\": expected a list");
    return Json(Json::array());
  };
  for (const Json& each : list("figures")) predictor.figures.push_back(figure_from(each, faults));
  for (const Json& each : list("calibration")) {
    if (!each.is_object()) continue;
    predictor.calibration.push_back({number(each, "predicted", faults),
                                     number(each, "observed", faults),
                                     static_cast<int>(number(each, "windows", faults))});
  }
  if (json.is_object()) {
    predictor.intercept = number(json, "intercept", faults);
    predictor.window_s = number(json, "window_s", faults);
    predictor.auc = number(json, "auc", faults);
    if (!(predictor.window_s >= 1.0)) faults.emplace_back("\"window_s\": expected at least 1");
  }
  if (faults.empty()) return predictor;
  Error error;
  error.kind = ErrorKind::kConfig;
  error.location.file = file;
  error.message = "the predictor is not valid";
  error.details = std::move(faults);
  return failure(std::move(error));
}

std::string tracking_predictor_file(const std::string& data_folder) {
  return (std::filesystem::path(data_folder) / "configs" / "quality" / "tracking_predictor.json")
      .string();
}

}  // namespace retarget
