#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/report.h"

namespace RETARGET_API retarget {

/// A term of a TrackingPredictor: coefficient * (x - middle) / spread, where x is the value of a
/// metric, clipped to [least, most], after `roots` square roots.
struct PredictorFigure {
  std::string metric;  ///< Key of the metric.
  bool p95 = false;    ///< Whether to use its 95th percentile instead of its mean.
  int roots = 0;       ///< Number of successive square roots, 0 to 4.
  double least = 0.0, most = 0.0;
  double middle = 0.0, spread = 1.0;
  double coefficient = 0.0;
};

/// A bin of the predictor's calibration curve on held-out clips.
struct CalibrationBin {
  double predicted = 0.0;  ///< Mean predicted probability.
  double observed = 0.0;   ///< Share of windows that were tracked without a fall.
  int windows = 0;
};

/// A logistic model of the probability that the controller of simulate() tracks a window of a
/// motion without a fall. Its inputs are metrics of the motion's quality report
/// (docs/certificate.md).
struct TrackingPredictor {
  double window_s = 10.0;  ///< Length of a window, seconds.
  double intercept = 0.0;
  std::vector<PredictorFigure> figures;
  std::vector<CalibrationBin> calibration;
  double auc = 0.0;  ///< Area under the ROC curve on held-out clips.

  /// The predicted probability; empty if the report lacks a metric.
  [[nodiscard]] std::optional<double> probability(const QualityReport& report) const;
};

/// Parses a predictor. Errors (kConfig): all invalid members at once.
/// @param file  file name for messages.
[[nodiscard]] Result<TrackingPredictor> parse_tracking_predictor(std::string_view text,
                                                                 const std::string& file);

/// File of the shipped predictor: configs/quality/tracking_predictor.json.
[[nodiscard]] std::string tracking_predictor_file(const std::string& data_folder);

}  // namespace retarget
