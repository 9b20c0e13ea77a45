#pragma once

#include <string>
#include <vector>

#include "batch/find_inputs.h"
#include "retarget/error.h"

namespace retarget {

/// One of several parts of a batch.
struct Shard {
  int index = 1;  ///< From 1
  int count = 1;  ///< to count.
};

/// `2/8`; kUsage where the text is no such thing.
[[nodiscard]] Result<Shard> parse_shard(const std::string& text);

/// Longest first, by the size of the files; equal ones by their names.
void sort_longest_first(std::vector<BatchInput>& inputs);

/// The inputs of a shard: sorted longest first they are dealt to the shards in turn, so that all
/// have about the same to do. Every input is in one shard, provided that all shards see the same
/// files.
[[nodiscard]] std::vector<BatchInput> take_shard(std::vector<BatchInput> inputs,
                                                 const Shard& shard);

}  // namespace retarget
