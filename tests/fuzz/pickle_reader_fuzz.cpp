// Any bytes as a Python pickle; what is accepted must be sound.
//
//   pickle_reader_fuzz CORPUS

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "retarget/io/pickle.h"

namespace {

void require(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "not true: %s\n", what);
  std::abort();
}

void check(std::string_view bytes) {
  const auto document = retarget::read_pickle(bytes, "fuzz.pkl");
  if (!document) return require(!document.error().message.empty(), "errors say something");
  const auto& root = document->root();
  (void)document->number(root);
  for (const std::string& key : document->keys(root)) {
    const auto* member = document->find(root, key);
    require(member != nullptr, "keys are found");
    if (member->kind != retarget::PickleNode::Kind::kArray) continue;
    const auto& array = document->array(*member);
    require(array.data.size() == array.element_count() * array.item_size,
            "the shape explains the bytes");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  check(bytes);
  check("\x80\x04" + bytes);
  return 0;
}
