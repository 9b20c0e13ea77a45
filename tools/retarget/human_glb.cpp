#include "human_glb.h"

#include <filesystem>

#include "retarget/file.h"
#include "retarget/motion_io.h"
#include "retarget/plan.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "shared_arguments.h"

namespace retarget::cli {

bool is_glb_name(const std::string& path) {
  return lower_case(std::filesystem::path(path).extension().string()) == ".glb";
}

Result<void> save_human_glb(const std::string& output, Clip clip, const HumanOptions& human,
                            const CommonArguments& common, Console& console) {
  RETARGET_TRY_ASSIGN(const std::string data_folder, data_folder_of(common));
  RETARGET_TRY_ASSIGN(const auto found, find_human(clip, human, data_folder));
  console.lines(found.lines());
  console.warn(found.doubts(), clip.name());
  RETARGET_TRY_ASSIGN(const auto bytes,
                      format_human_glb(human_in_world(clip, found.calibration),
                                       std::filesystem::path(output).stem().string()));
  return write_file(output, bytes);
}

}  // namespace retarget::cli
