#include "live/stream/decoder.h"

namespace retarget {

// Text formats: splits the bytes at line ends into datagrams of limited size.
std::size_t Encoder::packet_size(std::string_view bytes) const {
  constexpr std::size_t kMaxDatagramSize = 65000;  // bytes
  if (bytes.size() <= kMaxDatagramSize) return bytes.size();
  const std::size_t end = bytes.rfind('\n', kMaxDatagramSize);
  return end == std::string_view::npos ? bytes.size() : end + 1;
}

}  // namespace retarget
