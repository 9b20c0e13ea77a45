#include "retarget/batch/worker_pool.h"

#include <gtest/gtest.h>

namespace retarget {
namespace {

TEST(Machine, HasProcessorsAndMemory) {
  EXPECT_GE(usable_cores(), 1);
  EXPECT_GT(usable_memory(), std::uint64_t{1} << 20U);
}

}  // namespace
}  // namespace retarget
