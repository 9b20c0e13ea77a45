#include "formats/scene/fbx_braces.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "retarget/text.h"

namespace retarget {
namespace {

// The name before the brace of a node: `Connections` in a line `Connections:  {`.
std::string_view node_name(std::string_view text, std::size_t brace) {
  const std::string_view before = text.substr(0, brace);
  const std::size_t line = before.find_last_of('\n');
  std::string_view name = line == std::string_view::npos ? before : before.substr(line + 1);
  name = name.substr(0, name.find(':'));
  name.remove_prefix(std::min(name.find_first_not_of(" \t"), name.size()));
  return name;
}

}  // namespace

Result<void> check_fbx_text(std::string_view text, const std::string& file_name) {
  std::size_t depth = 0, line = 1, opening = 0, opening_line = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char letter = text[at];
    if (letter == '\n') ++line;
    if (letter == ';') {
      // A comment; its line end counts next.
      at = std::min(text.find('\n', at), text.size()) - 1;
    } else if (letter == '"') {
      const std::size_t end = std::min(text.find('"', at + 1), text.size());
      for (; at < end; ++at) line += text[at] == '\n' ? 1 : 0;
    } else if (letter == '{') {
      if (depth == 0) {
        opening = at;
        opening_line = line;
      }
      ++depth;
    } else if (letter == '}' && depth > 0) {
      --depth;
    }
  }
  if (depth == 0) return {};
  if (text.ends_with('\n')) --line;
  Error error{ErrorKind::kInput, {file_name, line, 0}, {}, {}, {}};
  error.message = "the FBX file ends inside \"" + printable(std::string(node_name(text, opening))) +
                  "\", which begins in line " + std::to_string(opening_line);
  error.hint = "the file is truncated: copy or export it again";
  return failure(std::move(error));
}

}  // namespace retarget
