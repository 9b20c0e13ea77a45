#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "retarget/clip.h"

// numpy arrays over the library's memory, and numbers passed by users.

namespace retarget::python {

namespace nb = nanobind;

/// Makes a read-only float64 array over memory that `owner` keeps alive, without copying.
/// @param strides  in numbers; empty: contiguous.
[[nodiscard]] nb::object shared_array(const double* data, const std::vector<std::size_t>& shape,
                                      std::shared_ptr<const void> owner,
                                      const std::vector<std::int64_t>& strides = {});
/// The same for numbers that the array takes over.
[[nodiscard]] nb::object array_of(std::vector<double> numbers,
                                  const std::vector<std::size_t>& shape);
[[nodiscard]] nb::object array_of_flags(std::vector<std::uint8_t> flags,
                                        const std::vector<std::size_t>& shape);

/// Returns the rate for frames per second. Raises UsageError outside 0.001 to 1000000.
[[nodiscard]] FrameRate rate_of(double fps);

/// Numbers passed by a user: anything that numpy converts to an array of integers or floats.
class GivenArray {
 public:
  /// Raises UsageError if the object is not an array of numbers, has another shape or contains
  /// non-finite numbers.
  /// @param what   its name, for messages.
  /// @param shape  expected size per axis, -1: any.
  GivenArray(nb::handle object, const char* what, const std::vector<std::int64_t>& shape);

  [[nodiscard]] std::span<const double> numbers() const { return numbers_; }
  [[nodiscard]] std::size_t size(std::size_t axis) const { return shape_[axis]; }

 private:
  nb::object array_;  // Keeps the numbers alive.
  std::span<const double> numbers_;
  std::vector<std::size_t> shape_;
};

}  // namespace retarget::python
