#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

/// The real data beside the checkout.
namespace hydrotin::testing {

inline std::string shared_path(const std::string& name) {
  return std::string(HYDROTIN_SHARED) + "/data/" + name;
}

inline bool has_shared_data() {
  return std::filesystem::exists(shared_path("MANIFEST.md"));
}

}  // namespace hydrotin::testing

#define HYDROTIN_REQUIRE_SHARED_DATA() \
  if (!hydrotin::testing::has_shared_data()) GTEST_SKIP() << "skipped: no ../shared"
