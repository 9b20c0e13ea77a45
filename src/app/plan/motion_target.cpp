#include "app/plan/motion_target.h"

#include <string>
#include <utility>

#include "base/try.h"

namespace retarget {

Result<MotionTarget> MotionTarget::create(const OutputItem& item) {
  if (!format_is_folder(item.format)) {
    TRY_ASSIGN(auto file, OutputFile::create(item.path));
    return MotionTarget(std::move(file));
  }
  TRY_ASSIGN(auto folder, OutputFolder::create(item.path, folder_file_names(item.format)));
  return MotionTarget(std::move(folder));
}

Result<void> MotionTarget::write(const std::vector<FormattedFile>& files) {
  if (auto* file = std::get_if<OutputFile>(&place_)) return file->write(files.front().bytes);
  for (const FormattedFile& file : files) {
    TRY(std::get<OutputFolder>(place_).write(file.name, file.bytes));
  }
  return {};
}

Result<void> MotionTarget::commit() {
  if (auto* file = std::get_if<OutputFile>(&place_)) return file->commit();
  return std::get<OutputFolder>(place_).commit();
}

}  // namespace retarget
