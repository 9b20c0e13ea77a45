#include <unistd.h>

#include <cstddef>
#include <memory>

#include "live/stream/writer_thread.h"
#include "retarget/serve.h"

namespace retarget {

MessageWriter::MessageWriter(int descriptor) {
  constexpr FrameBytesQueue::Bounds kQueued = {256, std::size_t{64} << 10};
  thread_ = std::make_unique<WriterThread>(Descriptor(::dup(descriptor)), kQueued);
}

MessageWriter::~MessageWriter() {
  if (thread_) thread_->finish(false, {});
}

MessageWriter::MessageWriter(MessageWriter&&) noexcept = default;
MessageWriter& MessageWriter::operator=(MessageWriter&&) noexcept = default;

void MessageWriter::write(std::string_view text) {
  static_cast<void>(thread_->put(text));
}

}  // namespace retarget
