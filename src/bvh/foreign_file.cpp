#include "bvh/foreign_file.h"

#include <array>

#include "bvh/source_text.h"

namespace retarget {
namespace {

struct Signature {
  std::string_view prefix;  // compared without case
  std::string_view what;
  std::string_view hint;
};

constexpr std::string_view kLfsHint =
    "git-LFS has not fetched the file itself: run `git lfs pull` in the repository it comes from";
constexpr std::string_view kWebHint =
    "the download returned a web page instead of the file: use the link to the raw file";
constexpr std::string_view kUnpackHint = "unpack it and give the .bvh file inside";
constexpr std::string_view kFbxHint = "export the motion as BVH, for instance from Blender";

constexpr std::array kSignatures = {
    Signature{"version https://git-lfs", "a git-LFS pointer", kLfsHint},
    Signature{"<!doctype html", "a web page", kWebHint},
    Signature{"<html", "a web page", kWebHint},
    Signature{"<head", "a web page", kWebHint},
    Signature{"<?xml", "an XML document", "export the motion as BVH"},
    Signature{"Kaydara FBX Binary", "a binary FBX file", kFbxHint},
    Signature{"; FBX", "a text FBX file", kFbxHint},
    Signature{"glTF", "a binary glTF file", kFbxHint},
    Signature{"\x1f\x8b", "a gzip archive", kUnpackHint},
    Signature{"PK\x03\x04", "a ZIP archive (or NPZ)", kUnpackHint},
    Signature{"7z\xbc\xaf", "a 7-Zip archive", kUnpackHint},
    Signature{"Rar!", "a RAR archive", kUnpackHint},
    Signature{"#!OML:ASF", "an Acclaim AMC file", "convert ASF and AMC to BVH first"},
    Signature{":version", "an Acclaim ASF file", "convert ASF and AMC to BVH first"},
};

bool is_utf16(std::string_view bytes) {
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff")) return true;
  // without a byte order mark: every other byte of ASCII text is zero
  return bytes.size() >= 4 && ((bytes[0] == 0 && bytes[1] != 0 && bytes[2] == 0) ||
                               (bytes[0] != 0 && bytes[1] == 0 && bytes[3] == 0));
}

}  // namespace

ForeignFile recognise_foreign_file(std::string_view bytes) {
  if (bytes.empty()) {
    return {"an empty file", "the file may not have been downloaded or written completely"};
  }
  if (is_utf16(bytes)) {
    return {"UTF-16 text", "save it as UTF-8 (or plain ASCII) text"};
  }
  std::string_view text = bytes;
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  for (const Signature& signature : kSignatures) {
    if (equal_ignoring_case(text.substr(0, signature.prefix.size()), signature.prefix)) {
      return {std::string(signature.what), std::string(signature.hint)};
    }
  }
  return {};
}

}  // namespace retarget
