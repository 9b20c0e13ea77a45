#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "options.h"
#include "retarget/error.h"
#include "sidecar.h"

namespace retarget::cli {

/// What a sidecar says of a run.
struct Sidecar {
  std::string version;  ///< Of the tool that wrote it.
  std::string output;   ///< Name of the motion file, which lies beside the sidecar.
  std::string format, hash;
  RunOptions options;
  std::vector<ReadFile> files;
};

/// Reads what sidecar_text wrote; members that are not there are empty.
/// Errors (kInput): what is no sidecar, an output that is not the name of a file beside it, options that
/// no command line takes.
/// @param file  for messages.
[[nodiscard]] Result<Sidecar> read_sidecar(std::string_view text, const std::string& file);

}  // namespace retarget::cli
