#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace retarget {

/// A file of viewer/ embedded by the build (cmake/PageAssets.cmake); all files are ASCII.
struct PageAsset {
  std::span<const std::string_view> pieces;  ///< Several pieces, because compilers limit string
                                             ///< length.
  std::string_view sha256;                   ///< Hash of the whole file, in hexadecimal digits.

  [[nodiscard]] std::string text() const;
  /// Returns the hash as a content security policy source: `'sha256-...'`.
  [[nodiscard]] std::string policy_source() const;
};

extern const PageAsset kPageShell;   ///< page.html, with marks for the parts.
extern const PageAsset kPageStyle;   ///< page.css
extern const PageAsset kPageScript;  ///< dist/viewer.js

extern const PageAsset kGalleryShell;   ///< gallery.html, likewise.
extern const PageAsset kGalleryStyle;   ///< gallery.css
extern const PageAsset kGalleryScript;  ///< dist/gallery.js

/// Replaces the marks of a shell by the given parts. The parts must be in the order of their marks,
/// and each mark must occur exactly once.
[[nodiscard]] std::string fill_shell(
    const PageAsset& shell, std::span<const std::pair<std::string_view, std::string>> parts);

/// Name of a metric of quality_metrics() as pages show it instead of its key; the key if it is
/// unknown.
[[nodiscard]] std::string_view metric_label(std::string_view key);

}  // namespace retarget
