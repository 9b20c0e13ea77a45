#include "retarget/batch.h"

#include <string>
#include <utility>

#include "retarget/measure.h"
#include "retarget/option_table.h"

namespace retarget {
namespace {

Option batch_row(const char* name, auto& member, const char* group, const char* type,
                 const char* help, OptionInfo info = {}) {
  info.decides = false;
  return option(name, member, group, type, help, std::move(info));
}

}  // namespace

OptionTable batch_table(BatchRequest& request, Run& run) {
  return {
      batch_row("list", request.lists, kInputGroup, "FILE",
                "File that lists files and folders, one per line; - reads standard input"),
      batch_row(
          "relative-to", request.relative_to, kInputGroup, "DIR",
          "Individually given files keep their path below this folder (default: only their names)"),
      batch_row("exclude", request.exclude, kInputGroup, "PATTERN",
                "Exclude files whose name, or path below the given folder, matches; repeatable"),
      batch_row("clips", request.clips, kInputGroup, "FILE",
                "Process only the intervals listed in a table: file,start,end,name; 12.3 means "
                "seconds, f120 a frame"),
      batch_row("mirror", request.mirror, kInputGroup, "",
                "Also retarget the mirror image of each clip, NAME_mirrored"),
      batch_row("variants", request.variants, kInputGroup, "N",
                "Also retarget each clip in N changed scenes, NAME_v1, ...: with changed sizes of "
                "terrain and objects and changed object positions (docs/batch.md)",
                {.min = 0, .max = 1000}),
      batch_row("seed", request.seed, kInputGroup, "S", "Random seed of the scene changes",
                {.min = 0, .max = 1e9}),
      batch_row("dedupe", request.dedupe, kInputGroup, "",
                "Skip clips with the same motion as another clip, or its mirror image"),
      batch_row("robot", request.robots, kRobotGroup, "NAME,...",
                "Robots by name or folder; with several robots, each has its own output folder",
                {.basic = true}),
      batch_row("output", request.output, kOutputGroup, "DIR",
                "Output folder; created if it does not exist",
                {.basic = true, .letter = "o", .required = true}),
      gate_row(request.gates,
               std::string(kGateHelp) + ". Determines passed.txt; a missed gate is not a failure"),
      batch_row("split", request.split, kOutputGroup, "SHARES:SEED",
                "Split the passed motions into train.txt, validation.txt and, with three shares, "
                "test.txt, with all motions of a person in one subset: 0.9:1 or 0.8,0.1,0.1:1"),
      batch_row("jobs", request.jobs, kBatchGroup, "N",
                "Number of clips to process in parallel (default: one per processor)",
                {.min = 1.0, .max = 4096.0, .basic = true, .letter = "j"}),
      batch_row("memory", run.options.source.memory_gb, kBatchGroup, "GB",
                "Memory limit for all running clips together, GB; clips wait until enough memory "
                "is free (default: three quarters of the available memory)",
                {.min = 0.001, .max = 1e6}),
      batch_row("clip-timeout", request.clip_timeout_s, kBatchGroup, "SECONDS",
                "Time limit per clip; a clip that exceeds it fails, the others continue (default: "
                "no limit)",
                {.min = 0.001, .max = 1e9}),
      batch_row("resume", request.resume, kBatchGroup, "",
                "Continue a batch: skip clips that are done and unchanged", {.basic = true}),
      batch_row("redo", request.redo, kBatchGroup, "",
                "Discard an earlier batch in the folder and process all clips again"),
      batch_row(
          "certify", request.certify, kOutputGroup, "",
          "Also measure and simulate every motion and predict its tracking success: "
          "MOTION.certificate.json; gates on tracked_pct and predicted_tracking_success can use "
          "these results (docs/batch.md)"),
      batch_row("contacts", request.contacts, kOutputGroup, "",
                "Also write heel and toe contacts next to every motion: CLIP.contacts.csv"),
      batch_row("motion-list", request.motion_list, kOutputGroup, "",
                "Write motions.yaml, which lists the pickles or .motion files of all clips with "
                "weights, for TWIST2, GMT, MimicKit and ProtoMotions"),
      batch_row("pack", request.pack, kOutputGroup, "NAME.npz",
                "Also write one NPZ with all passed motions concatenated, with clip names, starts "
                "and lengths (docs/formats.md)"),
      batch_row("shard", request.shard, kBatchGroup, "I/N",
                "Process one of N shards of similar length, I from 1 to N, with its own manifest")};
}

}  // namespace retarget
