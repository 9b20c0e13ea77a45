#include "batch/certify_clip.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "retarget/certificate.h"
#include "retarget/file.h"
#include "retarget/hash.h"
#include "retarget/json.h"
#include "retarget/measure_files.h"
#include "retarget/option_name.h"
#include "retarget/try.h"

namespace retarget {
namespace {

constexpr std::array<std::string_view, 2> kCertifiedFigures = {kTrackedFigure, kPredictedFigure};

bool is_readable_motion(MotionFormat format) {
  return format != MotionFormat::kGlb && !format_is_folder(format);
}

// Forwards only the request to stop, because the run of the clip has already printed its messages.
class CertifyObserver : public Observer {
 public:
  explicit CertifyObserver(const Observer& observer) : observer_(observer) {}
  [[nodiscard]] bool is_stopped() const override { return observer_.is_stopped(); }

 private:
  const Observer& observer_;
};

}  // namespace

const OutputItem* certified_item(const std::vector<OutputItem>& items) {
  const auto found = std::ranges::find_if(items, is_readable_motion, &OutputItem::format);
  return found == items.end() ? nullptr : &*found;
}

bool is_certified_figure(std::string_view metric) {
  return std::ranges::find(kCertifiedFigures, metric) != kCertifiedFigures.end();
}

Result<void> check_certify(const SaveOptions& options, bool quality) {
  if (!quality) {
    return usage_failure(
        RETARGET_OPTION("certify") " and " RETARGET_OPTION("no-quality") " cannot be combined",
        "certificates contain the metrics");
  }
  const std::vector<MotionFormat>& formats = options.formats;
  if (formats.empty() || std::ranges::any_of(formats, is_readable_motion)) return {};
  return usage_failure(
      RETARGET_OPTION("certify") " needs a format that can be read as a robot motion",
      "add one to " RETARGET_OPTION("format") ", such as csv");
}

Result<void> check_certified_gates(const Gates& gates, bool certify) {
  if (certify) return {};
  for (const Gate& gate : gates.all()) {
    if (!is_certified_figure(gate.metric)) continue;
    return usage_failure("the gate on " + gate.metric + " needs certificates",
                         "add " RETARGET_OPTION("certify"));
  }
  return {};
}

Result<RunFingerprint> certified(const RunFingerprint& fingerprint) {
  RETARGET_TRY_ASSIGN(auto json, parse_json(fingerprint.description, ""));
  RETARGET_TRY_ASSIGN(const std::string hash, hash_bytes(fingerprint.hash + " certified"));
  json["options_hash"] = hash;
  json["options"]["certify"] = true;
  return RunFingerprint{hash, json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace)};
}

Result<std::string> certify_clip(const Run& run, bool mirror, const std::vector<std::string>& gates,
                                 const std::string& motion, const std::string& data_folder,
                                 const Observer& observer, ClipQuality& quality) {
  MeasureRequest measure;
  measure.run = run;
  measure.run.output.clear();
  // Certificates do not depend on how files are written or on the memory that is left for a clip.
  measure.run.options.save = {};
  measure.run.options.source.memory_gb = SourceOptions{}.memory_gb;
  measure.of_source.mirror = mirror;
  measure.motions = {motion};
  measure.gates = gates;
  measure.data_folder = {data_folder};
  CertifyObserver quiet(observer);
  RETARGET_TRY_ASSIGN(const Certificate certificate, certify(measure, quiet));
  const std::string file = certificate_file(motion);
  RETARGET_TRY(write_file(file, certificate.json));
  quality.figures.emplace_back(kTrackedFigure, certificate.tracked_pct);
  if (certificate.predicted_success >= 0.0) {
    quality.figures.emplace_back(kPredictedFigure, certificate.predicted_success);
  }
  return file;
}

}  // namespace retarget
