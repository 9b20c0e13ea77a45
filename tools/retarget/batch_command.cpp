// `retarget batch`: converts folders of clips to folders of motions.

#include "retarget/batch.h"

#include <cstddef>

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "retarget/try.h"
#include "shared_arguments.h"

namespace retarget::cli {

Result<ExitCode> batch(const BatchArguments& arguments, Console& console) {
  BatchRequest request = arguments.request;
  RETARGET_TRY_ASSIGN(request.data_folder, data_folder_of(arguments.run.common));
  request.run = arguments.run.run;
  request.of_clip = arguments.run.request;
  request.quality = !arguments.no_quality;
  request.begin_worker = leave_interrupts_to_parent;
  RETARGET_TRY_ASSIGN(const std::size_t failed, arguments.merge ? merge_batch(request, console)
                                                                : run_batch(request, console));
  return failed > 0 ? kRunFailed : kDone;
}

}  // namespace retarget::cli
