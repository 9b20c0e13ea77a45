// Any bytes as a settings file: retargeting configuration, skeleton profile, bone map, path,
// options of the fit, gates, limits, profile, model.

#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "fuzz/fuzz_target.h"
#include "human/skeleton/bone_map.h"
#include "human/skeleton/skeleton_profile.h"
#include "retarget/ground_path.h"
#include "retarget/option_table.h"
#include "retarget/report.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "robot/model/check_model.h"
#include "robot/model/load_profile.h"
#include "robot/model/urdf_extras.h"

namespace retarget::fuzz {
namespace {

const Skeleton& body() {
  static const Skeleton skeleton = [] {
    std::vector<Joint> joints;
    for (const char* name : {"Hips", "LeftUpLeg", "LeftLeg", "Spine", "Head", "Head", ""}) {
      Joint joint;
      joint.name = name;
      joint.parent = static_cast<int>(joints.size()) - 1;
      joints.push_back(joint);
    }
    return Skeleton(std::move(joints));
  }();
  return skeleton;
}

}  // namespace

void fuzz_retargeting_config(std::string_view bytes) {
  if (const auto config = parse_retargeting_config(bytes, "fuzz.json"); good(config)) {
    (void)good(resolve_config(*config, *fuzz_robot()));
  }
}

void fuzz_skeleton_profile(std::string_view bytes) {
  (void)good(parse_skeleton_profile(bytes, "fuzz", "fuzz.json"));
}

void fuzz_bone_map(std::string_view bytes) {
  const auto map = parse_bone_map(bytes, "fuzz.json", body());
  if (!good(map)) return;
  for (const int joint : map->joint_of_bone) {
    require(joint >= -1 && joint < body().joint_count(), "bones are joints of the skeleton");
  }
}

void fuzz_path(std::string_view bytes) {
  const auto read = parse_path(bytes, "fuzz.json");
  if (!good(read)) return;
  require(std::isfinite(read->length()), "paths have a length");
  (void)read->at(0.5 * read->length());
  require(parse_path(format_path(*read), "again").has_value(), "the written text can be read");
}

void fuzz_fit_options(std::string_view bytes) {
  (void)good(parse_fit_options(bytes, "fuzz.json", {}));
}

void fuzz_gates(std::string_view bytes) {
  Gates gates;
  if (!good(gates.add_json(bytes, "fuzz.json"))) return;
  for (const Gate& gate : gates.all()) {
    require(gate.min || gate.max, "gates have a bound");
    require(std::isfinite(gate.min.value_or(0.0)) && std::isfinite(gate.max.value_or(0.0)),
            "bounds are finite");
  }
}

void fuzz_limits(std::string_view bytes) {
  const auto limits = load_limits(*fuzz_robot(), file_of(bytes, "limits.json"));
  if (!good(limits)) return;
  require(limits->lower.size() == fuzz_robot()->joints().size(), "every joint has a range");
  for (std::size_t j = 0; j < limits->lower.size(); ++j) {
    require(limits->lower[j] <= limits->upper[j], "ranges are in order");
  }
}

void fuzz_profile(std::string_view bytes) {
  (void)good(load_profile(file_of(bytes, "robot.json"), *fuzz_robot()));
}

// Checks the text before MuJoCo's own reader, whose errors cannot be fixed here.
void fuzz_model(std::string_view bytes) {
  (void)good(check_model(file_of(bytes, "model.xml"), true));
}

void fuzz_urdf(std::string_view bytes) {
  for (const auto& [joint, speed] : urdf_facts(file_of(bytes, "robot.urdf")).speeds) {
    require(std::isfinite(speed) && speed > 0.0, "speeds are above 0");
  }
}

}  // namespace retarget::fuzz
