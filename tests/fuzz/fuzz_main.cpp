// One libFuzzer program for all targets: retarget_fuzz --target=bvh [libFuzzer's options] [FOLDERS].
// tools/fuzz.sh runs it.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "fuzz/fuzz_target.h"

namespace {

const retarget::fuzz::FuzzTarget* chosen = nullptr;

}  // namespace

// libFuzzer ignores arguments that begin with two dashes.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr std::string_view kOption = "--target=";
  for (int i = 1; i < *argc; ++i) {
    const std::string_view word((*argv)[i]);
    if (word.starts_with(kOption)) {
      chosen = retarget::fuzz::find_fuzz_target(word.substr(kOption.size()));
    }
  }
  if (chosen != nullptr) return 0;
  std::fputs("give --target=NAME of one of these:", stderr);
  for (const auto& target : retarget::fuzz::fuzz_targets()) {
    std::fprintf(stderr, " %.*s", static_cast<int>(target.name.size()), target.name.data());
  }
  std::fputs("\n", stderr);
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // The buffer ends with its memory, so that the sanitizer sees any read past it.
  const std::vector<char> bytes(data, data + size);
  chosen->run({bytes.data(), bytes.size()});
  return 0;
}
