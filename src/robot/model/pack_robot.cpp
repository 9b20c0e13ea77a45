#include "retarget/model_pack.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "base/try.h"
#include "retarget/load_robot.h"
#include "robot/model/model_pack.h"

namespace retarget {

Result<std::string> make_model_pack(const RobotFiles& files) {
  TRY_ASSIGN(const auto robot, load_robot_files(files.model.string(), files.profile.string()));
  std::vector<PackedModel> models;
  const auto add = [&](const std::filesystem::path& path, bool float_base) -> Result<void> {
    ModelChanges changes;
    changes.float_base = float_base;
    TRY_ASSIGN(const LoadedModel loaded, load_model(path.string(), changes));
    models.push_back(packed_model(path.filename().string(), loaded));
    return {};
  };
  TRY(add(files.model, robot->fixed_base()));
  for (const RobotVariant& variant : robot->profile().variants) {
    if (variant.model.empty()) continue;
    const std::filesystem::path path(variant.model);
    const bool has_it = std::ranges::any_of(
        models, [&](const PackedModel& model) { return model.file == path.filename(); });
    if (!has_it) TRY(add(path, false));
  }
  return format_model_pack(models);
}

}  // namespace retarget
