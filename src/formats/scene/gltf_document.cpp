#include "formats/scene/gltf_document.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

#include "base/json.h"
#include "base/try.h"
#include "motion/clip.h"
#include "retarget/bytes.h"
#include "retarget/file_endings.h"
#include "retarget/text.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Limits on numbers that refer to the same bytes repeatedly.
constexpr std::size_t kMaxReadings = 64;
constexpr std::size_t kFreeNumberBytes = std::size_t{64} << 20U;

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  return static_cast<std::uint32_t>(gltf_number(bytes.substr(at), GltfComponent::kUint32));
}

std::optional<std::size_t> size_of(const nlohmann::ordered_json& object, const char* key,
                                   std::size_t missing) {
  const auto found = object.find(key);
  return found == object.end() ? std::optional(missing) : value_from<std::size_t>(*found);
}

// Decodes percent escapes such as %20.
std::string unescaped(std::string_view uri) {
  std::string text;
  const auto digit = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    const char small = static_cast<char>(c | 0x20);
    return small >= 'a' && small <= 'f' ? small - 'a' + 10 : -1;
  };
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool is_code =
        uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0;
    text += is_code ? static_cast<char>(digit(uri[i + 1]) * 16 + digit(uri[i + 2])) : uri[i];
    if (is_code) i += 2;
  }
  return text;
}

// The file of a relative name, if it lies in the folder with symbolic links resolved.
std::optional<fs::path> file_inside(const fs::path& folder, const std::string& name) {
  const fs::path relative(name);
  if (name.empty() || name.find('\0') != std::string::npos || name.find(':') != std::string::npos ||
      relative.is_absolute()) {
    return std::nullopt;
  }
  std::error_code error;
  const fs::path inside = fs::weakly_canonical(folder.empty() ? fs::path(".") : folder, error);
  const fs::path file = fs::weakly_canonical(inside / relative, error);
  const fs::path way = file.lexically_relative(inside);
  if (error || way.empty() || *way.begin() == "..") return std::nullopt;
  return file;
}

// The file of a buffer's relative name.
std::optional<fs::path> buffer_file(const std::string& file_name, const std::string& uri) {
  return file_inside(fs::path(file_name).parent_path(), unescaped(uri));
}

}  // namespace

std::vector<fs::path> companion_files(const std::string& path) {
  if (ending_of(path) != ".gltf") return {};
  const auto content = read_file(path, ErrorKind::kInput, kMaxTextBytes);
  if (!content) return {};
  const auto document = GltfDocument::open(content->view(), path, 0);
  if (!document) return {};
  std::vector<fs::path> files;
  for (const GltfJson& buffer : document->list("buffers")) {
    const GltfJson* uri = gltf_member(buffer, "uri");
    if (uri == nullptr || !uri->is_string()) continue;
    const auto file = buffer_file(path, uri->get_ref<const std::string&>());
    if (file && is_file(*file)) files.push_back(*file);
  }
  std::ranges::sort(files);
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

const GltfJson* gltf_member(const GltfJson& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

Failure GltfDocument::fault(std::string what, std::string hint) const {
  return input_failure(file_name_, "the glTF file cannot be read: " + std::move(what),
                       hint.empty() ? "the file may be damaged: export it again" : std::move(hint));
}

Result<GltfDocument> GltfDocument::open(std::string_view bytes, const std::string& file_name,
                                        std::size_t max_bytes) {
  GltfDocument document;
  document.file_name_ = file_name;
  document.max_bytes_ = max_bytes;
  TRY(document.split(bytes));
  return document;
}

// Splits a GLB into its chunks; any other file is JSON.
Result<void> GltfDocument::split(std::string_view bytes) {
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
  std::string_view text = bytes;
  if (bytes.starts_with("glTF")) {
    if (bytes.size() < kHeader + kChunkHeader) return fault("it is cut off in its header");
    if (word_at(bytes, 4) != 2) {
      return fault(fmt::format("expected version 2, found version {}", word_at(bytes, 4)));
    }
    text = {};
    std::size_t at = kHeader;
    while (at + kChunkHeader <= bytes.size()) {
      const std::size_t length = word_at(bytes, at);
      const std::uint32_t kind = word_at(bytes, at + 4);
      at += kChunkHeader;
      if (length > bytes.size() - at) {
        return fault(
            fmt::format("a part of {} bytes is cut off after {}", length, bytes.size() - at),
            "the file may not have been copied completely");
      }
      if (kind == kJsonChunk && text.empty()) text = bytes.substr(at, length);
      if (kind == kBinaryChunk && !binary_) binary_ = bytes.substr(at, length);
      at += length;
    }
  }
  auto parsed = parse_json(text, file_name_);
  if (!parsed) {
    parsed.error().kind = ErrorKind::kInput;
    return failure(std::move(parsed).error());
  }
  json_ = *std::move(parsed);
  if (!json_.is_object()) return fault("its JSON is not an object");
  buffers_.resize(list("buffers").size());
  return {};
}

const GltfJson& GltfDocument::list(const char* name) const {
  static const GltfJson kEmpty = GltfJson::array();
  const auto found = json_.find(name);
  return found != json_.end() && found->is_array() ? *found : kEmpty;
}

const GltfJson* GltfDocument::element(const char* name, const GltfJson& number) const {
  const auto index = value_from<std::size_t>(number);
  const GltfJson& all = list(name);
  if (!index || *index >= all.size() || !all[*index].is_object()) return nullptr;
  return &all[*index];
}

Result<void> GltfDocument::take_bytes(std::size_t bytes) {
  if (bytes > max_bytes_ - std::min(kept_, max_bytes_)) {
    return fault("its numbers exceed the memory limit", kLargeFileHint);
  }
  kept_ += bytes;
  return {};
}

Result<std::shared_ptr<const std::string>> GltfDocument::read_buffer(const GltfJson& buffer) {
  const auto uri = buffer.find("uri");
  if (uri == buffer.end() || !uri->is_string()) {
    return fault("its buffer has no bytes; the file is probably compressed",
                 "export it without compression of meshes (meshopt, Draco)");
  }
  const auto& text = uri->get_ref<const std::string&>();
  if (text.starts_with("data:")) {
    const std::size_t comma = text.find(',');
    const bool is_base64 =
        comma != std::string::npos && std::string_view(text).substr(0, comma).ends_with(";base64");
    auto bytes = is_base64 ? bytes_from_base64(std::string_view(text).substr(comma + 1))
                           : std::optional<std::string>();
    if (!bytes) return fault("a data URI of a buffer is not valid base64");
    TRY(take_bytes(bytes->size()));
    available_ += bytes->size();
    return std::make_shared<const std::string>(*std::move(bytes));
  }
  if (file_name_ == "standard input") {
    return fault("its buffer is in a separate file, which standard input cannot provide",
                 "give the file by its name, or as GLB");
  }
  const std::string name = unescaped(text);
  const auto file = buffer_file(file_name_, text);
  if (!file) {
    return fault("its buffer \"" + printable(name) + "\" is not in the folder of the file",
                 "files elsewhere are not opened: export it as GLB, which is one file");
  }
  auto& kept = files_[file->string()];
  if (kept) return kept;
  // Opening a pipe could block forever.
  if (!is_file(*file)) {
    return fault("its buffer \"" + printable(name) + "\" is missing or not a regular file",
                 "copy its accompanying files too, or export it as GLB, which is one file");
  }
  TRY_ASSIGN(const FileContent content,
             read_file(file->string(), ErrorKind::kInput, max_bytes_ - kept_, kLargeFileHint));
  TRY(take_bytes(content.view().size()));
  available_ += content.view().size();
  kept = std::make_shared<const std::string>(content.view());
  return kept;
}

Result<std::string_view> GltfDocument::buffer(const GltfJson& number) {
  const GltfJson* description = element("buffers", number);
  if (description == nullptr) return fault("it refers to a missing buffer");
  const auto index = number.get<std::size_t>();
  if (index == 0 && binary_ && !description->contains("uri")) {
    if (available_ == 0) available_ = binary_->size();
    return *binary_;
  }
  auto& read = buffers_[index];
  if (!read) {
    TRY_ASSIGN(read, read_buffer(*description));
  }
  return std::string_view(*read);
}

Result<std::string_view> GltfDocument::buffer_view(const GltfJson& number, std::size_t& stride) {
  const GltfJson* view = element("bufferViews", number);
  if (view == nullptr) return fault("it refers to a missing buffer view");
  if (const auto extensions = view->find("extensions");
      extensions != view->end() && extensions->is_object() && !extensions->empty()) {
    return fault("its numbers are compressed (" + printable(extensions->begin().key()) + ")",
                 "export it without compression, or undo it with gltf-transform or gltfpack -c");
  }
  const auto which = view->find("buffer");
  const auto offset = size_of(*view, "byteOffset", 0), length = size_of(*view, "byteLength", 0);
  const auto step = size_of(*view, "byteStride", 0);
  if (which == view->end() || !offset || !length || !step) {
    return fault("a buffer view has no valid range in a buffer");
  }
  TRY_ASSIGN(const std::string_view bytes, buffer(*which));
  if (*offset > bytes.size() || *length > bytes.size() - *offset) {
    return fault(fmt::format("a buffer view ends {} bytes after byte {} of {}", *length, *offset,
                             bytes.size()),
                 "the file may not have been copied completely");
  }
  stride = *step;
  return bytes.substr(*offset, *length);
}

Result<GltfDocument::Run> GltfDocument::run_of(const GltfJson& view, const GltfJson& place,
                                               std::size_t count, std::size_t element_bytes) {
  std::size_t stride = 0;
  TRY_ASSIGN(const std::string_view bytes, buffer_view(view, stride));
  if (stride == 0) stride = element_bytes;
  const auto offset = size_of(place, "byteOffset", 0);
  if (!offset || *offset > bytes.size()) return fault("an accessor starts beyond its buffer view");
  const std::string_view rest = bytes.substr(*offset);
  if (count > 0 && (stride < element_bytes || rest.size() < element_bytes ||
                    (rest.size() - element_bytes) / stride < count - 1)) {
    return fault(fmt::format("{} elements of {} bytes exceed their {} bytes", count, element_bytes,
                             rest.size()));
  }
  return Run{rest, stride};
}

Result<std::vector<double>> GltfDocument::numbers(const GltfJson& number, int width) {
  const GltfJson* accessor = element("accessors", number);
  if (accessor == nullptr) return fault("it refers to a missing accessor");
  const auto layout = gltf_layout(*accessor);
  const auto count = size_of(*accessor, "count", 0);
  if (!layout || layout->width != width || !count) {
    return fault(fmt::format("expected an accessor with elements of {} numbers", width));
  }
  // The products below fit into std::size_t, which has 32 bits in WebAssembly.
  constexpr std::size_t kMost = std::size_t{1} << (sizeof(std::size_t) > 4 ? 32U : 24U);
  const std::size_t all = std::min(*count, kMost) * static_cast<std::size_t>(width);
  const auto view = accessor->find("bufferView");
  std::vector<double> result;
  if (view != accessor->end()) {
    TRY_ASSIGN(const Run run, run_of(*view, *accessor, *count, layout->bytes()));
    taken_ += all * sizeof(double);
    TRY(take_bytes(all * sizeof(double)));
    if (taken_ > kFreeNumberBytes + kMaxReadings * available_) {
      return fault("it reads the same bytes too often");
    }
    result.reserve(all);
    for (std::size_t i = 0; i < *count; ++i) {
      layout->append(run.bytes.substr(i * run.stride), result);
    }
  } else {
    taken_ += all * sizeof(double);
    TRY(take_bytes(all * sizeof(double)));
    if (taken_ > kFreeNumberBytes) return fault("too many numbers have no data");
    result.resize(all, 0.0);
  }
  if (const auto sparse = accessor->find("sparse"); sparse != accessor->end()) {
    TRY(replace_sparse(*sparse, *accessor, width, result));
  }
  if (!std::ranges::all_of(result, [](double value) { return std::isfinite(value); })) {
    return fault("a number is not finite");
  }
  return result;
}

// Replaces single elements by the values of a sparse accessor.
Result<void> GltfDocument::replace_sparse(const GltfJson& sparse, const GltfJson& accessor,
                                          int width, std::vector<double>& numbers) {
  const auto layout = gltf_layout(accessor);
  const GltfJson kNone;
  const auto member = [&](const GltfJson& object, const char* key) -> const GltfJson& {
    const GltfJson* found = gltf_member(object, key);
    return found == nullptr ? kNone : *found;
  };
  const GltfJson& places = member(sparse, "indices");
  const GltfJson& values = member(sparse, "values");
  const auto count = value_from<std::size_t>(member(sparse, "count"));
  const auto kind = gltf_component(member(places, "componentType"));
  if (!count || !kind || !values.is_object() || !layout)
    return fault("a sparse accessor is invalid");
  GltfLayout index_layout{*kind, 1, 1, false};
  TRY_ASSIGN(const Run indices,
             run_of(member(places, "bufferView"), places, *count, index_layout.bytes()));
  TRY_ASSIGN(const Run elements,
             run_of(member(values, "bufferView"), values, *count, layout->bytes()));
  std::vector<double> element;
  for (std::size_t i = 0; i < *count; ++i) {
    const double at = gltf_number(indices.bytes.substr(i * indices.stride), *kind);
    const double before = static_cast<double>(numbers.size()) / width;
    if (!(at >= 0.0 && at < before)) return fault("a sparse accessor replaces missing elements");
    element.clear();
    layout->append(elements.bytes.substr(i * elements.stride), element);
    std::ranges::copy(element, numbers.begin() + static_cast<std::ptrdiff_t>(at) * width);
  }
  return {};
}

}  // namespace retarget
