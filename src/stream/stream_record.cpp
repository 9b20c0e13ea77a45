#include "stream/stream_record.h"

#include <fmt/format.h>

#include <utility>

#include "base/number_text.h"

namespace retarget {
namespace {

constexpr std::size_t kMaxPacket = std::size_t{4} << 20;  // bytes

bool is_event(char letter) {
  return letter == 'P' || letter == 'S' || letter == 'C' || letter == 'E';
}

}  // namespace

Result<StreamRecorder> StreamRecorder::create(const std::string& file) {
  StreamRecorder recorder;
  recorder.name_ = file;
  recorder.file_.open(file, std::ios::binary | std::ios::trunc);
  if (!recorder.file_) return run_failure(file, "the recording cannot be written");
  return recorder;
}

void StreamRecorder::add(StreamEvent event, std::int64_t microseconds, std::string_view bytes) {
  file_ << static_cast<char>(event) << ' ' << microseconds << ' ' << bytes.size() << '\n'
        << bytes << '\n';
}

Result<void> StreamRecorder::finish() {
  file_.close();
  if (file_.fail()) return run_failure(name_, "the recording could not be written whole");
  return {};
}

Result<StreamReplay> StreamReplay::open(const std::string& file) {
  StreamReplay replay;
  replay.name_ = file;
  replay.file_.open(file, std::ios::binary);
  if (!replay.file_) return input_failure(file, "there is no recording");
  return replay;
}

Result<bool> StreamReplay::next(Entry& entry) {
  constexpr std::size_t kMaxLine = 64;
  std::string line;
  for (char c = 0; line.size() < kMaxLine && file_.get(c) && c != '\n';) line += c;
  if (line.empty() && file_.eof()) return false;
  const auto bad = [&] {
    return input_failure(name_,
                         fmt::format("expected an event of a recording behind {} us", latest_));
  };
  const std::size_t blank = line.find(' ', 2);
  if (line.size() < 5 || !is_event(line[0]) || line[1] != ' ' || blank == std::string::npos) {
    return bad();
  }
  const auto time = parse_number<std::int64_t>(std::string_view(line).substr(2, blank - 2));
  const auto size = parse_number<std::size_t>(std::string_view(line).substr(blank + 1));
  if (!time || !size || *time < latest_ || *size > kMaxPacket) return bad();
  entry.event = static_cast<StreamEvent>(line[0]);
  entry.microseconds = latest_ = *time;
  entry.bytes.resize(*size);
  file_.read(entry.bytes.data(), static_cast<std::streamsize>(*size));
  if (!file_ || file_.get() != '\n') return bad();
  return true;
}

}  // namespace retarget
