#include "retarget/clip.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace retarget {

std::string_view channel_name(Channel channel) {
  static constexpr std::array<std::string_view, 9> kNames = {"Xposition", "Yposition", "Zposition",
                                                             "Xrotation", "Yrotation", "Zrotation",
                                                             "Xscale",    "Yscale",    "Zscale"};
  return kNames[static_cast<std::size_t>(channel)];
}

bool Joint::has_position_channels() const {
  return std::any_of(channels.begin(), channels.end(), is_position);
}

Skeleton::Skeleton(std::vector<Joint> joints) : joints_(std::move(joints)) {
  translation_slots_.reserve(joints_.size());
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    assert(joints_[i].parent < static_cast<int>(i));
    translation_slots_.push_back(joints_[i].has_position_channels() ? translated_count_++ : -1);
    channel_count_ += static_cast<int>(joints_[i].channels.size());
  }
}

std::optional<int> Skeleton::find(std::string_view name) const {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (joints_[i].name == name) return static_cast<int>(i);
  }
  return std::nullopt;
}

std::vector<std::string> Skeleton::names() const {
  std::vector<std::string> all;
  all.reserve(joints_.size());
  for (const Joint& joint : joints_) all.push_back(joint.name);
  return all;
}

}  // namespace retarget
