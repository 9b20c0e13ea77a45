// The predictor against the logistic function, and invalid files.

#include "retarget/tracking_predictor.h"
#include "support/value_of.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace retarget {
namespace {

constexpr const char* kText = R"({
  "window_s": 10, "intercept": 0.5, "auc": 0.9,
  "figures": [
    {"metric": "dynamics_bad_pct", "roots": 2, "least": 0, "most": 64, "middle": 2, "spread": 4,
     "coefficient": -1.5},
    {"metric": "unexplained_force_pct", "p95": true, "least": 0, "most": 50, "middle": 1,
     "spread": 10, "coefficient": -2}
  ],
  "calibration": [{"predicted": 0.1, "observed": 0.2, "windows": 30}]
})";

QualityReport report_with(double bad, double force) {
  QualityReport report;
  report.values = {{find_metric("dynamics_bad_pct"), bad, std::nullopt},
                   {find_metric("unexplained_force_pct"), 0.0, force}};
  return report;
}

double logistic(double x) {
  return 1.0 / (1.0 + std::exp(-x));
}

TEST(TrackingPredictor, IsLogistic) {
  const auto predictor = value_of(parse_tracking_predictor(kText, "p.json"));
  EXPECT_EQ(predictor.calibration.size(), 1U);
  for (const double bad : {0.0, 9.0, 25.0, 64.0}) {
    for (const double force : {0.0, 3.0, 50.0}) {
      const double z =
          0.5 - 1.5 * (std::sqrt(std::sqrt(bad)) - 2.0) / 4.0 - 2.0 * (force - 1.0) / 10.0;
      const auto is = predictor.probability(report_with(bad, force)).value();
      EXPECT_NEAR(is, logistic(z), 1e-12);
    }
  }
  // Beyond the range the value at its end applies.
  EXPECT_EQ(predictor.probability(report_with(100.0, 90.0)),
            predictor.probability(report_with(64.0, 50.0)));
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(predictor.probability(report_with(none, none)),
            predictor.probability(report_with(64.0, 50.0)));
  EXPECT_FALSE(predictor.probability(QualityReport{}));
}

TEST(TrackingPredictor, RejectsInvalidFiles) {
  EXPECT_FALSE(parse_tracking_predictor("[]", "p.json"));
  EXPECT_FALSE(parse_tracking_predictor("{", "p.json"));
  std::string text = kText;
  text.replace(text.find("dynamics_bad_pct"), 16, "dynamics_bad_pcx");
  const auto unknown = parse_tracking_predictor(text, "p.json");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().details.size(), 1U);
  text = kText;
  text.replace(text.find("\"spread\": 4"), 11, "\"spread\": 0");
  EXPECT_FALSE(parse_tracking_predictor(text, "p.json"));
  for (const char* roots : {"5", "-1", "true", "1e300"}) {
    text = kText;
    text.replace(text.find("\"roots\": 2"), 10, std::string("\"roots\": ") + roots);
    EXPECT_FALSE(parse_tracking_predictor(text, "p.json")) << roots;
  }
}

}  // namespace
}  // namespace retarget
