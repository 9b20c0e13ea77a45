#pragma once

#include <string>
#include <vector>

#include "batch/find_inputs.h"
#include "retarget/error.h"

namespace retarget {

/// One of several parts of a batch.
struct Shard {
  int index = 1;  ///< From 1 to `count`.
  int count = 1;  ///< Number of parts.
};

/// Parses text such as `2/8`. Errors: kUsage.
[[nodiscard]] Result<Shard> parse_shard(const std::string& text);

/// Sorts by file size, longest first; equal sizes by name.
void sort_longest_first(std::vector<BatchInput>& inputs);

/// The inputs of a shard. Inputs are sorted longest first and dealt to the shards in turn, so that
/// all have similar work. If all shards see the same files, every input is in exactly one shard.
[[nodiscard]] std::vector<BatchInput> take_shard(std::vector<BatchInput> inputs,
                                                 const Shard& shard);

}  // namespace retarget
