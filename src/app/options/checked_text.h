#pragma once

#include <string>
#include <utility>

#include "base/try.h"
#include "retarget/error.h"
#include "retarget/option_table.h"

namespace retarget {

/// A row whose member keeps the given text.
/// @tparam kParse  accepts or refuses a text that is not empty.
template <auto kParse>
Option checked_text(std::string name, std::string& member, std::string group, std::string type,
                    std::string help, OptionInfo info) {
  const auto check = [](const std::string& text) -> Result<std::string> {
    if (!text.empty()) TRY(kParse(text));
    return text;
  };
  return text_option<std::string>(
      std::move(name), member, std::move(group), std::move(type), std::move(help),
      [](const std::string& text) { return text; }, check, info);
}

}  // namespace retarget
