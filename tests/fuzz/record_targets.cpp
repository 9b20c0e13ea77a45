// Any bytes as what was written of a run: a line of a manifest, a sidecar, a plan.

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "base/json.h"
#include "base/plain_name.h"
#include "batch/manifest.h"
#include "fuzz/fuzz_target.h"
#include "retarget/plan.h"
#include "run/sidecar.h"

namespace retarget::fuzz {

void fuzz_manifest(std::string_view bytes) {
  const auto entry = parse_manifest_line(bytes);
  if (!entry) return;
  require(parse_manifest_line(manifest_line(*entry)).has_value(), "what is written is read again");
}

void fuzz_sidecar(std::string_view bytes) {
  const auto sidecar = read_sidecar(bytes, "fuzz.csv.json");
  if (!good(sidecar)) return;
  require(is_plain_name(sidecar->output), "outputs lie beside their sidecar");
}

void fuzz_plan(std::string_view bytes) {
  const std::string root(RETARGET_SOURCE_DIR);
  std::string text(bytes);
  // clip, robot and configuration are the repository's own; all else is the file's
  if (auto json = parse_json(bytes, "plan.json"); json && json->is_object()) {
    auto& run = (*json)["run"];
    if (run.is_object()) {
      run["motion"] = root + "/data/wave.bvh";
      run["robot"] = "unitree_g1";
      run.erase("robot-xml");
      run.erase("robot-profile");
    }
    (*json)["mapping"] = root + "/robots/unitree_g1/ik.json";
    text = printable_dump(*json);
  }
  const auto plan = load_plan(file_of(text, "plan.json"), {root, {}});
  if (!good(plan)) return;
  require(plan->part.begin >= 0 && plan->part.begin < plan->part.end &&
              plan->part.end <= plan->clip->frame_count(),
          "the part lies in the clip");
  require(plan->frame_count() > 0, "a motion is left");
  for (const Bone bone : kAllBones) {
    require(
        plan->human.calibration.bones[bone].position_joint < plan->clip->skeleton().joint_count(),
        "bones are joints of the clip");
  }
  require(load_plan(file_of(plan_json(*plan), "again.json"), {root, {}}).has_value(),
          "what is written is read again");
}

}  // namespace retarget::fuzz
