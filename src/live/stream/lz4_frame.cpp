#include "live/stream/lz4_frame.h"

#ifdef RETARGET_HAS_LZ4
#include <lz4frame.h>

#include <array>
#endif

namespace retarget {

#ifdef RETARGET_HAS_LZ4

struct Lz4Frame::Context {
  Context() { LZ4F_createDecompressionContext(&handle, LZ4F_VERSION); }
  ~Context() { LZ4F_freeDecompressionContext(handle); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  LZ4F_dctx* handle = nullptr;
};

bool Lz4Frame::is_available() {
  return true;
}

void Lz4Frame::clear() {
  if (context_) LZ4F_resetDecompressionContext(context_->handle);
}

Result<bool> Lz4Frame::unpack(std::string_view& bytes, std::size_t max_size, std::string& text) {
  if (!context_) context_ = std::make_unique<Context>();
  std::array<char, 1 << 14> room;
  const auto refused = [this](std::string message) {
    clear();
    return input_failure({}, std::move(message));
  };
  for (;;) {
    std::size_t taken = bytes.size(), made = room.size();
    const std::size_t wants =
        LZ4F_decompress(context_->handle, room.data(), &made, bytes.data(), &taken, nullptr);
    if (LZ4F_isError(wants) != 0U) {
      return refused(std::string("not an LZ4 frame: ") + LZ4F_getErrorName(wants));
    }
    if (text.size() + made > max_size)
      return refused("the LZ4 frame exceeds the packet size limit");
    text.append(room.data(), made);
    bytes.remove_prefix(taken);
    if (wants == 0) return true;
    if (taken == 0 && made == 0) return false;
  }
}

#else

struct Lz4Frame::Context {};

bool Lz4Frame::is_available() {
  return false;
}

void Lz4Frame::clear() {
  context_.reset();
}

Result<bool> Lz4Frame::unpack(std::string_view&, std::size_t, std::string&) {
  return input_failure({}, "the packet is compressed with LZ4, which this build does not support",
                       "configure the sender to send plain JSON");
}

#endif

Lz4Frame::Lz4Frame() = default;
Lz4Frame::~Lz4Frame() = default;
Lz4Frame::Lz4Frame(Lz4Frame&&) noexcept = default;
Lz4Frame& Lz4Frame::operator=(Lz4Frame&&) noexcept = default;

}  // namespace retarget
