#include "commands.h"
#include "retarget/base/file.h"

namespace retarget::cli {

Result<BvhFile> read_source(const SourceOptions& options, bool skeleton_only, Console& console) {
  BvhReadOptions read_options;
  read_options.lenient = options.lenient;
  read_options.motion_optional = skeleton_only;
  read_options.root = options.root;
  if (options.source_fps > 0.0) read_options.source_fps = options.source_fps;
  const std::string name = source_name(options);
  const auto bytes = read_file(options.file);
  if (!bytes) return failure(bytes.error());
  auto file = read_bvh(bytes->view(), name, read_options);
  if (file) console.warn(file->warnings, name);
  return file;
}

std::string source_name(const SourceOptions& options) {
  return options.file == "-" ? "standard input" : options.file;
}

}  // namespace retarget::cli
