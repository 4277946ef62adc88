#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

// A file of GDAL's virtual file system, read at any place by any thread: each read borrows a handle of its own.

namespace hydrotin {

class LasSource {
 public:
  explicit LasSource(std::string path);
  ~LasSource();
  LasSource(const LasSource&) = delete;
  LasSource& operator=(const LasSource&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }

  // Reads exactly `count` bytes; fails when they are not there.
  void read(std::uint64_t offset, std::uint8_t* to, std::size_t count) const;

 private:
  [[nodiscard]] void* borrow() const;

  std::string path_;
  std::uint64_t size_ = 0;
  mutable std::mutex mutex_;
  mutable std::vector<void*> idle_;
};

}  // namespace hydrotin
