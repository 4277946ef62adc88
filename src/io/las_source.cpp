#include "las_source.h"

#include <cpl_error.h>
#include <cpl_vsi.h>

#include "hydrotin/error.h"

namespace hydrotin {

LasSource::LasSource(std::string path) : path_(std::move(path)) {
  VSIStatBufL stat;
  if (VSIStatExL(path_.c_str(), &stat, VSI_STAT_EXISTS_FLAG | VSI_STAT_NATURE_FLAG) == 0 &&
      VSI_ISDIR(stat.st_mode) != 0)
    throw Error(ErrorKind::input, path_ + ": is a folder, not a point cloud (name the LAS or LAZ files in it)");
  auto* file = static_cast<VSILFILE*>(borrow());
  if (VSIFSeekL(file, 0, SEEK_END) != 0) {
    VSIFCloseL(file);
    throw Error(ErrorKind::input, path_ + ": cannot find its size (is it a regular file?)");
  }
  size_ = VSIFTellL(file);
  idle_.push_back(file);
}

LasSource::~LasSource() {
  for (void* file : idle_) VSIFCloseL(static_cast<VSILFILE*>(file));
}

void* LasSource::borrow() const {
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      void* file = idle_.back();
      idle_.pop_back();
      return file;
    }
  }
  CPLPushErrorHandler(CPLQuietErrorHandler);
  void* file = VSIFOpenL(path_.c_str(), "rb");
  CPLPopErrorHandler();
  if (file == nullptr) throw Error(ErrorKind::input, path_ + ": cannot be opened (does it exist, and may it be read?)");
  return file;
}

void LasSource::read(std::uint64_t offset, std::uint8_t* to, std::size_t count) const {
  if (count == 0) return;
  auto* file = static_cast<VSILFILE*>(borrow());
  const bool ok = VSIFSeekL(file, offset, SEEK_SET) == 0 && VSIFReadL(to, 1, count, file) == count;
  {
    const std::lock_guard lock(mutex_);
    idle_.push_back(file);
  }
  if (!ok)
    throw Error(ErrorKind::input, path_ + ": cannot read " + std::to_string(count) + " bytes at byte " +
                                      std::to_string(offset) + " of " + std::to_string(size_) +
                                      " (the file was cut off or the connection broke: get it again)");
}

}  // namespace hydrotin
