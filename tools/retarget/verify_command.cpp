// `retarget verify`: checks that a run still gives the bytes recorded in its sidecar.

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "retarget/load.h"
#include "retarget/run.h"
#include "shared_arguments.h"

namespace retarget::cli {

Result<void> verify(const VerifyArguments& arguments, Console& console) {
  return verify_run(arguments.file, DataFolder{arguments.common.data_dir}, console);
}

}  // namespace retarget::cli
