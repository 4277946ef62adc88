#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hydrotin/error.h"

/// The store: arrays in HDF5 files, one file per work unit's output.
///
/// A file is written under a temporary name, synced and renamed: under its final name it is complete. Should power
/// fail, the last renames may be undone, and these units are made again; `sync_folder` makes renames last. Arrays are
/// chunked, shuffled, deflated and carry Fletcher-32 checksums, so that any HDF5 tool reads them and a flipped bit is
/// found. Filters run outside the HDF5 library's global lock, so that threads compress in parallel.
///
/// Errors   Error(storage) names the file and the array.
/// Threads  Different files may be used concurrently; one object by one thread at a time.

namespace hydrotin::store {

/// Keeps all of the store's calls into the HDF5 library out while alive, save those of this thread: for others who use
/// the library.
[[nodiscard]] std::unique_lock<std::recursive_mutex> lock_library();

enum class Type : std::uint8_t { u8, i32, u32, i64, u64, f64 };

template <class T>
constexpr Type type_of() {
  if constexpr (std::is_same_v<T, std::uint8_t>)
    return Type::u8;
  else if constexpr (std::is_same_v<T, std::int32_t>)
    return Type::i32;
  else if constexpr (std::is_same_v<T, std::uint32_t>)
    return Type::u32;
  else if constexpr (std::is_same_v<T, std::int64_t>)
    return Type::i64;
  else if constexpr (std::is_same_v<T, std::uint64_t>)
    return Type::u64;
  else {
    static_assert(std::is_same_v<T, double>, "not a type of the store");
    return Type::f64;
  }
}

/// Writes one file.
class Writer {
 public:
  /// Opens a temporary file beside `path`.
  explicit Writer(const std::string& path);
  ~Writer();  ///< discards the temporary file unless `commit` was called
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// Appends to the array `name`, which is created by the first call. Shape [n]; `meaning` becomes an attribute.
  template <class T>
  void append(const std::string& name, std::span<const T> values, std::string_view meaning = {}) {
    append_bytes(name, type_of<T>(), values.data(), values.size(), meaning);
  }
  template <class T>
  void append(const std::string& name, const std::vector<T>& values, std::string_view meaning = {}) {
    append<T>(name, std::span<const T>(values), meaning);
  }
  void set(const std::string& attribute, const std::string& text);
  void set(const std::string& attribute, std::int64_t value);
  void set(const std::string& attribute, double value);

  /// Flushes, syncs and renames to the final name.
  void commit();

 private:
  void append_bytes(const std::string& name, Type type, const void* data, std::size_t count, std::string_view meaning);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads one file; everything read is checked like foreign input.
class Reader {
 public:
  explicit Reader(const std::string& path);
  ~Reader();
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;

  [[nodiscard]] const std::string& path() const;
  [[nodiscard]] bool has(const std::string& name) const;
  [[nodiscard]] std::uint64_t size(const std::string& name) const;
  template <class T>
  [[nodiscard]] std::vector<T> read(const std::string& name) const {
    std::vector<T> values(size(name));
    read_bytes(name, type_of<T>(), 0, values.size(), values.data());
    return values;
  }
  template <class T>
  void read_range(const std::string& name, std::uint64_t first, std::span<T> values) const {
    read_bytes(name, type_of<T>(), first, values.size(), values.data());
  }
  template <class T>
  [[nodiscard]] std::vector<T> read_range(const std::string& name, std::uint64_t first, std::uint64_t count) const {
    std::vector<T> values(count);
    read_bytes(name, type_of<T>(), first, count, values.data());
    return values;
  }
  [[nodiscard]] std::string text(const std::string& attribute) const;
  [[nodiscard]] std::int64_t integer(const std::string& attribute) const;
  [[nodiscard]] double real(const std::string& attribute) const;
  [[nodiscard]] bool has_attribute(const std::string& attribute) const;

 private:
  void read_bytes(const std::string& name, Type type, std::uint64_t first, std::uint64_t count, void* out) const;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Makes all renames in a folder last, also if power fails: one call for many files.
void sync_folder(const std::string& folder);

/// The attribute `recipe` of a complete file, or empty if there is no readable file.
[[nodiscard]] std::string recipe_of(const std::string& path);

}  // namespace hydrotin::store
