// `retarget scene-from-motion`: the boxes that a human rests on, as a scene.

#include <memory>
#include <string>
#include <utility>

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "retarget/clip.h"
#include "retarget/clip_range.h"
#include "retarget/file.h"
#include "retarget/file_endings.h"
#include "retarget/inspect.h"
#include "retarget/load.h"
#include "retarget/plan.h"
#include "retarget/run.h"
#include "retarget/scene_from_motion.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "retarget/write_scene.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

// The scene, still, with one frame.
SceneClip still_scene(Scene scene) {
  SceneClip clip;
  clip.frame_count = 1;
  for (const SceneBody& body : scene.bodies) clip.world_from_body.push_back(body.world_from_body);
  clip.scene = std::make_shared<const Scene>(std::move(scene));
  return clip;
}

Result<std::string> format_found(const std::string& file, const Scene& scene) {
  if (ending_of(file) == ".obj") return format_scene_obj(still_scene(scene));
  if (file == "-" || ending_of(file) == ".json") return format_scene_json(still_scene(scene));
  return usage_failure("--output: the name of a scene ends in .json or .obj");
}

}  // namespace

Result<void> find_scene(const SceneFromMotionArguments& arguments, Console& console) {
  const Run& run = arguments.run.run;
  const std::string& output = arguments.output;
  if (!output.empty()) RETARGET_TRY(format_found(output, Scene()));
  RETARGET_TRY(check_written({output}, files_read(run, arguments.run.common)));
  const DataFolder data_folder{arguments.run.common.data_dir};
  RETARGET_TRY_ASSIGN(Clip clip, load_clip(run.motion, run.options.source, data_folder));
  console.warn(clip.origin().warnings, clip.name());
  RETARGET_TRY_ASSIGN(const std::string folder, data_folder_of(arguments.run.common));
  RETARGET_TRY_ASSIGN(const HumanInClip human, find_human_as_run(clip, run.options, folder));
  console.warn(human.doubts(), clip.name());
  RETARGET_TRY_ASSIGN(const FrameRange part,
                      chosen_range(run.options.part, clip.rate(), clip.frame_count()));
  console.warn(range_doubts(run.options.part, clip.rate(), clip.frame_count()), clip.name());
  if (part != FrameRange{0, clip.frame_count()}) clip = cut(clip, part.begin, part.end);
  RETARGET_TRY_ASSIGN(const SceneFromMotion found, scene_from_motion(clip, human.calibration));
  if (found.surfaces.empty()) {
    return input_failure(clip.name(), "found no surfaces above the floor");
  }
  if (!output.empty()) {
    RETARGET_TRY_ASSIGN(const std::string text, format_found(output, found.scene));
    RETARGET_TRY(write_file(output, text));
    if (output == "-") return {};
  }
  return write_file("-", printable(surfaces_text(found)));
}

}  // namespace retarget::cli
