#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "retarget/error.h"
#include "retarget/export.h"

namespace RETARGET_API retarget {

/// Joins NPZ files of one kind, such as motions of a tracking format, to one NPZ file.
///
/// Numeric arrays with two or more dimensions are concatenated along the first one, the frames. All
/// other arrays must be equal in all files and are stored once. The arrays `clip_names`,
/// `clip_starts` and `clip_lengths` (frames) describe the parts. Only one file is in memory at a
/// time.
class NpzConcatenation {
 public:
  NpzConcatenation();
  ~NpzConcatenation();
  NpzConcatenation(NpzConcatenation&&) noexcept;
  NpzConcatenation& operator=(NpzConcatenation&&) noexcept;

  /// Reads a file and adds it as the next part. kInput errors: not an NPZ file, arrays unlike those
  /// of the first file, arrays of different numbers of frames.
  /// @param name  name of the part, for clip_names.
  [[nodiscard]] Result<void> add(std::string name, std::string path);

  /// Called before an array of a part is read; its error ends the writing.
  using BeforePart = std::function<Result<void>(const std::string& array, const std::string& part)>;
  /// Reads all files again and writes the joined one, completely or not at all.
  /// Errors: those of reading, which have the part's file; kRun: `path` cannot be written.
  [[nodiscard]] Result<void> write(const std::string& path, const BeforePart& before) const;

  /// Sum over the parts.
  [[nodiscard]] std::int64_t frame_count() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace retarget
