#pragma once

#include <string>
#include <utility>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// How bytes travel.
enum class Transport : unsigned char { kUdp, kTcp, kStdin, kStdout, kFile, kZmq, kRedis };

/// Where a stream comes from or goes to: `udp:1118?format=bvh`, `tcp:0.0.0.0:9763`, `stdin`, `-`,
/// `motion.csv`, `zmq:5556`, `redis:6379`.
struct StreamAddress {
  Transport transport = Transport::kUdp;
  std::string host = "127.0.0.1";  ///< Numbers with dots; of what has a port.
  int port = 0;
  std::string file;    ///< Of kFile.
  std::string format;  ///< Empty: the default of where it is used.
  std::vector<std::pair<std::string, std::string>> extras;  ///< Other parts behind `?`.

  /// Of an extra; empty: it is not given.
  [[nodiscard]] std::string extra(const std::string& name) const;
  /// As people write it.
  [[nodiscard]] std::string text() const;
};

/// Whether an address of UDP or TCP is one of this machine alone.
[[nodiscard]] bool is_this_machine(const StreamAddress& address);

/// Errors (kUsage) say what was expected. What is none of the forms above is a file's name.
[[nodiscard]] Result<StreamAddress> parse_address(const std::string& text);

}  // namespace retarget
