#pragma once

#include <cpl_vsi.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

/// Files for reading tests, in memory.
namespace hydrotin::testing {

using Bytes = std::vector<std::uint8_t>;

inline Bytes read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

template <class T>
void poke(Bytes& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

template <class T>
T peek(const Bytes& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// A file of GDAL's memory file system that shows the bytes as they are when opened.
class MemoryFile {
 public:
  MemoryFile(const std::string& name, const Bytes& bytes) : path_("/vsimem/" + name), bytes_(bytes) {
    bytes_.reserve(1);  // never a null pointer
    VSIFCloseL(VSIFileFromMemBuffer(path_.c_str(), bytes_.data(), bytes_.size(), FALSE));
  }
  ~MemoryFile() { VSIUnlink(path_.c_str()); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  Bytes bytes_;
};

/// A file in memory whose bytes can be damaged and mended, or whose end can be cut off, without copying it each time.
class DamagedFile {
 public:
  DamagedFile(const std::string& name, Bytes sound) : path_("/vsimem/" + name), bytes_(std::move(sound)) {
    show(size());
  }
  ~DamagedFile() { VSIUnlink(path_.c_str()); }
  DamagedFile(const DamagedFile&) = delete;
  DamagedFile& operator=(const DamagedFile&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const Bytes& bytes() const { return bytes_; }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }

  /// Changes the bits of a byte that are set in `mask`.
  void flip(std::size_t at, std::uint8_t mask) {
    bytes_[at] ^= mask;
    flipped_.emplace_back(at, mask);
  }
  /// Lets the file end after `length` bytes.
  void cut(std::size_t length) { show(length); }
  /// Undoes all flips and cuts.
  void mend() {
    for (const auto& [at, mask] : flipped_) bytes_[at] ^= mask;
    flipped_.clear();
    show(size());
  }

 private:
  void show(std::size_t length) { VSIFCloseL(VSIFileFromMemBuffer(path_.c_str(), bytes_.data(), length, FALSE)); }

  std::string path_;
  Bytes bytes_;
  std::vector<std::pair<std::size_t, std::uint8_t>> flipped_;
};

}  // namespace hydrotin::testing
