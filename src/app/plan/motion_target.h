#pragma once

#include <variant>
#include <vector>

#include "base/output_folder.h"
#include "retarget/error.h"
#include "retarget/file.h"
#include "retarget/motion_io.h"
#include "retarget/run.h"

namespace retarget {

/// Output of a motion in one format: a file or folder, written completely or not at all.
class MotionTarget {
 public:
  [[nodiscard]] static Result<MotionTarget> create(const OutputItem& item);

  [[nodiscard]] Result<void> write(const std::vector<FormattedFile>& files);
  [[nodiscard]] Result<void> commit();

 private:
  explicit MotionTarget(OutputFile file) : place_(std::move(file)) {}
  explicit MotionTarget(OutputFolder folder) : place_(std::move(folder)) {}
  std::variant<OutputFile, OutputFolder> place_;
};

}  // namespace retarget
