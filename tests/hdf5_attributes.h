#pragma once

#include <gtest/gtest.h>
#include <hdf5.h>

#include <cstdint>
#include <string>
#include <type_traits>

/// Changes in HDF5 files that no writer of ours would make.

namespace hydrotin::testing {

/// Gives an attribute of the file, which must be there, another number.
template <class T>
void set_attribute(const std::string& path, const std::string& name, T value) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  const hid_t attribute = H5Aopen(file, name.c_str(), H5P_DEFAULT);
  ASSERT_GE(attribute, 0);
  ASSERT_GE(H5Awrite(attribute, std::is_same_v<T, double> ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64, &value), 0);
  H5Aclose(attribute);
  H5Fclose(file);
}

/// Gives one entry of an array of i32 another value; the checksums of the file fit it.
inline void set_entry(const std::string& path, const std::string& name, std::uint64_t index, std::int32_t value) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  const hid_t array = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
  ASSERT_GE(array, 0);
  const hid_t space = H5Dget_space(array);
  const hsize_t start = index, count = 1;
  ASSERT_GE(H5Sselect_hyperslab(space, H5S_SELECT_SET, &start, nullptr, &count, nullptr), 0);
  const hid_t one = H5Screate_simple(1, &count, nullptr);
  ASSERT_GE(H5Dwrite(array, H5T_NATIVE_INT32, one, space, H5P_DEFAULT, &value), 0);
  H5Sclose(one);
  H5Sclose(space);
  H5Dclose(array);
  H5Fclose(file);
}

}  // namespace hydrotin::testing
