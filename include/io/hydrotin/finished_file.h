#pragma once

#include <filesystem>

/// A file that is complete or absent under its final name.
///
/// Everything is written under `temporary()`, beside the final name and with its extension, so that a rename replaces
/// the old file in one step: a good old result is there until the new one is complete. A leftover of a killed program
/// is overwritten by the next try.
///
/// Threads  One object per file; different objects are independent.

namespace hydrotin {

/// The name under which `final_path` is written: ".part." before the file name, so that no pattern for results finds
/// it.
[[nodiscard]] std::filesystem::path temporary_name(const std::filesystem::path& final_path);

/// Syncs `temporary` to the disk, renames it to `final_path` and syncs the folder.
/// Fails: Error(storage) with the system's reason.
void publish_file(const std::filesystem::path& temporary, const std::filesystem::path& final_path);

/// Owner of one temporary file: published on request, removed otherwise.
class FinishedFile {
 public:
  /// Makes the folder of `final_path` if need be and removes a leftover of an earlier try. Fails: Error(storage).
  explicit FinishedFile(std::filesystem::path final_path);
  ~FinishedFile();
  FinishedFile(const FinishedFile&) = delete;
  FinishedFile& operator=(const FinishedFile&) = delete;

  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
  [[nodiscard]] const std::filesystem::path& final_path() const { return final_path_; }

  /// The writer has closed the temporary file: gives it its final name. Fails: Error(storage).
  void publish();

 private:
  std::filesystem::path final_path_;
  std::filesystem::path temporary_;
  bool published_ = false;
};

}  // namespace hydrotin
