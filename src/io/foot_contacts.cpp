#include "retarget/motion_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>

namespace retarget {
namespace {

// frame numbers times the terms of two rates pass 64 bits
__extension__ using WideInt = __int128;

}  // namespace

FootContacts resample_contacts(const FootContacts& contacts, const FrameRate& from,
                               const FrameRate& to, int frames) {
  const WideInt numerator = WideInt{from.frames} * to.seconds;
  const WideInt denominator = WideInt{from.seconds} * to.frames;
  const int last = contacts.frame_count() - 1;
  FootContacts resampled;
  if (last < 0) return resampled;
  resampled.planted.reserve(kContactNames.size() * static_cast<std::size_t>(frames));
  for (WideInt i = 0; i < frames; ++i) {
    // the nearest frame, the earlier of two that are as near
    const WideInt nearest = (2 * i * numerator + denominator - 1) / (2 * denominator);
    const auto frame = static_cast<std::ptrdiff_t>(std::min<WideInt>(nearest, last));
    const auto begin =
        contacts.planted.begin() + static_cast<std::ptrdiff_t>(kContactNames.size()) * frame;
    resampled.planted.insert(resampled.planted.end(), begin,
                             begin + static_cast<std::ptrdiff_t>(kContactNames.size()));
  }
  return resampled;
}

std::string format_contacts_csv(const FootContacts& contacts, const FrameRate& rate) {
  std::string text = "frame,time";
  for (const std::string_view name : kContactNames) text += fmt::format(",{}", name);
  text += '\n';
  for (int frame = 0; frame < contacts.frame_count(); ++frame) {
    text += fmt::format("{},{:.6f}", frame, rate.time_of(frame));
    for (std::size_t end = 0; end < kContactNames.size(); ++end) {
      text += contacts.planted[kContactNames.size() * static_cast<std::size_t>(frame) + end] != 0
                  ? ",1"
                  : ",0";
    }
    text += '\n';
  }
  return text;
}

}  // namespace retarget
