#pragma once

#include <string_view>

#include "retarget/error.h"
#include "stream/socket.h"
#include "stream/stream_address.h"

namespace retarget {

/// Where bytes go as they come: datagrams, a connection, standard output, a file that grows.
class ByteSink {
 public:
  /// Errors: an address that cannot be had; a file that cannot be written.
  [[nodiscard]] static Result<ByteSink> open(const StreamAddress& address);

  /// A datagram, or the next bytes. Datagrams that nobody takes are no error.
  [[nodiscard]] Result<void> write(std::string_view bytes);
  [[nodiscard]] const StreamAddress& address() const { return address_; }

 private:
  StreamAddress address_;
  Descriptor to_;
};

}  // namespace retarget
