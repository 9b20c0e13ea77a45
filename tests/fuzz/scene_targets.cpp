// Any bytes as files of 3D scenes: FBX, glTF (as GLB and as JSON), MVNX; read as a motion and as a
// skeleton. Accepted files must be valid.

#include <string_view>

#include "formats/scene/read_scene.h"
#include "fuzz/fuzz_target.h"

namespace retarget::fuzz {
namespace {

void check_scene_clip(const Clip& clip) {
  require(clip.skeleton().joint_count() > 0, "there are joints");
  for (const Joint& joint : clip.skeleton().joints()) {
    require(!joint.name.empty() && joint.offset.allFinite(), "joints have names and places");
  }
  check_frames(clip);
}

void read_both_ways(std::string_view bytes) {
  for (const bool skeleton_only : {false, true}) {
    SceneReadOptions options;
    options.skeleton_only = skeleton_only;
    options.max_clip_bytes = std::size_t{4} << 20U;
    // As from a pipe, without accompanying files.
    const Result<Clip> clip = read_scene(bytes, "standard input", options);
    if (good(clip)) check_scene_clip(*clip);
  }
}

}  // namespace

void fuzz_fbx(std::string_view bytes) {
  if (bytes.starts_with("Kaydara") || bytes.starts_with("; FBX")) read_both_ways(bytes);
}

void fuzz_gltf(std::string_view bytes) {
  read_both_ways(bytes);
}

void fuzz_mvnx(std::string_view bytes) {
  if (bytes.find("<mvnx") != std::string_view::npos) read_both_ways(bytes);
}

}  // namespace retarget::fuzz
