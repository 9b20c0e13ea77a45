#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

// Arrays of numpy over the library's memory, and numbers that users bring.

namespace retarget::python {

namespace nb = nanobind;

/// A read-only float64 array over memory that `owner` keeps alive; nothing is copied.
/// @param strides  in numbers; empty: rows follow each other without gaps.
[[nodiscard]] nb::object shared_array(const double* data, const std::vector<std::size_t>& shape,
                                      std::shared_ptr<const void> owner,
                                      const std::vector<std::int64_t>& strides = {});
/// The same over numbers that are moved in.
[[nodiscard]] nb::object array_of(std::vector<double> numbers,
                                  const std::vector<std::size_t>& shape);
[[nodiscard]] nb::object array_of_flags(std::vector<std::uint8_t> flags,
                                        const std::vector<std::size_t>& shape);

/// Numbers of a user: anything that numpy takes for an array of whole or floating-point numbers.
class GivenArray {
 public:
  /// Raises UsageError for what is none, has another shape or numbers that are not finite.
  /// @param what   its name, for messages.
  /// @param shape  of each axis, -1: any.
  GivenArray(nb::handle object, const char* what, const std::vector<std::int64_t>& shape);

  [[nodiscard]] std::span<const double> numbers() const { return numbers_; }
  [[nodiscard]] std::size_t size(std::size_t axis) const { return shape_[axis]; }

 private:
  nb::object array_;  // keeps the numbers
  std::span<const double> numbers_;
  std::vector<std::size_t> shape_;
};

}  // namespace retarget::python
