// A clip to an address, as its capture would have sent it.

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <thread>

#include "base/try.h"
#include "stream/byte_sink.h"
#include "stream/decoder.h"
#include "stream/human_bones.h"
#include "stream/serve.h"

namespace retarget {
namespace {

constexpr std::size_t kMaxDatagramSize = 65000;  // bytes

// waits until then, or until it is stopped
void wait_until(std::chrono::steady_clock::time_point then,
                const std::function<bool()>& is_stopped) {
  constexpr auto kLook = std::chrono::milliseconds(50);
  for (auto now = std::chrono::steady_clock::now(); now < then && !(is_stopped && is_stopped());
       now = std::chrono::steady_clock::now()) {
    std::this_thread::sleep_until(std::min(then, now + kLook));
  }
}

// in datagrams that are not too large, cut at line ends
Result<void> send_lines(ByteSink& sink, std::string_view bytes) {
  const bool datagrams = sink.address().transport == Transport::kUdp;
  while (!bytes.empty()) {
    std::size_t size = bytes.size();
    if (datagrams && size > kMaxDatagramSize) {
      const std::size_t end = bytes.rfind('\n', kMaxDatagramSize);
      size = end == std::string_view::npos ? size : end + 1;
    }
    TRY(sink.write(bytes.substr(0, size)));
    bytes.remove_prefix(size);
  }
  return {};
}

}  // namespace

Result<int> play(const Clip& given, const PlayOptions& options,
                 const std::function<bool()>& is_stopped) {
  TRY_ASSIGN(const StreamAddress to, parse_address(options.to));
  TRY_ASSIGN(const StreamFormat* format, find_stream_format(to.format));
  if (format->encoder == nullptr) {
    return usage_failure("nothing plays the format " + std::string(format->name));
  }
  std::optional<Clip> human;
  if (format->plays_human != nullptr && format->plays_human(given)) {
    TRY_ASSIGN(human, clip_of_human_bones(given, options.human, options.data_folder));
  }
  const Clip& clip = human ? *human : given;
  const auto encoder = format->encoder();
  TRY_ASSIGN(ByteSink sink, ByteSink::open(to));
  const std::string header = encoder->begin(clip);
  if (options.header) TRY(send_lines(sink, header));
  const auto begin = std::chrono::steady_clock::now();
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    if (options.speed > 0.0) {
      const std::chrono::duration<double> time(clip.rate().time_of(frame) / options.speed);
      wait_until(begin + std::chrono::duration_cast<std::chrono::nanoseconds>(time), is_stopped);
    }
    if (is_stopped && is_stopped()) return frame;
    TRY_ASSIGN(const std::string bytes, encoder->frame(clip, frame));
    TRY(sink.write(bytes));
  }
  return clip.frame_count();
}

}  // namespace retarget
