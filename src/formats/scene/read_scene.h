#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "formats/scene/scene.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

struct SceneReadOptions {
  std::string take;  ///< Name, or number from 1; empty: the longest with motion.
  std::string root;  ///< Root of one of several skeletons, or its number; empty: the moving one.
  std::optional<double> source_fps;  ///< Sampling rate in Hz; default: the rate of the keys.
  bool skeleton_only = false;  ///< Read a file without animation as a skeleton without frames.
  std::size_t max_clip_bytes = std::numeric_limits<std::size_t>::max();
};

/// Reads the motion of a skeleton from an FBX, glTF, VRM or MVNX file; see docs/scenes.md.
///
/// The clip is in the file's units and axes, as stated by its origin. Its zero pose is the bind
/// pose of the skins, otherwise the nodes' rest pose. In the zero pose the joints' axes are those
/// of the world (ClipBuilder).
///
/// @param file_name  name given by the user; external files are located relative to it.
/// @return kInput errors; kUsage for unknown takes and skeletons.
[[nodiscard]] Result<Clip> read_scene(std::string_view bytes, const std::string& file_name,
                                      const SceneReadOptions& options = {});

/// Samples the motion of a scene's skeleton in a take; see read_scene.
/// @param file_bytes  size of the file; the memory of the clip is limited in proportion to it.
[[nodiscard]] Result<Clip> clip_of_scene(const SceneGraph& scene, const std::string& file_name,
                                         std::size_t file_bytes, const SceneReadOptions& options);

/// Reads the nodes and animations of an FBX file with ufbx. Meshes, textures and other content are
/// ignored. Files that it refers to are never opened.
///
/// ufbx evaluates pre- and post-rotations, axis orders, pivots, layers and scale inheritance. The
/// result is a plain transform relative to the parent.
///
/// @param max_bytes  memory limit for files of any size; a file that needs more is rejected.
/// @return kInput errors.
[[nodiscard]] Result<SceneGraph> read_fbx(std::string_view bytes, const std::string& file_name,
                                          std::size_t max_bytes);

/// Reads the nodes, skins and animations of a glTF 2.0 file.
///
/// If a VRM extension maps nodes to human bones (VRMC_vrm, VRM, VRMC_vrm_animation), these nodes
/// get VRM's bone names: hips, leftUpperArm, ... Other nodes with such a name get the suffix
/// `_node`.
///
/// @param max_bytes  limit on external files and numbers together; see GltfDocument.
/// @return kInput errors; see GltfDocument.
[[nodiscard]] Result<SceneGraph> read_gltf(std::string_view bytes, const std::string& file_name,
                                           std::size_t max_bytes);

/// Reads Xsens MVNX: XML with the orientation (w x y z) and position of every body segment per
/// frame, in metres, Z up (MVN User Manual, "MVNX").
///
/// The motion consists of the frames of type `normal`. The rest pose is the frame `tpose`,
/// otherwise `identity`, otherwise `npose`; without them all segments are aligned with the world
/// axes. The document's `joints` define the hierarchy.
///
/// @return kInput errors; kUsage for unknown takes and subjects.
[[nodiscard]] Result<Clip> read_mvnx(std::string_view bytes, const std::string& file_name,
                                     const SceneReadOptions& options);

}  // namespace retarget
