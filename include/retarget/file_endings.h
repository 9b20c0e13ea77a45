#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/export.h"

namespace RETARGET_API retarget {

/// Extension of a file name in lower case, with its dot; may be empty.
[[nodiscard]] std::string ending_of(const std::string& path);

/// Whether a batch that searches folders for motions of humans, or of robots, takes this file.
[[nodiscard]] bool is_human_ending(std::string_view ending);
[[nodiscard]] bool is_robot_ending(std::string_view ending);
/// Whether files with this extension may be human motions, which only their content shows: pickles.
[[nodiscard]] bool may_be_human_ending(std::string_view ending);
/// Whether a file of arrays holds a human motion, or cannot be read, so that its content is unknown.
/// @param max_bytes  larger files are not read.
[[nodiscard]] bool may_hold_human_motion(const std::string& path, std::size_t max_bytes);
/// Extensions of these files for messages: `.bvh, .fbx or .npz`.
[[nodiscard]] std::string human_endings_text();
[[nodiscard]] std::string robot_endings_text();

/// The other files that belong to a motion file: the buffers of a `.gltf` file that lie in its
/// folder, without repetitions. Returns none if the file cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> companion_files(const std::string& path);

/// Whether a folder holds a motion of format kCsvSonic.
[[nodiscard]] bool is_sonic_folder(const std::string& path);

}  // namespace retarget
