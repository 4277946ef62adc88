#include "file_checksum.h"

#include <cstring>
#include <fstream>
#include <vector>

#include "hydrotin/error.h"

namespace hydrotin {

std::uint64_t file_checksum(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(ErrorKind::storage, path + ": the file is missing or unreadable; run again");
  std::vector<char> buffer(1U << 20);
  // Each step is a bijection of the state for a given word, and of the word for a given state.
  std::uint64_t state = 0x9e3779b97f4a7c15ULL;
  const auto mix = [&](std::uint64_t word) {
    state = (state ^ word) * 0xd6e8feb86659fd93ULL;
    state ^= state >> 32U;
  };
  while (in) {
    in.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    const auto count = static_cast<std::size_t>(in.gcount());
    std::memset(buffer.data() + count, 0, buffer.size() - count);
    for (std::size_t i = 0; i < count; i += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, buffer.data() + i, 8);
      mix(word);
    }
    mix(count);
  }
  return state;
}

}  // namespace hydrotin
