#include "batch/batch_table.h"

#include <string>

#include "options/run_tables.h"
#include "plan/gates.h"

namespace retarget {
namespace {

Option batch_row(const char* name, auto& member, const char* group, const char* type,
                 const char* help, OptionInfo info = {}) {
  info.decides = false;
  return option(name, member, group, type, help, std::move(info));
}

}  // namespace

OptionTable batch_table(BatchRequest& request, double& memory_gb) {
  return {
      batch_row("list", request.lists, kInputGroup, "FILE",
                "File that lists files and folders, one per line; - reads standard input"),
      batch_row("base", request.base, kInputGroup, "DIR",
                "Files given one by one keep their path below this folder (default: only their "
                "names)"),
      batch_row("exclude", request.exclude, kInputGroup, "PATTERN",
                "Leave out files whose name, or path below its folder, matches; repeatable"),
      batch_row(
          "clips", request.clips, kInputGroup, "FILE",
          "Take only the parts that a table lists: file,start,end,name; 12.3 is seconds, f120 "
          "a frame"),
      batch_row("mirror", request.mirror, kInputGroup, "",
                "Also retarget the mirror image of each clip, NAME_mirrored"),
      batch_row("dedupe", request.dedupe, kInputGroup, "",
                "Leave out clips that show the same motion as another, or its mirror image"),
      batch_row("robot", request.robots, kRobotGroup, "NAME,...",
                "Robots by name or folder; each of several gets a folder of its own",
                {.basic = true}),
      batch_row("output", request.output, kOutputGroup, "DIR",
                "Output folder; created if it does not exist",
                {.basic = true, .letter = "o", .required = true}),
      gate_row(request.gates,
               std::string(kGateHelp) + ". Says what is in passed.txt; never fails a clip"),
      batch_row(
          "split", request.split, kOutputGroup, "RATIO:SEED",
          "Divide the motions that passed into train.txt and validation.txt, all of a person on "
          "one side: 0.9:1"),
      batch_row("jobs", request.jobs, kBatchGroup, "N",
                "Clips to process at once (default: one per processor)",
                {.min = 1.0, .max = 4096.0, .basic = true, .letter = "j"}),
      batch_row("memory", memory_gb, kBatchGroup, "GB",
                "Memory for all running clips together, GB: a clip waits for room, and none may "
                "take more (default: three quarters of what is available)",
                {.min = 0.001, .max = 1e6}),
      batch_row("clip-timeout", request.clip_timeout_s, kBatchGroup, "SECONDS",
                "A clip that takes longer fails; the others continue (default: no limit)",
                {.min = 0.001, .max = 1e9}),
      batch_row("resume", request.resume, kBatchGroup, "",
                "Continue a batch: skip clips that are done and unchanged", {.basic = true}),
      batch_row("redo", request.redo, kBatchGroup, "",
                "Discard an earlier batch in the folder and start over"),
      batch_row(
          "contacts", request.contacts, kOutputGroup, "",
          "Also write when heels and toes are planted, beside each motion: CLIP.contacts.csv"),
      batch_row("motion-list", request.motion_list, kOutputGroup, "",
                "Write motions.yaml, which lists the pickles or .motion files of all clips with "
                "weights, for TWIST2, GMT, MimicKit and ProtoMotions"),
      batch_row("pack", request.pack, kOutputGroup, "NAME.npz",
                "Also write one NPZ of all motions that passed, one after the other, with names, "
                "starts and lengths of the clips (docs/formats.md)"),
      batch_row("shard", request.shard, kBatchGroup, "I/N",
                "Do one of N parts of about the same length, I from 1 to N, with its own "
                "manifest")};
}

}  // namespace retarget
