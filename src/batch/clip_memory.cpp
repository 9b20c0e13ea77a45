#include "batch/clip_memory.h"

#include <filesystem>
#include <string>

#include "retarget/text.h"

namespace retarget {
namespace {

// Memory of a clip: a multiple of its file size, and a constant. Measured with both methods,
// including quality measurement.
constexpr std::uint64_t kMemoryOfText = 8;
constexpr std::uint64_t kMemoryOfNpz = 20;
constexpr std::uint64_t kMemoryOfClip = std::uint64_t{16} << 20U;

}  // namespace

std::uint64_t memory_of_clip(std::string_view file, std::uint64_t bytes) {
  const std::string ending = lower_case(std::filesystem::path(file).extension().generic_string());
  const bool text = ending == ".bvh" || ending == ".csv";
  return kMemoryOfClip + bytes * (text ? kMemoryOfText : kMemoryOfNpz);
}

}  // namespace retarget
