#include "batch/clip_memory.h"

#include <filesystem>
#include <string>

#include "base/lower_case.h"

namespace retarget {
namespace {

// a clip takes about so many times its file's bytes (measured with both methods, their motions
// measured as well), and so many bytes of its own
constexpr std::uint64_t kMemoryOfText = 8;
constexpr std::uint64_t kMemoryOfNpz = 20;
constexpr std::uint64_t kMemoryOfClip = std::uint64_t{16} << 20U;

}  // namespace

std::uint64_t memory_of_clip(std::string_view file, std::uint64_t bytes) {
  const std::string ending = lower_case(std::filesystem::path(file).extension().string());
  const bool text = ending == ".bvh" || ending == ".csv";
  return kMemoryOfClip + bytes * (text ? kMemoryOfText : kMemoryOfNpz);
}

}  // namespace retarget
