#include "scene/read_scene.h"

#include <utility>

#include "base/try.h"
#include "scene/fbx_scene.h"
#include "scene/gltf_scene.h"
#include "scene/mvnx.h"
#include "scene/scene_clip.h"

namespace retarget {

bool looks_like_scene(std::string_view bytes) {
  return looks_like_fbx(bytes) || looks_like_gltf(bytes) || looks_like_mvnx(bytes);
}

Result<Clip> read_scene(std::string_view bytes, const std::string& file_name,
                        const SceneReadOptions& options) {
  if (looks_like_mvnx(bytes)) return read_mvnx(bytes, file_name, options);
  TRY_ASSIGN(const Scene scene, looks_like_fbx(bytes)
                                    ? read_fbx(bytes, file_name, options.max_clip_bytes)
                                    : read_gltf(bytes, file_name, options.max_clip_bytes));
  return clip_of_scene(scene, file_name, bytes.size(), options);
}

}  // namespace retarget
