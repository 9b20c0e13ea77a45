#include "commands.h"

namespace retarget::cli {

Result<BvhFile> read_source(const SourceOptions& options, bool skeleton_only, Console& console) {
  BvhReadOptions read_options;
  read_options.lenient = options.lenient;
  read_options.motion_optional = skeleton_only;
  read_options.root = options.root;
  if (options.source_fps > 0.0) read_options.source_fps = options.source_fps;
  auto file = load_bvh(options.file, read_options);
  if (file) console.warn(file->warnings, source_name(options));
  return file;
}

std::string source_name(const SourceOptions& options) {
  return options.file == "-" ? "standard input" : options.file;
}

}  // namespace retarget::cli
