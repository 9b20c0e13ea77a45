// Any bytes as the packets of a stream, one per line: accepted packets must be valid, and a
// rejected packet must not affect the next one.

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "fuzz/fuzz_target.h"
#include "live/stream/stream_formats.h"
#include "live/stream/stream_record.h"

namespace retarget::fuzz {
namespace {

class CheckedSink final : public StreamSink {
 public:
  void take_skeleton(Clip clip, bool has_rest) override {
    const Skeleton& skeleton = clip.skeleton();
    require(skeleton.joint_count() > 0, "a skeleton has joints");
    require(!has_rest || clip.frame_count() > 0, "a rest pose is a frame");
    for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
      require(skeleton.joint(joint).parent < joint, "parents come first");
      require(skeleton.joint(joint).offset.allFinite(), "offsets are finite");
    }
    joints_ = static_cast<std::size_t>(skeleton.joint_count());
    translated_ = static_cast<std::size_t>(skeleton.translated_count());
  }
  void take_frame(const StreamFrame& frame) override {
    require(joints_ > 0, "a skeleton comes before its frames");
    require(frame.rotations.size() == joints_, "joints are those of the skeleton");
    require(frame.translations.size() == translated_, "and their translations");
    require(!std::isinf(frame.time), "times are finite, or none");
    for (const auto& rotation : frame.rotations) {
      require(std::abs(rotation.norm() - 1.0) < 1e-9, "rotations are of unit length");
    }
    for (const auto& translation : frame.translations) {
      require(translation.allFinite(), "translations are finite");
    }
  }

 private:
  std::size_t joints_ = 0, translated_ = 0;
};

}  // namespace

void fuzz_decoder(std::string_view format, std::string_view bytes) {
  const auto found = find_stream_format(std::string(format));
  require(found.has_value(), "the format exists");
  const auto decoder = (*found)->decoder(StreamAddress());
  CheckedSink sink;
  while (!bytes.empty()) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    const std::string_view line = bytes.substr(0, end);
    if (line == "restart") {
      decoder->restart();
    } else {
      (void)good(decoder->take(line, sink));
    }
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
  }
}

void fuzz_packets(std::string_view format, std::string_view bytes) {
  const auto found = find_stream_format(std::string(format));
  require(found.has_value(), "the format exists");
  StreamAddress connection;
  connection.transport = Transport::kTcp;
  const auto datagrams = (*found)->decoder(StreamAddress());
  const auto stream = (*found)->decoder(connection);
  CheckedSink of_datagrams, of_stream;
  while (bytes.size() >= 2) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
    const std::size_t size =
        std::min<std::size_t>(bytes.size() - 2, byte(0) * std::size_t{256} + byte(1));
    if (size == 0) datagrams->restart();
    if (size == 0) stream->restart();
    const std::string_view packet = bytes.substr(2, size);
    (void)good(datagrams->take(packet, of_datagrams));
    (void)good(stream->take(packet, of_stream));
    (void)datagrams->request();
    bytes.remove_prefix(2 + size);
  }
  datagrams->restart();
}

void fuzz_stream_record(std::string_view bytes) {
  auto replay = StreamReplay::open(file_of(bytes, "input.stream"));
  if (!good(replay)) return;
  StreamReplay::Entry entry;
  for (;;) {
    const auto next = replay->next(entry);
    if (!good(next) || !*next) return;
    require(entry.bytes.size() <= bytes.size(), "packets are in the file");
  }
}

}  // namespace retarget::fuzz
