#pragma once

#include <gtest/gtest.h>

#include <string>

#include "hydrotin/error.h"

namespace hydrotin::testing {

/// The text of the error of this kind that the function must throw.
template <class Function>
std::string error_of(Function&& function, ErrorKind kind) {
  try {
    function();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return {};
}

}  // namespace hydrotin::testing
