#include "batch/data_set.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "batch/batch_report.h"
#include "batch/batch_runner.h"
#include "batch/certify_clip.h"
#include "batch/duplicates.h"
#include "retarget/measure.h"
#include "retarget/option_name.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Searches original clips only: a mirror image or variation created by the batch is left out with
// its original.
void find_repetitions(std::vector<ManifestEntry>& entries, const std::set<std::string>* asked) {
  const auto counts = [asked](const ManifestEntry& entry) {
    return asked == nullptr || asked->contains(entry.relative);
  };
  std::vector<std::pair<std::string, std::string>> clips;
  for (const ManifestEntry& entry : entries) {
    if (counts(entry) && !entry.has_failed() && !entry.variant.is_derived()) {
      clips.emplace_back(entry.relative, entry.signature);
    }
  }
  const auto repeated = repeated_clips(clips);
  for (ManifestEntry& entry : entries) {
    if (!counts(entry)) continue;
    const bool is_derived = entry.variant.is_derived();
    const auto of = repeated.find(is_derived ? entry.variant.original() : entry.relative);
    if (of != repeated.end()) {
      entry.repeated = of->second;
      if (entry.variant.is_mirrored()) entry.repeated->mirrored = !entry.repeated->mirrored;
    } else if (entry.done) {
      entry.repeated.reset();
    }
  }
}

// The output itself, or its folder if the motion is a folder.
std::string file_or_folder(const ManifestEntry& entry, const std::string& output) {
  const fs::path path(output);
  const std::string folder = path.parent_path().generic_string();
  const std::string stem = output_stem(entry.relative);
  // Files of the clip itself, also in the folder of a robot with the same name.
  if (path.filename().string().starts_with(fs::path(stem).filename().string() + ".")) return output;
  const auto is_motion = [&](std::string_view name) {
    return name == stem || name.starts_with(stem + ".");
  };
  const std::string apart = entry.robot + "/";
  const bool is_member =
      is_motion(folder) || (folder.starts_with(apart) && is_motion(folder.substr(apart.size())));
  return is_member ? folder : output;
}

}  // namespace

std::vector<std::string> motions_of(const ManifestEntry& entry) {
  std::set<std::string> outputs;
  for (const FileRecord& output : entry.outputs) {
    outputs.insert(file_or_folder(entry, output.file));
  }
  const std::string contacts = contacts_output(entry.relative);
  const auto is_about = [&](const std::string& output, std::string_view ending) {
    return output.ends_with(ending) &&
           outputs.contains(output.substr(0, output.size() - ending.size()));
  };
  std::vector<std::string> motions;
  for (const std::string& output : outputs) {
    const bool is_contacts = output == contacts || output == entry.robot + "/" + contacts;
    if (is_contacts || is_about(output, ".json") || is_about(output, ".certificate.json")) continue;
    motions.push_back(output);
  }
  return motions;
}

Result<DataSetRules> data_set_rules(const BatchRequest& request, bool merging) {
  DataSetRules rules;
  if (!request.gates.empty() && !request.quality) {
    return usage_failure(
        RETARGET_OPTION("gate") " and " RETARGET_OPTION("no-quality") " cannot be combined",
        "gates need measured metrics");
  }
  if (request.of_clip.dynamics && !request.quality) {
    return usage_failure(
        RETARGET_OPTION("dynamics") " and " RETARGET_OPTION("no-quality") " cannot be combined",
        "without " RETARGET_OPTION("no-quality") " the metrics are measured");
  }
  if (!merging || !request.gates.empty()) {
    RETARGET_TRY_ASSIGN(rules.gates, changed_gates(request.gates, request.data_folder));
    RETARGET_TRY(check_certified_gates(*rules.gates, merging || request.certify));
  }
  if (!merging || request.dedupe) rules.dedupe = request.dedupe;
  rules.check_files = merging;
  if (!request.split.empty()) {
    RETARGET_TRY_ASSIGN(rules.split, parse_split(request.split));
  }
  return rules;
}

void judge_quality(const Gates& gates, ClipQuality& quality) {
  QualityReport report;
  report.leg = quality.leg;
  for (const auto& [key, value] : quality.figures) {
    if (const Metric* metric = find_metric(key)) report.values.push_back({metric, value, {}});
  }
  gates.judge(report);
  for (const Gate& gate : gates.all()) {
    const bool missing = is_certified_figure(gate.metric) && report.find(gate.metric) == nullptr;
    if (missing) report.gates.push_back({gate.metric, gate.min, gate.max, std::nullopt, false});
  }
  ClipQuality judged = clip_quality(report);
  judged.figures = std::move(quality.figures);
  quality = std::move(judged);
}

namespace {

// A clip that was not measured has no value for any gate.
void judge_entry(const Gates& gates, ManifestEntry& entry) {
  if (entry.quality) {
    judge_quality(gates, *entry.quality);
  } else if (entry.done) {
    ClipQuality unknown;
    judge_quality(gates, unknown);
    if (!unknown.missed.empty()) entry.quality = std::move(unknown);
  }
}

}  // namespace

void judge_entries(std::vector<ManifestEntry>& entries, const DataSetRules& rules,
                   const std::set<std::string>* asked) {
  for (ManifestEntry& entry : entries) {
    if (rules.gates) judge_entry(*rules.gates, entry);
    if (rules.dedupe == false && entry.done) entry.repeated.reset();
  }
  if (rules.dedupe == true) find_repetitions(entries, asked);
}

bool has_passed(const ManifestEntry& entry) {
  return entry.done && !entry.repeated && (!entry.quality || entry.quality->missed.empty());
}

std::string reason_of(const ManifestEntry& entry) {
  if (entry.error) {
    return describe({entry.error->kind, entry.error->location, entry.error->message, {}, {}});
  }
  if (!entry.quality) return {};
  std::string reason;
  for (const std::string& metric : entry.quality->missed) {
    const auto gate = std::ranges::find(entry.quality->missed_gates, metric, &GateResult::metric);
    const bool known =
        gate != entry.quality->missed_gates.end() && (gate->value || !is_certified_figure(metric));
    const std::string text = is_certified_figure(metric) ? metric + " unknown" : metric;
    reason += (reason.empty() ? "" : "; ") + (known ? missed_text(*gate) : text);
  }
  return reason;
}

}  // namespace retarget
