#include "hydrotin/finished_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include "hydrotin/error.h"

namespace hydrotin {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const char* what, int reason) {
  throw Error(ErrorKind::storage, path.string() + ": " + what + ": " + std::strerror(reason) +
                                      " (check the disk's free space and the folder's permissions)");
}

void sync_path(const std::filesystem::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) fail(path, "cannot be opened to sync it", errno);
  const int result = ::fsync(descriptor);
  const int reason = errno;
  ::close(descriptor);
  // Some network file systems cannot sync a folder; the rename is then as durable as they make it.
  if (result != 0 && reason != EINVAL && reason != ENOTSUP) fail(path, "cannot be synced to the disk", reason);
}

}  // namespace

std::filesystem::path temporary_name(const std::filesystem::path& final_path) {
  return final_path.parent_path() / (".part." + final_path.filename().string());
}

void publish_file(const std::filesystem::path& temporary, const std::filesystem::path& final_path) {
  sync_path(temporary, O_RDONLY);
  if (::rename(temporary.c_str(), final_path.c_str()) != 0) fail(final_path, "cannot be renamed into place", errno);
  const auto folder = final_path.parent_path();
  sync_path(folder.empty() ? std::filesystem::path(".") : folder, O_RDONLY | O_DIRECTORY);
}

FinishedFile::FinishedFile(std::filesystem::path final_path)
    : final_path_(std::move(final_path)), temporary_(temporary_name(final_path_)) {
  std::error_code problem;
  const auto folder = final_path_.parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder, problem);
  if (problem) throw Error(ErrorKind::storage, folder.string() + ": cannot make this folder: " + problem.message());
  std::filesystem::remove(temporary_, problem);
  if (problem) throw Error(ErrorKind::storage, temporary_.string() + ": cannot be removed: " + problem.message());
}

FinishedFile::~FinishedFile() {
  if (published_) return;
  std::error_code ignored;  // a leftover is harmless: the next try removes it
  std::filesystem::remove(temporary_, ignored);
}

void FinishedFile::publish() {
  publish_file(temporary_, final_path_);
  published_ = true;
}

}  // namespace hydrotin
