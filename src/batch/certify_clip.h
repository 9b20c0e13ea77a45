#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "batch/manifest.h"
#include "retarget/error.h"
#include "retarget/fingerprint.h"
#include "retarget/options.h"
#include "retarget/report.h"
#include "retarget/run.h"

namespace retarget {

/// The output of a clip that its certificate is about: the first file that can be read as a robot
/// motion; null: none.
[[nodiscard]] const OutputItem* certified_item(const std::vector<OutputItem>& items);

/// Whether only certificates have this metric.
[[nodiscard]] bool is_certified_figure(std::string_view metric);

/// Checks that a batch can write certificates: it measures its motions, and one of its formats can
/// be read. Errors: kUsage.
[[nodiscard]] Result<void> check_certify(const SaveOptions& options, bool quality);

/// Checks that the batch makes certificates if gates use their metrics. Errors: kUsage.
[[nodiscard]] Result<void> check_certified_gates(const Gates& gates, bool certify);

/// A fingerprint that differs from that of a batch without certificates.
[[nodiscard]] Result<RunFingerprint> certified(const RunFingerprint& fingerprint);

/// Certifies the motion of a clip, writes the certificate next to it, and adds its metrics
/// (`tracked_pct`, `predicted_tracking_success`) to those of the clip.
/// @param run     the run that made the motion.
/// @param mirror  whether it mirrored the source.
/// @param gates   gates; see changed_gates().
/// @return the certificate's file.
/// Errors: those of certify() and write_file().
[[nodiscard]] Result<std::string> certify_clip(const Run& run, bool mirror,
                                               const std::vector<std::string>& gates,
                                               const std::string& motion,
                                               const std::string& data_folder,
                                               const Observer& observer, ClipQuality& quality);

}  // namespace retarget
