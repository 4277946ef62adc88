#pragma once

#include <cstdint>
#include <string>

/// Checksum of all bytes of a file, unused ones included: the checksums inside an HDF5 file do not reach those.

namespace hydrotin {

/// 64 bits; any single changed byte changes it. Streams: O(file) time, 1 MiB of memory.
/// Fails: Error(storage) if the file cannot be read.
[[nodiscard]] std::uint64_t file_checksum(const std::string& path);

}  // namespace hydrotin
