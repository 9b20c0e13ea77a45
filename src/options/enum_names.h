#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "retarget/options.h"

namespace retarget {

template <typename Enum>
using NamedValue = std::pair<Enum, std::string_view>;

/// How the values of an enum are written in options, in the order in which they are told.
std::span<const NamedValue<Method>> named_values(Method);
std::span<const NamedValue<IkEngine>> named_values(IkEngine);
std::span<const NamedValue<LeadIn>> named_values(LeadIn);
std::span<const NamedValue<Interpolation>> named_values(Interpolation);
std::span<const NamedValue<ScaleRule>> named_values(ScaleRule);
std::span<const NamedValue<RestPose>> named_values(RestPose);
std::span<const NamedValue<MotionFormat>> named_values(MotionFormat);
std::span<const NamedValue<QuaternionOrder>> named_values(QuaternionOrder);
std::span<const NamedValue<BodyPoint>> named_values(BodyPoint);
std::span<const NamedValue<Delimiter>> named_values(Delimiter);

template <typename Enum>
concept Named = requires(Enum value) {
  named_values(value);
}
&&std::is_enum_v<Enum>;

template <Named Enum>
[[nodiscard]] std::string_view enum_name(Enum value) {
  for (const auto& [known, name] : named_values(Enum())) {
    if (known == value) return name;
  }
  return {};
}

template <Named Enum>
[[nodiscard]] std::optional<Enum> enum_from_name(std::string_view name) {
  for (const auto& [value, known] : named_values(Enum())) {
    if (known == name) return value;
  }
  return std::nullopt;
}

template <Named Enum>
[[nodiscard]] std::vector<std::string> enum_names() {
  std::vector<std::string> names;
  for (const auto& [value, name] : named_values(Enum())) names.emplace_back(name);
  return names;
}

}  // namespace retarget
