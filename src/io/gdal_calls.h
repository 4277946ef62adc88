#pragma once

#include <cpl_error.h>
#include <gdal.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hydrotin/error.h"

/// What every caller of GDAL in this room needs: drivers registered once, messages caught, handles owned.

namespace hydrotin::gdal {

/// Registers GDAL's drivers once per process; safe from any thread.
void register_drivers();

/// Keeps GDAL quiet in this thread while alive and remembers its first failure.
class MessageTrap {
 public:
  MessageTrap();
  ~MessageTrap();
  MessageTrap(const MessageTrap&) = delete;
  MessageTrap& operator=(const MessageTrap&) = delete;

  [[nodiscard]] bool has_failure() const { return !failure_.empty(); }
  void clear() { failure_.clear(); }
  /// Throws "path: what: GDAL's first message (remedy)".
  [[noreturn]] void fail(ErrorKind kind, const std::filesystem::path& path, const std::string& what,
                         const std::string& remedy = {}) const;

 private:
  static void CPL_STDCALL handle(CPLErr level, CPLErrorNum number, const char* text);
  std::string failure_;
};

struct DatasetCloser {
  void operator()(GDALDatasetH dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<void, DatasetCloser>;

/// Closes a data set that was written: GDAL writes the last blocks here, so failures matter.
void close_written(Dataset dataset, const MessageTrap& trap, const std::filesystem::path& path);

/// Opens read-only. Fails: Error(input).
[[nodiscard]] Dataset open(const std::filesystem::path& path, unsigned flags);

/// Null-terminated list of C strings, as GDAL's options want them.
class StringList {
 public:
  StringList(std::initializer_list<std::string> items) : items_(items) {}
  explicit StringList(std::vector<std::string> items) : items_(std::move(items)) {}
  void add(std::string item) { items_.push_back(std::move(item)); }
  /// Valid until the next add().
  [[nodiscard]] char** get();

 private:
  std::vector<std::string> items_;
  std::vector<char*> pointers_;
};

/// Sets a configuration option of GDAL in this thread while alive.
class ThreadOption {
 public:
  ThreadOption(const char* key, const char* value);
  ~ThreadOption();
  ThreadOption(const ThreadOption&) = delete;
  ThreadOption& operator=(const ThreadOption&) = delete;

 private:
  const char* key_;
};

}  // namespace hydrotin::gdal
