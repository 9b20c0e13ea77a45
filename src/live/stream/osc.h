#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// A message of Open Sound Control 1.0 (opensoundcontrol.stanford.edu/spec-1_0.html), restricted to
/// what motion needs: its strings and its numbers, each in order. Other arguments are skipped.
struct OscMessage {
  std::string_view address;
  std::vector<std::string_view> texts;
  std::vector<double> numbers;
};

/// Reads the messages of a packet, including those of bundles, in order. They refer to the packet's
/// memory. Errors (kInput): invalid packet, or more than a thousand messages.
[[nodiscard]] Result<std::vector<OscMessage>> read_osc(std::string_view packet);

/// Builds a bundle to be applied immediately, message by message.
class OscBundle {
 public:
  OscBundle();
  /// @param types  type tags as in the standard, without the comma: `s` is the text, `i` and `f`
  ///   are the numbers, each in order.
  /// @pre as many numbers as type tags `i` and `f`
  void add(std::string_view address, std::string_view types, std::string_view text,
           std::span<const double> numbers);
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace retarget
