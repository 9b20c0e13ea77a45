#pragma once

#include <span>
#include <string>
#include <string_view>

namespace retarget {

/// A file of viewer/ as the build took it in (cmake/PageAssets.cmake); all are ASCII.
struct PageAsset {
  std::span<const std::string_view> pieces;  ///< Compilers bound the length of one string.
  std::string_view sha256;                   ///< Of the whole, in hexadecimal digits.

  [[nodiscard]] std::string text() const;
  /// As a content security policy names it: `'sha256-...'`.
  [[nodiscard]] std::string policy_source() const;
};

extern const PageAsset kPageShell;   ///< page.html, with marks for what goes into it.
extern const PageAsset kPageStyle;   ///< page.css
extern const PageAsset kPageScript;  ///< dist/viewer.js

}  // namespace retarget
