#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// A message of Open Sound Control 1.0 (opensoundcontrol.stanford.edu/spec-1_0.html), as far as
/// motion needs it: its texts and its numbers, each in their order; other arguments are passed over.
struct OscMessage {
  std::string_view address;
  std::vector<std::string_view> texts;
  std::vector<double> numbers;
};

/// The messages of a packet, those of bundles in their order; they refer to the packet. Errors
/// (kInput): what is no such packet.
[[nodiscard]] Result<std::vector<OscMessage>> read_osc(std::string_view packet);

/// A bundle that counts at once, put together message by message.
class OscBundle {
 public:
  OscBundle();
  /// @param types  of the arguments, as the standard has them behind its comma: `s` is the text, `i` and
  ///     `f` are the numbers, each in their order.
  /// @pre as many numbers as types ask for
  void add(std::string_view address, std::string_view types, std::string_view text,
           std::span<const double> numbers);
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace retarget
