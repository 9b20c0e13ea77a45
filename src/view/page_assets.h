#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>

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

extern const PageAsset kGalleryShell;   ///< gallery.html, likewise.
extern const PageAsset kGalleryStyle;   ///< gallery.css
extern const PageAsset kGalleryScript;  ///< dist/gallery.js

/// A shell with what stands for its marks, which are in this order and each there once.
[[nodiscard]] std::string fill_shell(
    const PageAsset& shell, std::span<const std::pair<std::string_view, std::string>> parts);

}  // namespace retarget
