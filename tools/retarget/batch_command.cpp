// `retarget batch`: folders of clips to folders of motions.

#include "base/try.h"
#include "batch/run_batch.h"
#include "commands.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

BatchRequest request_of(const BatchArguments& arguments, std::string data_folder) {
  BatchRequest request;
  request.run = arguments.run.run;
  request.of_clip = arguments.run.request;
  request.data_folder = std::move(data_folder);
  request.inputs = arguments.inputs;
  request.lists = arguments.lists;
  request.base = arguments.base;
  request.exclude = arguments.exclude;
  request.robots = arguments.robots;
  request.output = arguments.output;
  request.jobs = arguments.jobs;
  request.clip_timeout_s = arguments.clip_timeout_s;
  request.resume = arguments.resume;
  request.redo = arguments.redo;
  request.shard = arguments.shard;
  request.quality = !arguments.no_quality;
  request.exit_code = [](ErrorKind kind) { return int{exit_code(kind)}; };
  request.begin_worker = leave_interrupts_to_parent;
  return request;
}

}  // namespace

Result<ExitCode> batch(const BatchArguments& arguments, Console& console) {
  TRY_ASSIGN(std::string data_folder, data_folder_of(arguments.run.common));
  const BatchRequest request = request_of(arguments, std::move(data_folder));
  TRY_ASSIGN(const std::size_t failed,
             arguments.merge ? merge_batch(request, console) : run_batch(request, console));
  return failed > 0 ? kRunFailed : kDone;
}

}  // namespace retarget::cli
