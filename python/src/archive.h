#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "retarget/pose.h"

// Values as bytes, for pickles. A struct takes part through `fields(archive, value)`, which names its
// members in order; writer and reader share it, so they cannot disagree.

namespace retarget::python {

template <typename T>
inline constexpr bool kIsPlain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// Appends values to bytes. Numbers keep all their bits.
class ArchiveWriter {
 public:
  static constexpr bool kReads = false;

  template <typename... T>
  void operator()(const T&... values) {
    (write(values), ...);
  }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  void raw(const void* data, std::size_t size) {
    if (size > 0) bytes_.append(static_cast<const char*>(data), size);
  }
  void write(const std::string& text) {
    write(std::uint64_t{text.size()});
    raw(text.data(), text.size());
  }
  template <typename T>
  void write(const std::vector<T>& all) {
    write(std::uint64_t{all.size()});
    if constexpr (kIsPlain<T>) {
      raw(all.data(), all.size() * sizeof(T));
    } else {
      for (const T& each : all) write(each);
    }
  }
  template <typename T, std::size_t kSize>
  void write(const std::array<T, kSize>& all) {
    for (const T& each : all) write(each);
  }
  template <typename T>
  void write(const std::optional<T>& value) {
    write(value.has_value());
    if (value) write(*value);
  }
  template <typename T>
  void write(const std::shared_ptr<const T>& value) {
    write(value != nullptr);
    if (value) write(*value);
  }
  void write(const Eigen::Vector3d& vector) { raw(vector.data(), 3 * sizeof(double)); }
  void write(const Eigen::Quaterniond& rotation) {
    raw(rotation.coeffs().data(), 4 * sizeof(double));
  }
  void write(const Pose& pose) { (*this)(pose.rotation, pose.translation); }
  template <typename... T>
  void write(const std::variant<T...>& value) {
    write(static_cast<std::uint64_t>(value.index()));
    std::visit([this](const auto& held) { write(held); }, value);
  }
  template <typename T>
  void write(const T& value) {
    if constexpr (kIsPlain<T>) {
      raw(&value, sizeof(T));
    } else {
      // Only the reader changes the value.
      fields(*this, const_cast<T&>(value));
    }
  }

  std::string bytes_;
};

/// Reads what an ArchiveWriter wrote. After the end of the bytes, values do not change and
/// ok() is false.
class ArchiveReader {
 public:
  static constexpr bool kReads = true;

  explicit ArchiveReader(std::string_view bytes) : bytes_(bytes) {}

  template <typename... T>
  void operator()(T&... values) {
    (read(values), ...);
  }
  [[nodiscard]] bool ok() const { return ok_; }
  /// All bytes were read, and they were enough.
  [[nodiscard]] bool complete() const { return ok_ && bytes_.empty(); }
  void fail() { ok_ = false; }

 private:
  void raw(void* data, std::size_t size) {
    if (size > bytes_.size()) ok_ = false;
    if (!ok_ || size == 0) return;
    std::memcpy(data, bytes_.data(), size);
    bytes_.remove_prefix(size);
  }
  // Reads a count of items of at least `size` bytes each. A wrong count must not exhaust the
  // memory.
  std::size_t count(std::size_t size) {
    std::uint64_t number = 0;
    read(number);
    if (number > bytes_.size() / size) ok_ = false;
    return ok_ ? static_cast<std::size_t>(number) : 0;
  }
  void read(std::string& text) {
    text.resize(count(1));
    raw(text.data(), text.size());
  }
  template <typename T>
  void read(std::vector<T>& all) {
    if constexpr (kIsPlain<T>) {
      all.resize(count(sizeof(T)));
      raw(all.data(), all.size() * sizeof(T));
    } else {
      all.clear();
      for (std::size_t left = count(1); ok_ && left > 0; --left) read(all.emplace_back());
    }
  }
  template <typename T, std::size_t kSize>
  void read(std::array<T, kSize>& all) {
    for (T& each : all) read(each);
  }
  template <typename T>
  void read(std::optional<T>& value) {
    bool is_there = false;
    read(is_there);
    if (is_there) {
      read(value.emplace());
    } else {
      value.reset();
    }
  }
  template <typename T>
  void read(std::shared_ptr<const T>& value) {
    bool is_there = false;
    read(is_there);
    if (!is_there) return value.reset();
    auto made = std::make_shared<T>();
    read(*made);
    value = std::move(made);
  }
  void read(Eigen::Vector3d& vector) { raw(vector.data(), 3 * sizeof(double)); }
  void read(Eigen::Quaterniond& rotation) { raw(rotation.coeffs().data(), 4 * sizeof(double)); }
  void read(Pose& pose) { (*this)(pose.rotation, pose.translation); }
  template <typename... T>
  void read(std::variant<T...>& value) {
    std::uint64_t index = 0;
    read(index);
    std::uint64_t each = 0;
    ((each++ == index ? read(value.template emplace<T>()) : void()), ...);
    if (index >= sizeof...(T)) ok_ = false;
  }
  template <typename T>
  void read(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      unsigned char flag = 0;
      raw(&flag, 1);
      value = flag != 0;
    } else if constexpr (kIsPlain<T>) {
      raw(&value, sizeof(T));
    } else {
      fields(*this, value);
    }
  }

  std::string_view bytes_;
  bool ok_ = true;
};

}  // namespace retarget::python
