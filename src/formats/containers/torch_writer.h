#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "formats/containers/npy.h"
#include "retarget/error.h"

namespace retarget {

/// Writes a dictionary as torch.save does since PyTorch 1.6: a ZIP archive with a pickle of
/// protocol 2 and one storage per tensor. Entries have no date and storages are not compressed, so
/// equal values give equal bytes.
class TorchWriter {
 public:
  TorchWriter();

  void integer(std::string_view key, std::int64_t value);
  void number(std::string_view key, double value);
  /// A tensor of type f4, f8, i8 or b1.
  void tensor(std::string_view key, const NpyArray& array);
  /// A member of a Python enum, by its value.
  void enum_member(std::string_view key, std::string_view module, std::string_view name,
                   std::string_view value);

  /// Returns the whole file.
  /// @param folder  top-level folder of the archive; plain ASCII.
  [[nodiscard]] Result<std::string> finish(std::string_view folder);

 private:
  void text(std::string_view value);
  void whole(std::int64_t value);
  void tuple_of(const std::vector<std::size_t>& sizes);
  void global(std::string_view module, std::string_view name);

  std::string pickle_;
  std::vector<std::string> storages_;
};

}  // namespace retarget
