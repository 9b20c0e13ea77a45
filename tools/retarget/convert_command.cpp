// `retarget convert`: converts robot motions between formats.

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "retarget/run.h"
#include "retarget/try.h"

namespace retarget::cli {

Result<void> convert(const ConvertArguments& arguments, Console& console) {
  ConvertRequest request = arguments.request;
  request.data_folder = DataFolder{arguments.common.data_dir};
  RETARGET_TRY(convert_motion(request, console));
  return {};
}

}  // namespace retarget::cli
