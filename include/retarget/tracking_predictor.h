#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/report.h"

namespace RETARGET_API retarget {

/// A metric that a TrackingPredictor uses: clipped to [least, most], then `roots` times its square
/// root, then (x - middle) / spread, times `coefficient`.
struct PredictorFigure {
  std::string metric;  ///< Key of a metric.
  bool p95 = false;    ///< Its 95th percentile instead of its mean.
  int roots = 0;       ///< How often to take the square root, 0 to 4.
  double least = 0.0, most = 0.0;
  double middle = 0.0, spread = 1.0;
  double coefficient = 0.0;
};

/// A bin of a calibration curve, on clips that the predictor was not fitted on.
struct CalibrationBin {
  double predicted = 0.0;  ///< Mean predicted probability.
  double observed = 0.0;   ///< Share of windows that were tracked without a fall.
  int windows = 0;
};

/// A logistic model of the probability that the controller of simulate() tracks a window of a
/// motion without a fall, from the metrics of its quality report alone (docs/certificate.md).
struct TrackingPredictor {
  double window_s = 10.0;  ///< Length of a window, seconds.
  double intercept = 0.0;
  std::vector<PredictorFigure> figures;
  std::vector<CalibrationBin> calibration;
  double auc = 0.0;  ///< Area under the ROC curve, on clips that it was not fitted on.

  /// Computes the probability; empty if the report lacks a metric.
  [[nodiscard]] std::optional<double> probability(const QualityReport& report) const;
};

/// Parses a predictor. All faults are reported (kConfig).
/// @param file  for messages.
[[nodiscard]] Result<TrackingPredictor> parse_tracking_predictor(std::string_view text,
                                                                 const std::string& file);

/// File of the shipped predictor: configs/quality/tracking_predictor.json.
[[nodiscard]] std::string tracking_predictor_file(const std::string& data_folder);

}  // namespace retarget
