#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "formats/containers/npy.h"

namespace retarget {

/// Writes a Python pickle of protocol 4, opcode by opcode: plain values, and NumPy arrays in the
/// form that NumPy itself pickles (`numpy.core.multiarray._reconstruct`, which NumPy 1 and 2 both
/// accept). Values are never shared, so no memo is needed.
class PickleWriter {
 public:
  PickleWriter();

  void begin_dict();
  void end_dict();
  void begin_list();
  void end_list();
  void none();
  void integer(std::int64_t value);
  void number(double value);
  /// Replaces invalid UTF-8, which Python would refuse.
  void text(std::string_view value);
  void texts(std::span<const std::string> values);  ///< A list.
  void array(const NpyArray& array);
  /// Adds an array to the current dictionary.
  void array(std::string_view key, const NpyArray& value) {
    text(key);
    array(value);
  }

  /// Returns the whole pickle.
  [[nodiscard]] std::string finish();

 private:
  void bytes(std::string_view value);
  void tuple_of_lengths(std::span<const std::size_t> lengths);
  void global(std::string_view module, std::string_view name);

  std::string bytes_;
};

}  // namespace retarget
