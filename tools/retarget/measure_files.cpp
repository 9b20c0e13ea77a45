#include "measure_files.h"

#include <algorithm>

#include "retarget/error.h"
#include "retarget/try.h"
#include "shared_arguments.h"

namespace retarget::cli {

Result<std::vector<std::string>> check_inputs(const MeasureArguments& arguments) {
  const Run& run = arguments.run.run;
  const bool source = !run.motion.empty() || !arguments.run.smpl_file.empty();
  if (!source && (run.options.part.start_s >= 0.0 || arguments.fps == "source")) {
    return usage_failure(
        std::string(arguments.fps == "source" ? "--fps source" : "--start") + " needs the source",
        "add --bvh FILE");
  }
  const auto inputs = std::ranges::count(arguments.motions, "-") + (run.motion == "-" ? 1 : 0);
  if (inputs > 1) return usage_failure("standard input can be read only once");
  std::vector<std::string> read = files_read(run, arguments.run.common);
  read.insert(read.end(), arguments.motions.begin(), arguments.motions.end());
  read.insert(read.end(), arguments.gates.begin(), arguments.gates.end());
  read.push_back(arguments.run.smpl_file);
  return read;
}

Result<MeasureRequest> measure_request(const MeasureArguments& arguments) {
  RunArguments with_file = arguments.run;
  RETARGET_TRY(take_smpl_file(with_file));
  return MeasureRequest{std::move(with_file.run),
                        std::move(with_file.request),
                        arguments.fps,
                        arguments.reading,
                        arguments.motions,
                        arguments.gates,
                        arguments.dynamics,
                        DataFolder{with_file.common.data_dir}};
}

}  // namespace retarget::cli
