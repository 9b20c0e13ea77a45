// `retarget view` of a batch: a gallery with a page for every motion.

#include "retarget/gallery.h"

#include <filesystem>
#include <string>
#include <system_error>

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "retarget/file.h"
#include "retarget/try.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

Result<void> check_gallery(const ViewArguments& arguments) {
  const std::string& output = arguments.run.run.output;
  if (arguments.motions.size() > 1) {
    return usage_failure("a gallery shows one folder",
                         "give motion files to play them side by side");
  }
  std::error_code ignored;
  if (output == "-" || (fs::exists(output, ignored) && !fs::is_directory(output, ignored)) ||
      (!fs::exists(output, ignored) && !fs::path(output).extension().empty() &&
       output.back() != '/')) {
    return usage_failure("a gallery must be a folder, found the output \"" + output + "\"",
                         "give a folder, such as gallery/");
  }
  if (!arguments.run.run.motion.empty() || !arguments.run.png.empty() ||
      !arguments.labels.empty()) {
    return usage_failure("--bvh, --smpl, --png and --label apply to motions, not to a folder");
  }
  fs::path folder = fs::path(output).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  return check_output_folder(folder.string());
}

}  // namespace

Result<void> view_gallery(const ViewArguments& arguments, Console& console) {
  RETARGET_TRY(check_gallery(arguments));
  GalleryRequest request;
  request.batch = arguments.motions.front();
  request.output = arguments.run.run.output;
  request.data_folder = DataFolder{arguments.run.common.data_dir};
  request.robot = arguments.run.run.robot;
  request.gates = arguments.gates;
  request.meshes = arguments.meshes;
  request.spelling = option_as_flag;
  request.begin_worker = leave_interrupts_to_parent;
  return write_gallery(request, console);
}

}  // namespace retarget::cli
