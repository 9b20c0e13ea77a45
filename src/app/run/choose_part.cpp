#include "app/run/choose_part.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "base/option_name.h"
#include "retarget/file.h"
#include "retarget/fingerprint.h"
#include "retarget/option_table.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// An option as given on the command line.
std::string spelled(const Option& row) {
  std::string text = marked_option(row.name);
  if (!row.is_flag()) text += " " + to_text(row.get());
  return text;
}

// The part and the mirroring, as options; empty: the whole source as it is.
std::string shown_text(RecordedRun recorded) {
  PartOptions defaults;
  const OptionTable plain = part_table(defaults), rows = part_table(recorded.run.options.part);
  std::vector<std::string> given;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].name == "lead-in" || rows[i].get() == plain[i].get()) continue;
    given.push_back(spelled(rows[i]));
  }
  if (recorded.mirror) given.emplace_back(OPTION("mirror"));
  return list_names(given, given.size());
}

// Whether the recorded run read the same file, as far as this is known.
bool is_same_source(const RecordedRun& recorded, const std::string& source) {
  if (recorded.source_hash.empty() || !is_file(source)) return true;
  const auto hash = motion_hash(source);
  return hash && *hash == recorded.source_hash;
}

// Recorded options that affect the comparison and that the request leaves at their defaults.
std::vector<std::string> options_left_out(RecordedRun recorded, Run run) {
  Run defaults;
  const auto table = [](Run& of) {
    // These are chosen elsewhere, or belong to the robot and the rate of the motion.
    OptionTable rows =
        without(rows_for(OptionUse::kMeasure, run_table(of)),
                {"start", "end", "frames", "lead-in", "travel", "time-scale", "fps", "robot",
                 "robot-xml", "robot-profile", "dof", "from-robot", "memory", "limits"});
    std::erase_if(rows, [](const Option& row) { return !row.info.decides; });
    return rows;
  };
  const OptionTable plain = table(defaults), given = table(run), then = table(recorded.run);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < then.size(); ++i) {
    const std::string unset = to_text(plain[i].get());
    if (to_text(given[i].get()) != unset || to_text(then[i].get()) == unset) continue;
    names.push_back(spelled(then[i]));
  }
  return names;
}

void name_options_left_out(const std::string& motion, const RecordedRun& recorded, const Run& run,
                           Observer& observer) {
  const std::vector<std::string> names = options_left_out(recorded, run);
  if (names.empty()) return;
  observer.line("left out", list_names(names, names.size()) + ": recorded in the sidecar of " +
                                motion + ", but not given");
}

// Measuring always has limits: those given, or the robot's default ones.
void name_other_limits(const std::string& motion, const RecordedRun& recorded, const Run& run,
                       Observer& observer) {
  const auto name = [](const std::string& limits) {
    return std::filesystem::path(limits).filename();
  };
  const std::string& measured = run.options.solve.limits;
  if (recorded.limits.empty() || name(recorded.limits) == name(measured)) return;
  observer.line("limits", measured + "; the sidecar of " + motion + " records " + recorded.limits);
}

}  // namespace

bool has_part(const PartOptions& part) {
  return part.start_s >= 0.0 || part.end_s >= 0.0 || !part.frames.empty();
}

PartOptions without_part(const PartOptions& part) {
  PartOptions whole;
  whole.lead_in = part.lead_in;
  return whole;
}

RecordedMotions recorded_motions(const std::vector<std::string>& files) {
  RecordedMotions motions;
  for (const std::string& file : files) motions.push_back({file, recorded_run(file)});
  return motions;
}

void choose_part(const RecordedMotions& motions, Run& run, RunRequest& of_source,
                 Observer& observer) {
  if (motions.empty()) return;
  std::vector<std::string> shown;
  for (const auto& [file, recorded, part_start] : motions) {
    if (recorded) {
      name_options_left_out(file, *recorded, run, observer);
      name_other_limits(file, *recorded, run, observer);
    }
    shown.push_back(recorded ? shown_text(*recorded) : std::string());
  }
  if (has_part(run.options.part)) return;
  if (std::ranges::any_of(shown, [&](const std::string& each) { return each != shown.front(); })) {
    observer.warn({{0, 0,
                    "the sidecars of the motions record different parts of the source; it is used "
                    "as the options say"}},
                  motions.front().file);
    return;
  }
  if (shown.front().empty()) return;
  const auto& [file, first, part_start] = motions.front();
  if (!is_same_source(*first, run.motion)) {
    observer.warn({{0, 0,
                    "the sidecar records " + shown.front() +
                        " of another source, which is not applied to " + run.motion}},
                  file);
    return;
  }
  const PartOptions& part = first->run.options.part;
  run.options.part.start_s = part.start_s;
  run.options.part.end_s = part.end_s;
  run.options.part.frames = part.frames;
  of_source.mirror = of_source.mirror || first->mirror;
  observer.line("part", shown.front() + ", as the sidecar records it");
}

}  // namespace retarget
