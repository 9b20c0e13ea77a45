#pragma once

#include <cstdint>
#include <string_view>

namespace retarget {

/// Type of a file's content.
enum class FileKind : std::uint8_t {
  kOther,    ///< None of the types below; CSVs and other plain text.
  kForeign,  ///< A known type that no reader supports.
  kBvh,
  kFbx,
  kGltf,  ///< GLB, glTF or VRM.
  kMvnx,
  kNpz,  ///< A ZIP archive of neither PyTorch nor USD.
  kTorch,
  kNpy,
  kPickle,  ///< Also a zlib stream, which joblib writes.
  kGzip,    ///< A pickle of joblib or any other compressed file.
};

struct FileType {
  FileKind kind = FileKind::kOther;
  std::string_view what;  ///< Completes the message `found ...`: `a web page`; empty for kOther.
  std::string_view hint;  ///< Remedy for users who expected a motion; may be empty.
};

/// Detects the type of a file by its content. Every reader calls this function, so a file has the
/// same type for all of them.
[[nodiscard]] FileType file_type(std::string_view bytes);

/// The fault of a file of an unknown type whose name announces a binary type: `not an NPZ file: no
/// ZIP header`. Empty for names of text files, whose readers explain more.
/// @param ending  extension with its dot, in lower case
[[nodiscard]] std::string_view missing_header(std::string_view ending);

inline constexpr const char* kWrongEndingHint =
    "the file may be damaged, or its name may have the wrong extension";

}  // namespace retarget
