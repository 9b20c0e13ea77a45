#include "batch/shard.h"
#include "retarget/option_name.h"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <tuple>

namespace retarget {

Result<Shard> parse_shard(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto [slash, bad_index] = std::from_chars(text.data(), end, shard.index);
  if (bad_index == std::errc() && slash != end && *slash == '/') {
    const auto [rest, bad_count] = std::from_chars(slash + 1, end, shard.count);
    const bool in_range = shard.index >= 1 && shard.index <= shard.count;
    if (bad_count == std::errc() && rest == end && in_range) return shard;
  }
  return usage_failure(
      RETARGET_OPTION("shard") " must be I/N with I from 1 to N, found \"" + text + "\"",
      RETARGET_OPTION("shard") " 1/4 selects the first of four parts");
}

void sort_longest_first(std::vector<BatchInput>& inputs) {
  std::ranges::sort(inputs, [](const BatchInput& a, const BatchInput& b) {
    return std::tie(b.bytes, a.relative, a.path) < std::tie(a.bytes, b.relative, b.path);
  });
}

std::vector<BatchInput> take_shard(std::vector<BatchInput> inputs, const Shard& shard) {
  sort_longest_first(inputs);
  std::vector<BatchInput> taken;
  for (auto i = static_cast<std::size_t>(shard.index - 1); i < inputs.size();
       i += static_cast<std::size_t>(shard.count)) {
    taken.push_back(std::move(inputs[i]));
  }
  return taken;
}

}  // namespace retarget
