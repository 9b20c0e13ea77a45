#pragma once

#include <string>
#include <string_view>

namespace retarget {

/// What a file is that does not begin as a BVH file does.
struct ForeignFile {
  std::string what;  ///< For `found ...`: `a web page`, `UTF-16 text`.
  std::string hint;  ///< What to do about it.
};

/// Whether bytes are an archive of USD (USDZ).
[[nodiscard]] bool is_usd_archive(std::string_view bytes);

/// Recognises by their first bytes the files that people give in place of a BVH file: an empty
/// one, UTF-16, a git-LFS pointer, a web page, archives, FBX, ... `what` is empty for others.
[[nodiscard]] ForeignFile recognise_foreign_file(std::string_view bytes);

}  // namespace retarget
