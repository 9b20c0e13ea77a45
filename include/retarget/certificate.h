#pragma once

#include <string>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/load.h"
#include "retarget/measure_files.h"
#include "retarget/report.h"
#include "retarget/run.h"

// Link retarget::batch.
namespace RETARGET_API retarget {

/// Metrics that only certificates have.
inline constexpr const char* kTrackedFigure = "tracked_pct";
inline constexpr const char* kPredictedFigure = "predicted_tracking_success";

/// A document with the metrics of a motion, its simulation and its predicted success
/// (docs/certificate.md; schema: docs/certificate.schema.json).
struct Certificate {
  std::string json;      ///< The document.
  QualityReport report;  ///< Report on the motion, judged by the gates.
  bool gates_passed = false;
  bool fell = false;           ///< Whether the simulated robot fell.
  double tracked_pct = 100.0;  ///< Share of the motion before the fall, %.
  /// Predicted probability that a controller tracks the motion; -1: unknown.
  double predicted_success = -1.0;

  /// Whether the motion passed its gates and the simulation.
  [[nodiscard]] bool passed() const { return gates_passed && !fell; }
};

/// Measures all metrics of a motion, simulates it, and predicts whether a controller can track it.
/// The gates of the request may also bound the metrics of the certificate.
/// @param request  names exactly one motion file; implies `dynamics`.
/// Errors: those of load_measures, measure_file and simulate; the motion is standard input
/// (kUsage).
[[nodiscard]] Result<Certificate> certify(const MeasureRequest& request, Observer& observer);

/// Name of the certificate of a motion file, in the same folder: `MOTION.certificate.json`.
[[nodiscard]] std::string certificate_file(const std::string& motion);

/// Whether a text looks like a certificate.
[[nodiscard]] bool is_certificate(std::string_view text);

/// Checks that a certificate's motion and inputs are unchanged, and that this version computes the
/// same values. Also finds files that moved together with the certificate.
/// @param text  the certificate.
/// @param file  file name of the certificate.
/// Errors: not a certificate (kInput); a file or a value differs (kRun), with its name.
[[nodiscard]] Result<void> verify_certificate(std::string_view text, const std::string& file,
                                              const DataFolder& data_folder, Observer& observer);

}  // namespace retarget
