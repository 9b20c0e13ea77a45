#pragma once

#include <zlib.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace retarget {

/// Returns the lowest `size` bytes of a number, least significant byte first.
inline std::string little_endian_bytes(std::uint64_t value, int size) {
  std::string bytes;
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i));
  return bytes;
}

/// Returns array elements as NumPy stores them: the bytes of T, little-endian.
template <typename T>
std::string element_bytes(const std::vector<T>& values) {
  static_assert(std::endian::native == std::endian::little && std::is_trivially_copyable_v<T>);
  std::string bytes(values.size() * sizeof(T), '\0');
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

/// Returns an NPY file with this dictionary as header. NumPy writes version 1; versions 2 and 3
/// have the same layout with a longer length field.
inline std::string npy_with_header(const std::string& dictionary, const std::string& data,
                                   int version = 1) {
  std::string header = dictionary;
  const int length_bytes = version == 1 ? 2 : 4;
  while ((8 + length_bytes + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  return "\x93NUMPY" + std::string{static_cast<char>(version), '\0'} +
         little_endian_bytes(header.size(), length_bytes) + header + data;
}

/// Returns an NPY file with a type such as `<f4` and a shape in Python syntax, `(2, 3)`.
inline std::string npy(const std::string& type, const std::string& shape, const std::string& data,
                       bool fortran_order = false, int version = 1) {
  return npy_with_header("{'descr': '" + type + "', 'fortran_order': " +
                             (fortran_order ? "True" : "False") + ", 'shape': " + shape + ", }",
                         data, version);
}

inline std::string shape_of(const std::vector<std::size_t>& shape) {
  std::string text = "(";
  for (const std::size_t size : shape) text += std::to_string(size) + ", ";
  return text + ")";
}

inline std::string npy_doubles(const std::vector<std::size_t>& shape,
                               const std::vector<double>& values) {
  return npy("<f8", shape_of(shape), element_bytes(values));
}

inline std::string npy_floats(const std::vector<std::size_t>& shape,
                              const std::vector<float>& values) {
  return npy("<f4", shape_of(shape), element_bytes(values));
}

/// Returns a 0-d array of type U.
inline std::string npy_text(std::string_view text) {
  std::string data;
  for (const char c : text) data += little_endian_bytes(static_cast<unsigned char>(c), 4);
  return npy("<U" + std::to_string(text.size()), "()", data);
}

/// Returns raw deflate data, as in ZIP archives.
inline std::string deflated(const std::string& bytes) {
  z_stream stream{};
  deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

/// Builds NPZ files as numpy.savez does, and malformed ones.
class NpzBuilder {
 public:
  /// How an entry is stored, and false statements in its headers.
  struct Style {
    bool compress = false;
    bool zip64_local = true;       ///< As numpy: a ZIP64 extra field in every local header.
    bool zip64_central = false;    ///< Sizes and offset in the ZIP64 extra field of the directory.
    bool data_descriptor = false;  ///< Sizes and checksum after the data, zeros before it.
    unsigned flags = 0;            ///< Additional flags.
    int method = -1;               ///< Stated method; -1: the true one.
    std::int64_t claimed_size = -1;  ///< Stated unpacked size; -1: the true one.
    std::uint32_t crc_error = 0;     ///< XORed into the checksum.
  };

  NpzBuilder& add(const std::string& name, const std::string& npy_bytes) {
    return add_entry(name + ".npy", npy_bytes, {});
  }
  NpzBuilder& add(const std::string& name, const std::string& npy_bytes, const Style& style) {
    return add_entry(name + ".npy", npy_bytes, style);
  }

  NpzBuilder& add_entry(const std::string& file, const std::string& bytes, const Style& style) {
    const std::string packed = style.compress ? deflated(bytes) : bytes;
    const auto* data = reinterpret_cast<const Bytef*>(bytes.data());
    const std::uint32_t crc =
        static_cast<std::uint32_t>(crc32(0, data, static_cast<uInt>(bytes.size()))) ^
        style.crc_error;
    const int method = style.method >= 0 ? style.method : (style.compress ? 8 : 0);
    const std::uint64_t size =
        style.claimed_size >= 0 ? static_cast<std::uint64_t>(style.claimed_size) : bytes.size();
    const unsigned flags = style.flags | (style.data_descriptor ? 8U : 0U);
    const std::uint64_t offset = bytes_.size();
    const auto common = [&](bool known, bool in64) {
      const std::uint64_t all = 0xFFFFFFFF;
      return little_endian_bytes(flags, 2) + little_endian_bytes(method, 2) +
             little_endian_bytes(0x00210000, 4) + little_endian_bytes(known ? crc : 0, 4) +
             little_endian_bytes(in64    ? all
                                 : known ? packed.size()
                                         : 0,
                                 4) +
             little_endian_bytes(in64    ? all
                                 : known ? size
                                         : 0,
                                 4) +
             little_endian_bytes(file.size(), 2);
    };
    const auto extra = [&](bool known) {
      return little_endian_bytes(1, 2) + little_endian_bytes(known ? 16 : 24, 2) +
             little_endian_bytes(size, 8) + little_endian_bytes(packed.size(), 8) +
             (known ? "" : little_endian_bytes(offset, 8));
    };
    // Append local header, data, data descriptor.
    const std::string local_extra = style.zip64_local ? extra(true) : "";
    bytes_ += "PK\x03\x04" + little_endian_bytes(45, 2) +
              common(!style.data_descriptor, style.zip64_local) +
              little_endian_bytes(local_extra.size(), 2) + file + local_extra + packed;
    if (style.data_descriptor) {
      bytes_ += "PK\x07\x08" + little_endian_bytes(crc, 4) + little_endian_bytes(packed.size(), 4) +
                little_endian_bytes(bytes.size(), 4);
    }
    // Append the entry to the directory.
    const std::string central_extra = style.zip64_central ? extra(false) : "";
    directory_ += "PK\x01\x02" + little_endian_bytes(45, 2) + little_endian_bytes(45, 2) +
                  common(true, style.zip64_central) + little_endian_bytes(central_extra.size(), 2) +
                  std::string(10, '\0') +
                  little_endian_bytes(style.zip64_central ? 0xFFFFFFFF : offset, 4) + file +
                  central_extra;
    ++count_;
    return *this;
  }

  /// Returns the whole file.
  [[nodiscard]] std::string build(bool zip64_end = false, const std::string& comment = {}) const {
    std::string bytes = bytes_ + directory_;
    if (zip64_end) {
      bytes += "PK\x06\x06" + little_endian_bytes(44, 8) + little_endian_bytes(45, 2) +
               little_endian_bytes(45, 2) + little_endian_bytes(0, 8) +
               little_endian_bytes(count_, 8) + little_endian_bytes(count_, 8) +
               little_endian_bytes(directory_.size(), 8) + little_endian_bytes(bytes_.size(), 8);
      bytes += "PK\x06\x07" + little_endian_bytes(0, 4) +
               little_endian_bytes(bytes_.size() + directory_.size(), 8) +
               little_endian_bytes(1, 4);
    }
    const std::uint64_t all = ~std::uint64_t{0};
    return bytes + "PK\x05\x06" + little_endian_bytes(0, 4) +
           little_endian_bytes(zip64_end ? all : count_, 2) +
           little_endian_bytes(zip64_end ? all : count_, 2) +
           little_endian_bytes(zip64_end ? all : directory_.size(), 4) +
           little_endian_bytes(zip64_end ? all : bytes_.size(), 4) +
           little_endian_bytes(comment.size(), 2) + comment;
  }

 private:
  std::string bytes_;
  std::string directory_;
  std::uint64_t count_ = 0;
};

}  // namespace retarget
