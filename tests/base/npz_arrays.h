#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>

#include "formats/containers/npz.h"
#include "support/npz_builder.h"
#include "support/value_of.h"

namespace retarget {

/// The bytes end where their memory ends, so that a sanitizer sees any read past them.
class ExactBytes {
 public:
  explicit ExactBytes(std::string_view bytes)
      : bytes_(new char[bytes.size()]), size_(bytes.size()) {
    if (size_ > 0) std::memcpy(bytes_.get(), bytes.data(), size_);
  }
  [[nodiscard]] std::string_view view() const { return {bytes_.get(), size_}; }

 private:
  std::unique_ptr<char[]> bytes_;
  std::size_t size_;
};

inline Result<NpyArray> read_array(const std::string& bytes, std::string_view name,
                                   const NpzReadOptions& options = {}) {
  const ExactBytes exact(bytes);
  const Result<NpzFile> file = NpzFile::open(exact.view(), "a.npz", options);
  if (!file) return failure(file.error());
  return file->read(name);
}

/// The only array of a valid file.
inline NpyArray array_of(const std::string& npy_bytes, const NpzBuilder::Style& style = {}) {
  return value_of(read_array(NpzBuilder().add("a", npy_bytes, style).build(), "a"));
}

template <typename T>
std::string error_of(const Result<T>& result) {
  return result ? "no error" : describe(result.error());
}

inline std::string array_error(const std::string& npy_bytes, const NpzBuilder::Style& style = {}) {
  return error_of(read_array(NpzBuilder().add("a", npy_bytes, style).build(), "a"));
}

}  // namespace retarget
