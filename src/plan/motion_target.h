#pragma once

#include <variant>
#include <vector>

#include "base/file.h"
#include "base/output_folder.h"
#include "plan/output_files.h"
#include "retarget/error.h"
#include "retarget/motion_io.h"

namespace retarget {

/// Where a motion in one format goes: a file or a folder, which appears whole or not at all.
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
