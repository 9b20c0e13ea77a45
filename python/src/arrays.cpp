#include "arrays.h"

#include <fmt/format.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <string>
#include <utility>

#include "raise.h"

namespace retarget::python {
namespace {

template <typename Number>
nb::object array_over(const Number* data, const std::vector<std::size_t>& shape,
                      std::shared_ptr<const void> owner, const std::int64_t* strides) {
  // numpy needs a non-null address even for empty arrays.
  static const Number kNone{};
  using Owner = std::shared_ptr<const void>;
  auto held = std::make_unique<Owner>(std::move(owner));
  const nb::capsule capsule(held.get(), [](void* it) noexcept { delete static_cast<Owner*>(it); });
  static_cast<void>(held.release());
  return nb::cast(nb::ndarray<nb::numpy, const Number>(
      data == nullptr ? &kNone : data, shape.size(), shape.data(), capsule, strides));
}

std::string shape_text(const std::vector<std::int64_t>& shape) {
  std::string text;
  for (const std::int64_t size : shape) {
    text += (text.empty() ? "" : ", ") + (size < 0 ? std::string("n") : std::to_string(size));
  }
  return "(" + text + (shape.size() == 1 ? ",)" : ")");
}

[[noreturn]] void refuse(const std::string& message) {
  raise(usage_failure(message).value());
}

std::string shown(nb::handle object) {
  const nb::object text = nb::steal(PyObject_Str(object.ptr()));
  if (text.is_valid()) return shown_text(text);
  forget_exception();
  return "an unprintable value";
}

// Formats the multi-dimensional index of a number, for messages.
std::string place_of(std::size_t index, const std::vector<std::size_t>& shape) {
  std::string text;
  for (std::size_t axis = shape.size(); axis-- > 0;) {
    text = std::to_string(index % shape[axis]) + (text.empty() ? "" : ", ") + text;
    index /= shape[axis];
  }
  return "[" + text + "]";
}

}  // namespace

nb::object shared_array(const double* data, const std::vector<std::size_t>& shape,
                        std::shared_ptr<const void> owner,
                        const std::vector<std::int64_t>& strides) {
  return array_over(data, shape, std::move(owner), strides.empty() ? nullptr : strides.data());
}

nb::object array_of(std::vector<double> numbers, const std::vector<std::size_t>& shape) {
  const auto kept = std::make_shared<const std::vector<double>>(std::move(numbers));
  return array_over(kept->data(), shape, kept, nullptr);
}

nb::object array_of_flags(std::vector<std::uint8_t> flags, const std::vector<std::size_t>& shape) {
  const auto kept = std::make_shared<const std::vector<std::uint8_t>>(std::move(flags));
  return array_over(kept->data(), shape, kept, nullptr).attr("view")("bool");
}

FrameRate rate_of(double fps) {
  const bool sound = fps >= 0.001 && fps <= 1e6;
  if (!sound) {
    raise(usage_failure(
              fmt::format("fps: expected frames per second, 0.001 to 1000000, found {}", fps))
              .value());
  }
  return frame_rate_from_fps(fps);
}

GivenArray::GivenArray(nb::handle object, const char* what,
                       const std::vector<std::int64_t>& shape) {
  const nb::module_ numpy = nb::module_::import_("numpy");
  // asarray() would use the values below the mask.
  if (nb::hasattr(object, "mask") && nb::hasattr(object, "filled") &&
      PyObject_IsTrue(numpy.attr("any")(object.attr("mask")).ptr()) != 0) {
    refuse(fmt::format("{}: expected an array without masked values", what));
  }
  try {
    array_ = numpy.attr("asarray")(object);
  } catch (nb::python_error& error) {
    // Reports errors such as ragged lists; rethrows interrupts and the like.
    if (!error.matches(PyExc_Exception)) throw;
    refuse(fmt::format("{}: expected an array of shape {}: {}", what, shape_text(shape),
                       shown(error.value())));
  }
  const auto kind = nb::cast<std::string>(array_.attr("dtype").attr("kind"));
  if (kind != "f" && kind != "i" && kind != "u") {
    refuse(fmt::format("{}: expected an array of numbers, found dtype {}", what,
                       shown(nb::object(array_.attr("dtype")))));
  }
  const auto found = nb::cast<std::vector<std::int64_t>>(nb::list(array_.attr("shape")));
  bool fits = found.size() == shape.size();
  for (std::size_t axis = 0; fits && axis < shape.size(); ++axis) {
    fits = shape[axis] < 0 || shape[axis] == found[axis];
  }
  if (!fits) {
    refuse(
        fmt::format("{}: expected shape {}, found {}", what, shape_text(shape), shape_text(found)));
  }
  array_ = numpy.attr("ascontiguousarray")(array_, "float64");
  shape_.assign(found.begin(), found.end());
  std::size_t count = 1;
  for (const std::size_t size : shape_) count *= size;
  const auto view = nb::cast<nb::ndarray<const double, nb::c_contig, nb::device::cpu>>(array_);
  numbers_ = {view.data(), count};
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isfinite(numbers_[i])) {
      refuse(fmt::format("{}{}: expected a finite number, found {}", what, place_of(i, shape_),
                         numbers_[i]));
    }
  }
}

}  // namespace retarget::python
