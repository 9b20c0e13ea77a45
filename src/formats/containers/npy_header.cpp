#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/try.h"
#include "formats/containers/npy.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr std::string_view kMagic("\x93NUMPY", 6);
// NumPy's own headers have about 100 bytes. A header beyond this limit is not a plain array.
constexpr std::size_t kMaxHeaderBytes = 65536;
constexpr std::size_t kMaxDimensions = 64;

// Parses the header's text, a Python dictionary: {'descr': '<f4', 'fortran_order': False, 'shape':
// (3,)}
class DictionaryParser {
 public:
  explicit DictionaryParser(std::string_view text) : text_(text) {}

  Result<NpyHeader> parse() {
    NpyHeader header;
    bool has_type = false, has_order = false, has_shape = false;
    if (!take('{')) return expected("{");
    while (!take('}')) {
      const std::optional<std::string_view> key = quoted();
      if (!key) return expected("a quoted name");
      if (!take(':')) return expected(":");
      const bool known = *key == "descr"           ? parse_type(header, has_type)
                         : *key == "fortran_order" ? parse_order(header, has_order)
                         : *key == "shape"         ? parse_shape(header, has_shape)
                                                   : false;
      if (!known) return expected("a value of " + std::string(*key));
      if (!take(',') && !at('}')) return expected(", or }");
    }
    skip_blanks();
    if (position_ != text_.size()) return expected("the end");
    if (!has_type || !has_order || !has_shape) {
      return format_failure("the NPY header lacks descr, fortran_order or shape");
    }
    return header;
  }

 private:
  void skip_blanks() {
    while (position_ < text_.size() &&
           std::string_view(" \t\r\n").find(text_[position_]) != std::string_view::npos) {
      ++position_;
    }
  }

  bool at(char wanted) {
    skip_blanks();
    return position_ < text_.size() && text_[position_] == wanted;
  }

  bool take(char wanted) {
    if (!at(wanted)) return false;
    ++position_;
    return true;
  }

  bool take_word(std::string_view word) {
    skip_blanks();
    if (!text_.substr(position_).starts_with(word)) return false;
    position_ += word.size();
    return true;
  }

  std::optional<std::string_view> quoted() {
    for (const char quote : {'\'', '"'}) {
      if (!at(quote)) continue;
      const std::size_t end = text_.find(quote, position_ + 1);
      if (end == std::string_view::npos) return std::nullopt;
      const std::string_view content = text_.substr(position_ + 1, end - position_ - 1);
      position_ = end + 1;
      return content;
    }
    return std::nullopt;
  }

  bool parse_type(NpyHeader& header, bool& found) {
    if (at('[')) {
      // The fields of a structured type; npy_layout rejects this name.
      header.type = "[...]";
      return found = skip_list();
    }
    const auto text = quoted();
    if (text) header.type = *text;
    return found = text.has_value();
  }

  // Skips a list that may contain lists, tuples and strings.
  bool skip_list() {
    int depth = 0;
    do {
      if (at('\'') || at('"')) {
        if (!quoted()) return false;
        continue;
      }
      if (position_ == text_.size()) return false;
      const char c = text_[position_++];
      depth += (c == '[' || c == '(') - (c == ']' || c == ')');
    } while (depth > 0);
    return true;
  }

  bool parse_order(NpyHeader& header, bool& found) {
    header.fortran_order = take_word("True");
    return found = header.fortran_order || take_word("False");
  }

  bool parse_shape(NpyHeader& header, bool& found) {
    header.shape.clear();
    if (!take('(')) return false;
    while (!take(')')) {
      skip_blanks();
      std::size_t size = 0;
      const char* begin = text_.data() + position_;
      const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), size);
      if (error != std::errc{} || header.shape.size() == kMaxDimensions) return false;
      position_ += end - begin;
      // Python 2 wrote long integers with this suffix.
      take_word("L");
      header.shape.push_back(size);
      if (!take(',') && !at(')')) return false;
    }
    return found = true;
  }

  Failure expected(const std::string& what) const {
    return format_failure("the NPY header is malformed: expected " + what + " at byte " +
                          std::to_string(position_));
  }

  std::string_view text_;
  std::size_t position_ = 0;
};

struct NpyType {
  NpyKind kind;
  std::size_t item_size;
  bool big_endian;
};

std::optional<NpyKind> kind_of(char letter, std::size_t size) {
  const bool power = size == 1 || size == 2 || size == 4 || size == 8;
  switch (letter) {
    case 'b':
      return size == 1 ? std::optional(NpyKind::kBool) : std::nullopt;
    case 'i':
      return power ? std::optional(NpyKind::kSigned) : std::nullopt;
    case 'u':
      return power ? std::optional(NpyKind::kUnsigned) : std::nullopt;
    case 'f':
      return power && size > 1 ? std::optional(NpyKind::kFloat) : std::nullopt;
    case 'S':
      return size > 0 ? std::optional(NpyKind::kBytes) : std::nullopt;
    case 'U':
      return size > 0 ? std::optional(NpyKind::kText) : std::nullopt;
    default:
      return std::nullopt;
  }
}

// Parses a byte order (<, >, =, |), a type letter and a size.
Result<NpyType> type_from_text(const std::string& text) {
  if (text.starts_with("|O") || text == "O") {
    return format_failure(
        "it contains Python objects (dtype object), which would require unpickling",
        "unpickling can run code from the file and is not supported; save a plain array of "
        "numbers or text");
  }
  std::size_t size = 0;
  const bool shaped =
      text.size() >= 3 && std::string_view("<>=|").find(text[0]) != std::string::npos;
  if (shaped) {
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data() + 2, end, size);
    if (error != std::errc{} || rest != end) size = 0;
  }
  const auto kind = shaped ? kind_of(text[1], size) : std::nullopt;
  constexpr std::size_t kCharacter = 4;
  if (!kind || size > std::numeric_limits<std::size_t>::max() / kCharacter) {
    return format_failure(
        "its type " + text + " is not supported",
        "supported types: booleans, integers, floats of 2, 4 and 8 bytes, and text");
  }
  return NpyType{*kind, *kind == NpyKind::kText ? kCharacter * size : size, text[0] == '>'};
}

// Bytes of all elements. Returns nothing when the product of the nonzero sizes overflows.
std::optional<std::size_t> total_size(std::span<const std::size_t> shape, std::size_t item_size) {
  std::size_t total = item_size;
  for (const std::size_t size : shape) {
    if (size == 0) continue;
    if (total > std::numeric_limits<std::ptrdiff_t>::max() / size) return std::nullopt;
    total *= size;
  }
  return std::ranges::find(shape, std::size_t{0}) == shape.end() ? total : 0;
}

}  // namespace

Failure format_failure(std::string message, std::string hint) {
  return failure({ErrorKind::kRun, {}, std::move(message), {}, std::move(hint)});
}

std::string shape_text(std::span<const std::size_t> shape) {
  std::string text = "(";
  for (std::size_t i = 0; i < shape.size(); ++i) {
    text += (i > 0 ? ", " : "") + std::to_string(shape[i]);
  }
  return text + (shape.size() == 1 ? ",)" : ")");
}

Result<NpyHeader> read_npy_header(const ReadBytes& read) {
  constexpr std::size_t kVersionBytes = 2;
  TRY_ASSIGN(const auto start, read(kMagic.size() + kVersionBytes));
  if (!start.starts_with(kMagic)) {
    return format_failure("expected an NPY array, which begins with \"\\x93NUMPY\"");
  }
  const int version = static_cast<unsigned char>(start[kMagic.size()]);
  if (version < 1 || version > 3) {
    return format_failure("expected NPY version 1, 2 or 3, found " + std::to_string(version));
  }
  const std::size_t length_bytes = version == 1 ? 2 : 4;
  TRY_ASSIGN(const auto length_text, read(length_bytes));
  const std::size_t length = little_endian(length_text, 0, length_bytes);
  if (length > kMaxHeaderBytes) {
    return format_failure("its NPY header has " + count_text(length, "byte") + ", at most " +
                          std::to_string(kMaxHeaderBytes) + " are allowed");
  }
  TRY_ASSIGN(const auto text, read(length));
  Result<NpyHeader> header = DictionaryParser(text).parse();
  if (header) header->byte_count = start.size() + length_bytes + length;
  return header;
}

Result<NpyLayout> npy_layout(const NpyHeader& header) {
  TRY_ASSIGN(const auto type, type_from_text(header.type));
  const auto size = total_size(header.shape, type.item_size);
  if (!size) {
    return format_failure("its shape " + shape_text(header.shape) + " has too many elements");
  }
  NpyLayout layout;
  layout.array = {type.kind, type.item_size, header.shape, {}};
  layout.data_size = *size;
  layout.big_endian = type.big_endian;
  return layout;
}

Result<NpyHeader> take_npy_header(std::string_view& bytes) {
  return read_npy_header([&bytes](std::size_t size) -> Result<std::string> {
    if (size > bytes.size()) {
      return format_failure("the array is cut off within its header",
                            "the file was cut off: download or copy it again");
    }
    std::string taken(bytes.substr(0, size));
    bytes.remove_prefix(size);
    return taken;
  });
}

Result<NpyArray> read_npy_rest(const NpyHeader& header, std::string_view bytes,
                               std::size_t max_number_bytes) {
  TRY_ASSIGN(auto layout, npy_layout(header));
  if (layout.data_size != bytes.size()) {
    return format_failure(
        fmt::format("its shape {} of {} needs {}, found {}", shape_text(header.shape), header.type,
                    count_text(layout.data_size, "byte"), bytes.size()),
        "the file was cut off: download or copy it again");
  }
  if (layout.data_size / layout.array.item_size > max_number_bytes / sizeof(double)) {
    return format_failure(
        fmt::format("its shape {} needs more memory than is allowed", shape_text(header.shape)),
        "split the motion");
  }
  return npy_with_data(std::move(layout), std::string(bytes), header.fortran_order);
}

}  // namespace retarget
