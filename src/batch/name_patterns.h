#pragma once

#include <string>
#include <vector>

namespace retarget {

/// Whether a name matches a pattern of a shell: `*` any text, `?` one character, `[a-z]` one of
/// these; `*` also matches `/`.
[[nodiscard]] bool matches_pattern(const std::string& pattern, const std::string& name);

/// Paths that match a pattern of a shell, in any order; `*` does not match `/`, nor a dot at the
/// start of a name.
[[nodiscard]] std::vector<std::string> files_of_pattern(const std::string& pattern);

}  // namespace retarget
