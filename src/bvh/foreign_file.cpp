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
constexpr std::string_view kSceneHint =
    "export the animated skeleton from it as FBX, GLB or BVH: docs/scenes.md";
constexpr std::string_view kMarkersHint =
    "solve them onto a skeleton first, in the program that recorded them or in another, and export "
    "that "
    "as FBX or BVH";

constexpr std::array kSignatures = {
    Signature{"version https://git-lfs", "a git-LFS pointer", kLfsHint},
    Signature{"<!doctype html", "a web page", kWebHint},
    Signature{"<html", "a web page", kWebHint},
    Signature{"<head", "a web page", kWebHint},
    Signature{"<?xml", "an XML document", "export the motion as FBX, GLB or BVH"},
    Signature{"Kaydara FBX Binary", "a binary FBX file", kFbxHint},
    Signature{"; FBX", "a text FBX file", kFbxHint},
    Signature{"glTF", "a binary glTF file", kFbxHint},
    Signature{"\x1f\x8b", "a gzip archive", kUnpackHint},
    Signature{"PK\x03\x04", "a ZIP archive (or NPZ)", kUnpackHint},
    Signature{"7z\xbc\xaf", "a 7-Zip archive", kUnpackHint},
    Signature{"Rar!", "a RAR archive", kUnpackHint},
    Signature{"#!OML:ASF", "an Acclaim AMC file", "convert ASF and AMC to BVH first"},
    Signature{":version", "an Acclaim ASF file", "convert ASF and AMC to BVH first"},
    Signature{"PathFileType", "a TRC file, which holds markers and no skeleton", kMarkersHint},
    Signature{"#usda", "a USD file", kSceneHint},
    Signature{"PXR-USDC", "a USD file", kSceneHint},
    Signature{"Ogawa", "an Alembic file", kSceneHint},
    Signature{"BLENDER", "a Blender file", kSceneHint},
    Signature{"(\xb5/\xfd", "a zstd archive, as Blender files are", kSceneHint},
    Signature{"//Maya ASCII", "a Maya file", kSceneHint},
    Signature{"FOR4", "a Maya file", kSceneHint},
    Signature{"FOR8", "a Maya file", kSceneHint},
    Signature{"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "a 3ds Max file", kSceneHint},
    Signature{"\xc1\x83*\x9e", "an asset of the Unreal Engine", kSceneHint},
};

bool is_utf16(std::string_view bytes) {
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff")) return true;
  // without a byte order mark: every other byte of ASCII text is zero
  return bytes.size() >= 4 && ((bytes[0] == 0 && bytes[1] != 0 && bytes[2] == 0) ||
                               (bytes[0] != 0 && bytes[1] == 0 && bytes[3] == 0));
}

// a number of blocks, then 80
bool is_c3d(std::string_view bytes) {
  return bytes.size() >= 512 && bytes[0] > 0 && bytes[0] < ' ' && bytes[1] == 0x50;
}

}  // namespace

bool is_usd_archive(std::string_view bytes) {
  // the name of the first file in it
  constexpr std::size_t kLength = 26, kName = 30;
  if (!bytes.starts_with("PK\x03\x04") || bytes.size() < kName) return false;
  const std::size_t length = static_cast<unsigned char>(bytes[kLength]) +
                             256U * static_cast<unsigned char>(bytes[kLength + 1]);
  const std::string_view name = bytes.substr(kName, length);
  return name.ends_with(".usd") || name.ends_with(".usdc") || name.ends_with(".usda");
}

ForeignFile recognise_foreign_file(std::string_view bytes) {
  if (bytes.empty()) {
    return {"an empty file", "the file may not have been downloaded or written completely"};
  }
  if (is_utf16(bytes)) {
    return {"UTF-16 text", "save it as UTF-8 (or plain ASCII) text"};
  }
  if (is_c3d(bytes)) {
    return {"a C3D file, which holds markers and no skeleton", std::string(kMarkersHint)};
  }
  if (is_usd_archive(bytes)) return {"a USD archive", std::string(kSceneHint)};
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
