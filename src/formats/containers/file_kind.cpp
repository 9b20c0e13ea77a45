#include "formats/containers/file_kind.h"

#include <algorithm>
#include <array>

#include "formats/containers/pickle.h"
#include "formats/containers/torch_file.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kBlanks = " \t\r\n";

struct Signature {
  std::string_view prefix;  // In lower case; compared case-insensitively, after blanks.
  std::string_view what;
  std::string_view hint;
};

constexpr std::string_view kLfsHint =
    "git-LFS has not fetched the file: run `git lfs pull` in its repository";
constexpr std::string_view kWebHint =
    "the download returned a web page instead of the file: use the link to the raw file";
constexpr std::string_view kUnpackHint = "unpack it and give the motion file inside";
constexpr std::string_view kUnsupportedHint =
    "unpack it, or dump it with joblib's compress=3 (zlib)";
constexpr std::string_view kFbxHint = "export the motion as BVH, for instance from Blender";
constexpr std::string_view kSceneHint =
    "export its animated skeleton as FBX, GLB or BVH: docs/scenes.md";
constexpr std::string_view kMarkersHint =
    "solve the markers to a skeleton first, for example in the recording software, and export it "
    "as "
    "FBX or BVH";

constexpr std::string_view kVideoHint =
    "estimate the motion in the video first, for example with GVHMR, and give its result: "
    "docs/smpl.md";
constexpr std::string_view kNoMotionHint = "give a file with the motion of a human or a robot";
constexpr std::string_view kModelHint =
    "give a motion; retarget robots add makes a robot of a model";

constexpr std::array kSignatures = {
    Signature{"version https://git-lfs", "a git-LFS pointer", kLfsHint},
    Signature{"<!doctype html", "a web page", kWebHint},
    Signature{"<html", "a web page", kWebHint},
    Signature{"<head", "a web page", kWebHint},
    Signature{"\x89png", "a PNG image", kNoMotionHint},
    Signature{"\xff\xd8\xff", "a JPEG image", kNoMotionHint},
    Signature{"gif8", "a GIF image", kNoMotionHint},
    Signature{"%pdf-", "a PDF document", kNoMotionHint},
    Signature{"\x1a"
              "e\xdf\xa3",
              "a Matroska or WebM video", kVideoHint},
    Signature{"riff", "an AVI video or a WAV sound", kVideoHint},
    Signature{"vocaloid motion data", "a VMD motion of MikuMikuDance",
              "apply it to its model, for example in Blender, and export that as FBX, GLB or BVH"},
    Signature{"format version,", "a CSV of Motive", kMarkersHint},
    Signature{"no_of_frames\t", "a TSV of Qualisys Track Manager", kMarkersHint},
    Signature{"\x89hdf", "an HDF5 file", "save its arrays with numpy.savez"},
    Signature{"bzh", "a bzip2 archive", kUnsupportedHint},
    Signature{"\xfd"
              "7zxz",
              "an xz archive", kUnsupportedHint},
    // The header of raw LZMA: the usual properties, then a dictionary size of whole 64 KiB.
    Signature{"]\0\0"sv, "an lzma archive", kUnsupportedHint},
    Signature{"\x04\"m\x18", "an lz4 archive", kUnsupportedHint},
    Signature{"7z\xbc\xaf", "a 7-Zip archive", kUnpackHint},
    Signature{"rar!", "a RAR archive", kUnpackHint},
    Signature{"#!oml:asf", "an Acclaim AMC file", "convert ASF and AMC to BVH first"},
    Signature{":version", "an Acclaim ASF file", "convert ASF and AMC to BVH first"},
    Signature{"pathfiletype", "a TRC file, which contains markers but no skeleton", kMarkersHint},
    Signature{"#usda", "a USD file", kSceneHint},
    Signature{"pxr-usdc", "a USD file", kSceneHint},
    Signature{"ogawa", "an Alembic file", kSceneHint},
    Signature{"blender", "a Blender file", kSceneHint},
    Signature{"(\xb5/\xfd", "a zstd archive, possibly a Blender file", kSceneHint},
    Signature{"//maya ascii", "a Maya file", kSceneHint},
    Signature{"for4", "a Maya file", kSceneHint},
    Signature{"for8", "a Maya file", kSceneHint},
    Signature{"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "a 3ds Max file", kSceneHint},
    Signature{"\xc1\x83*\x9e", "an Unreal Engine asset", kSceneHint},
};

static_assert(std::ranges::none_of(kSignatures,
                                   [](const Signature& signature) {
                                     return std::ranges::any_of(signature.prefix, [](char c) {
                                       return c >= 'A' && c <= 'Z';
                                     });
                                   }),
              "bytes of files are compared in lower case");

void skip_blanks(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
}

bool is_utf16(std::string_view bytes) {
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff")) return true;
  // Without a byte order mark, every other byte of ASCII text is zero.
  return bytes.size() >= 4 && ((bytes[0] == 0 && bytes[1] != 0 && bytes[2] == 0) ||
                               (bytes[0] != 0 && bytes[1] == 0 && bytes[2] != 0 && bytes[3] == 0));
}

// A C3D file begins with a block number, then the byte 0x50.
bool is_c3d(std::string_view bytes) {
  return bytes.size() >= 512 && bytes[0] > 0 && bytes[0] < ' ' && bytes[1] == 0x50;
}

// A USD archive (USDZ) shows in the name of its first file.
bool is_usd_archive(std::string_view bytes) {
  constexpr std::size_t kLength = 26, kName = 30;
  if (!bytes.starts_with("PK\x03\x04") || bytes.size() < kName) return false;
  const std::size_t length = static_cast<unsigned char>(bytes[kLength]) +
                             256U * static_cast<unsigned char>(bytes[kLength + 1]);
  const std::string_view name = bytes.substr(kName, length);
  return name.ends_with(".usd") || name.ends_with(".usdc") || name.ends_with(".usda");
}

// Text files begin with a comment of the exporter or with the first element, after other comments.
bool is_fbx_text(std::string_view bytes) {
  bytes = without_byte_order_mark(bytes);
  while (true) {
    skip_blanks(bytes);
    if (bytes.starts_with("; FBX") || bytes.starts_with("FBXHeaderExtension")) return true;
    const std::size_t line = bytes.find('\n');
    if (!bytes.starts_with(";") || line == std::string_view::npos) return false;
    bytes.remove_prefix(line);
  }
}

// Exporters write `asset` first or last; other JSON has no such member.
bool is_gltf_text(std::string_view bytes) {
  skip_blanks(bytes);
  return bytes.starts_with('{') && bytes.find("\"asset\"") != std::string_view::npos;
}

// XML without the byte order mark, comments and declarations before its first element; empty for
// other text.
std::string_view from_xml_root(std::string_view bytes) {
  bytes = without_byte_order_mark(bytes);
  while (true) {
    skip_blanks(bytes);
    if (!bytes.starts_with("<?") && !bytes.starts_with("<!")) {
      return bytes.starts_with('<') ? bytes : std::string_view();
    }
    std::string_view end = bytes.starts_with("<!--") ? "-->" : ">";
    // A document type may contain declarations in brackets.
    if (bytes.starts_with("<!DOCTYPE") && bytes.find('[') < bytes.find('>')) end = "]>";
    const std::size_t at = bytes.find(end);
    if (at == std::string_view::npos) return {};
    bytes.remove_prefix(at + end.size());
  }
}

// Whether text is an element of XML with this name.
bool is_element(std::string_view text, std::string_view name) {
  if (!text.starts_with('<') || !text.substr(1).starts_with(name)) return false;
  text.remove_prefix(1 + name.size());
  return !text.empty() && (kBlanks.find(text.front()) != std::string_view::npos ||
                           text.front() == '>' || text.front() == '/');
}

FileType xml_type(std::string_view bytes) {
  const std::string_view root = from_xml_root(bytes);
  if (root.starts_with("<mvnx")) return {FileKind::kMvnx, "an MVNX file", kFbxHint};
  if (is_element(root, "mujoco")) {
    return {FileKind::kForeign, "an MJCF model without motion", kModelHint};
  }
  if (is_element(root, "robot")) {
    return {FileKind::kForeign, "a URDF model without motion", kModelHint};
  }
  skip_blanks(bytes = without_byte_order_mark(bytes));
  if (!bytes.starts_with("<?xml")) return {};
  return {FileKind::kForeign, "an XML document", "export the motion as FBX, GLB or BVH"};
}

// The first box of MP4 and MOV; its name follows its size.
bool is_mp4(std::string_view bytes) {
  const std::string_view box = bytes.substr(0, 8);
  return box.ends_with("ftyp") || box.ends_with("moov") || box.ends_with("mdat");
}

FileType json_type(std::string_view bytes) {
  skip_blanks(bytes = without_byte_order_mark(bytes));
  std::string_view inner = bytes;
  while (inner.starts_with('[')) {
    inner.remove_prefix(1);
    skip_blanks(inner);
  }
  if (!inner.starts_with('{')) return {};
  constexpr std::size_t kSearched = 4096;
  if (bytes.substr(0, kSearched).find("\"pose_keypoints_2d\"") != std::string_view::npos) {
    return {FileKind::kForeign, "OpenPose's key points in an image (JSON)", kVideoHint};
  }
  return {FileKind::kForeign, "a JSON file",
          "save joint positions or rotations as arrays with numpy.savez: docs/positions.md"};
}

bool is_obj_vertex(std::string_view line) {
  return take_word(line) == "v" && parse_number<double>(take_word(line)).has_value();
}

// OBJ has comments, then vertices, or first the name of a material library or object.
bool is_obj(std::string_view bytes) {
  while (true) {
    skip_blanks(bytes);
    if (!bytes.starts_with('#')) break;
    take_until(bytes, '\n');
  }
  std::string_view line = take_until(bytes, '\n');
  if (is_obj_vertex(line)) return true;
  const std::string_view word = take_word(line);
  if (word != "mtllib" && word != "o") return false;
  while (!bytes.empty()) {
    if (is_obj_vertex(take_until(bytes, '\n'))) return true;
  }
  return false;
}

bool begins_with(std::string_view text, const Signature& signature) {
  return text.size() >= signature.prefix.size() &&
         lower_case(std::string(text.substr(0, signature.prefix.size()))) == signature.prefix;
}

FileType archive_type(std::string_view bytes) {
  if (is_torch_file(bytes)) return {FileKind::kTorch, "a PyTorch file", {}};
  if (is_usd_archive(bytes)) return {FileKind::kForeign, "a USD archive", kSceneHint};
  return {FileKind::kNpz, "a ZIP archive (or NPZ)", kUnpackHint};
}

struct NamedType {
  std::string_view ending, lack;
};

constexpr std::array kNamedTypes = {
    NamedType{".npz", "not an NPZ file: no ZIP header"},
    NamedType{".npy", "not an NPY file: no NumPy header"},
    NamedType{".pt", "not a PyTorch file: no ZIP header"},
    NamedType{".motion", "not a PyTorch file: no ZIP header"},
    NamedType{".pkl", "not a Python pickle: no pickle header"},
    NamedType{".pickle", "not a Python pickle: no pickle header"},
    NamedType{".p", "not a Python pickle: no pickle header"},
    NamedType{".joblib", "not a joblib file: no pickle or zlib header"},
    NamedType{".fbx", "not an FBX file: no FBX header"},
    NamedType{".glb", "not a GLB file: no glTF header"},
    NamedType{".vrm", "not a VRM file: no glTF header"},
    NamedType{".vrma", "not a VRM animation: no glTF header"},
    NamedType{".gltf", "not a glTF file: no JSON with an asset"},
    NamedType{".mvnx", "not an MVNX file: no element mvnx"},
};

}  // namespace

std::string_view missing_header(std::string_view ending) {
  const auto found = std::ranges::find(kNamedTypes, ending, &NamedType::ending);
  return found == kNamedTypes.end() ? std::string_view() : found->lack;
}

FileType file_type(std::string_view bytes) {
  if (bytes.empty()) {
    return {FileKind::kForeign, "an empty file",
            "the file may not have been downloaded or written completely"};
  }
  if (bytes.starts_with("PK")) return archive_type(bytes);
  if (bytes.starts_with("\x93NUMPY")) return {FileKind::kNpy, "a single NPY array", {}};
  if (bytes.starts_with("\x1f\x8b")) return {FileKind::kGzip, "a gzip archive", kUnpackHint};
  if (looks_like_pickle(bytes) || bytes.starts_with("(dp")) {
    return {FileKind::kPickle, "a Python pickle", {}};
  }
  if (bytes.starts_with("Kaydara FBX Binary")) {
    return {FileKind::kFbx, "a binary FBX file", kFbxHint};
  }
  if (is_fbx_text(bytes)) return {FileKind::kFbx, "a text FBX file", kFbxHint};
  if (bytes.starts_with("glTF")) return {FileKind::kGltf, "a binary glTF file (GLB)", kFbxHint};
  if (is_gltf_text(bytes)) return {FileKind::kGltf, "a glTF file", kFbxHint};
  const FileType xml = xml_type(bytes);
  if (xml.kind == FileKind::kMvnx) return xml;
  if (bytes.substr(0, 64).find("HIERARCHY") != std::string_view::npos) {
    return {FileKind::kBvh, "a BVH file", {}};
  }
  if (is_utf16(bytes)) {
    return {FileKind::kForeign, "UTF-16 text", "save it as UTF-8 (or plain ASCII) text"};
  }
  if (is_c3d(bytes)) {
    return {FileKind::kForeign, "a C3D file, which contains markers but no skeleton", kMarkersHint};
  }
  if (is_mp4(bytes)) return {FileKind::kForeign, "a video (MP4 or MOV)", kVideoHint};
  for (const FileType type : {xml, json_type(bytes)}) {
    if (!type.what.empty()) return type;
  }
  if (is_obj(bytes)) {
    return {FileKind::kForeign, "an OBJ mesh, which contains no skeleton", kNoMotionHint};
  }
  std::string_view text = without_byte_order_mark(bytes);
  skip_blanks(text);
  for (const Signature& signature : kSignatures) {
    if (begins_with(text, signature)) {
      return {FileKind::kForeign, signature.what, signature.hint};
    }
  }
  return {};
}

}  // namespace retarget
