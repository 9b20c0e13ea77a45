#include "batch/data_set.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "batch/batch_report.h"
#include "batch/batch_runner.h"
#include "batch/certify_clip.h"
#include "batch/duplicates.h"
#include "retarget/file.h"
#include "retarget/measure.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Searches original clips only: a mirror image or variation created by the batch is left out with its original.
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

// Names with line ends would break a list.
bool fits_line(const std::string& name) {
  return name.find_first_of("\r\n") == std::string::npos;
}

std::string cell_of(const std::string& text) {
  std::string cell;
  // Prevent spreadsheets from interpreting the cell as a formula.
  if (!text.empty() && std::string_view("=+-@").find(text.front()) != std::string_view::npos) {
    cell = "'";
  }
  for (const char c : text) cell += c == '\t' || c == '\r' || c == '\n' ? ' ' : c;
  return cell;
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

namespace {

// A sorted list of files, one per line.
class FileList {
 public:
  void add(const ManifestEntry& entry) {
    for (const std::string& file : motions_of(entry)) {
      if (fits_line(file)) {
        files_.insert(file);
      } else {
        ++left_out_;
      }
    }
  }
  [[nodiscard]] std::string text() const {
    std::string text;
    for (const std::string& file : files_) text += file + "\n";
    return text;
  }
  [[nodiscard]] std::size_t left_out() const { return left_out_; }

 private:
  std::set<std::string> files_;
  std::size_t left_out_ = 0;
};

// A set with the name of its list and its purpose for messages.
struct SplitList {
  SplitSide side;
  const char* file;
  const char* purpose;
};
constexpr std::array kSplitLists = {
    SplitList{SplitSide::kTrain, "train.txt", "training"},
    SplitList{SplitSide::kValidation, "validation.txt", "validation"},
    SplitList{SplitSide::kTest, "test.txt", "testing"}};

void warn_of_old_list(const std::string& path, Observer& observer) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return;
  observer.warn({{0, 0,
                  "this list is from an earlier call and was not updated; " RETARGET_OPTION(
                      "split") " updates it"}},
                path);
}

std::string rule_text(const SplitGroups& groups) {
  std::string rule = groups.by_subject == 0 ? "no file name identifies a subject: "
                                            : count_text(groups.by_subject, "group") +
                                                  " by the subject in the file names";
  if (groups.by_file > 0) {
    rule += (groups.by_subject == 0 ? "" : ", ") + count_text(groups.by_file, "group") + " by file";
  }
  if (groups.joined > 0) {
    rule += fmt::format("; {} joined with others that have the same input or its mirror image",
                        count_text(groups.joined, "group"));
  }
  return rule;
}

// Without signatures, mirror images under other names are not recognised.
void note_unsigned(const std::vector<const ManifestEntry*>& passed, Observer& observer) {
  const auto count = std::ranges::count_if(passed, [](const ManifestEntry* entry) {
    return !entry->variant.is_derived() && entry->signature.empty();
  });
  if (count == 0) return;
  observer.line("", "mirror images of " + count_text(count, "clip") +
                        " are identified only by their names; " RETARGET_OPTION(
                            "resume") " with " RETARGET_OPTION("split") " compares the motions");
}

Result<void> write_split(const std::string& folder, const std::vector<const ManifestEntry*>& passed,
                         const Split& split, Observer& observer) {
  const SplitGroups groups = split_groups(passed);
  RETARGET_TRY_ASSIGN(const std::vector<SplitSide> sides, split_clips(groups.keys, split));
  std::string text;
  for (const SplitList& list : kSplitLists) {
    const std::string path = folder + "/" + list.file;
    if (list.side == SplitSide::kTest && split.test <= 0.0) {
      warn_of_old_list(path, observer);
      continue;
    }
    FileList files;
    std::set<std::string_view> keys;
    std::size_t clips = 0;
    for (std::size_t i = 0; i < passed.size(); ++i) {
      if (sides[i] != list.side) continue;
      files.add(*passed[i]);
      keys.insert(groups.keys[i]);
      ++clips;
    }
    RETARGET_TRY(write_file(path, files.text()));
    text += fmt::format("{}{} of {} for {}", text.empty() ? "" : ", ", count_text(clips, "clip"),
                        count_text(keys.size(), "group"), list.purpose);
  }
  observer.line("split", text);
  if (passed.empty()) return {};
  observer.line("", rule_text(groups));
  note_unsigned(passed, observer);
  return {};
}

// Warns of lists from an earlier call that this call does not update.
void warn_of_old_lists(const std::string& folder, Observer& observer) {
  for (const SplitList& list : kSplitLists) warn_of_old_list(folder + "/" + list.file, observer);
}

}  // namespace

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
  const ClipQuality judged = clip_quality(report);
  quality.missed = judged.missed;
  quality.missed_gates = judged.missed_gates;
  quality.worst = judged.worst;
  quality.worst_ratio = judged.worst_ratio;
}

void judge_entries(std::vector<ManifestEntry>& entries, const DataSetRules& rules,
                   const std::set<std::string>* asked) {
  for (ManifestEntry& entry : entries) {
    if (rules.gates && entry.quality) judge_quality(*rules.gates, *entry.quality);
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

Result<void> write_lists(const std::string& folder, const std::vector<ManifestEntry>& entries,
                         const DataSetRules& rules, Observer& observer) {
  FileList passed_files;
  std::vector<const ManifestEntry*> passed;
  std::string failed = "file\treason\trobot\n", repeated = "file\tof\tkind\tdistance_deg\trobot\n";
  std::size_t missing = 0, repeating = 0, failing = 0;
  for (const ManifestEntry& entry : entries) {
    if (has_passed(entry)) {
      passed_files.add(entry);
      passed.push_back(&entry);
    } else if (entry.repeated) {
      ++repeating;
      repeated +=
          fmt::format("{}\t{}\t{}\t{:.2f}\t{}\n", cell_of(entry.relative),
                      cell_of(entry.repeated->of), entry.repeated->mirrored ? "mirrored" : "same",
                      entry.repeated->distance, cell_of(entry.robot));
    } else {
      ++(entry.done ? missing : failing);
      failed += fmt::format("{}\t{}\t{}\n", cell_of(entry.relative), cell_of(reason_of(entry)),
                            cell_of(entry.robot));
    }
  }
  RETARGET_TRY(write_file(folder + "/passed.txt", passed_files.text()));
  RETARGET_TRY(write_file(folder + "/failed.tsv", failed));
  std::error_code ignored;
  const bool earlier = fs::exists(folder + "/duplicates.tsv", ignored);
  if (rules.dedupe == true || repeating > 0 || earlier) {
    RETARGET_TRY(write_file(folder + "/duplicates.tsv", repeated));
  }
  if (passed_files.left_out() > 0) {
    observer.warn({{0, 0,
                    count_text(passed_files.left_out(), "file") +
                        " with a line break in the name cannot be listed and is skipped"}},
                  folder + "/passed.txt");
  }
  std::string text = fmt::format("{} of {} in {}/passed.txt", passed.size(),
                                 count_text(entries.size(), "clip"), folder);
  if (missing > 0) text += fmt::format("; {} {} a gate", missing, missing == 1 ? "misses" : "miss");
  if (failing > 0) text += fmt::format("; {} failed", failing);
  if (repeating > 0) {
    text += fmt::format("; {} {}, see duplicates.tsv", repeating,
                        repeating == 1 ? "repeats another" : "repeat others");
  }
  observer.line("passed", text);
  if (!rules.split) {
    warn_of_old_lists(folder, observer);
    return {};
  }
  return write_split(folder, passed, *rules.split, observer);
}

}  // namespace retarget
