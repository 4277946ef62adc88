#include "gdal_calls.h"

#include <cpl_conv.h>

#include <mutex>

namespace hydrotin::gdal {

void register_drivers() {
  static std::once_flag once;
  std::call_once(once, [] { GDALAllRegister(); });
}

MessageTrap::MessageTrap() {
  CPLErrorReset();
  CPLPushErrorHandlerEx(&MessageTrap::handle, this);
}

MessageTrap::~MessageTrap() {
  CPLPopErrorHandler();
}

void CPL_STDCALL MessageTrap::handle(CPLErr level, CPLErrorNum, const char* text) {
  auto* trap = static_cast<MessageTrap*>(CPLGetErrorHandlerUserData());
  if (level >= CE_Failure && trap->failure_.empty()) trap->failure_ = text;
}

void MessageTrap::fail(ErrorKind kind, const std::filesystem::path& path, const std::string& what,
                       const std::string& remedy) const {
  std::string text = path.string() + ": " + what;
  if (!failure_.empty()) text += ": " + failure_;
  if (!remedy.empty()) text += " (" + remedy + ")";
  throw Error(kind, text);
}

void close_written(Dataset dataset, const MessageTrap& trap, const std::filesystem::path& path) {
  GDALFlushCache(dataset.get());
  dataset.reset();
  if (trap.has_failure()) trap.fail(ErrorKind::storage, path, "cannot be written", "check the disk's free space");
}

Dataset open(const std::filesystem::path& path, unsigned flags) {
  register_drivers();
  const MessageTrap trap;
  Dataset dataset(GDALOpenEx(path.c_str(), flags | GDAL_OF_READONLY, nullptr, nullptr, nullptr));
  if (!dataset) trap.fail(ErrorKind::input, path, "cannot be opened");
  return dataset;
}

char** StringList::get() {
  pointers_.clear();
  for (auto& item : items_) pointers_.push_back(item.data());
  pointers_.push_back(nullptr);
  return pointers_.data();
}

ThreadOption::ThreadOption(const char* key, const char* value) : key_(key) {
  CPLSetThreadLocalConfigOption(key, value);
}

ThreadOption::~ThreadOption() {
  CPLSetThreadLocalConfigOption(key_, nullptr);
}

}  // namespace hydrotin::gdal
