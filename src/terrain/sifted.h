#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace hydrotin {

/// Calls visit(v) for those of a list for which is_wanted(v), in their order.
///
/// Which neighbours of a vertex a flood wants is not to be foreseen, and a branch that is guessed wrong costs as much
/// as the neighbour itself. So the wanted ones are collected first, without a branch for each. is_wanted is asked for
/// up to kSiftedAtOnce of them before these are visited.
inline constexpr std::size_t kSiftedAtOnce = 32;

template <class IsWanted, class Visit>
void for_each_of(std::span<const std::uint32_t> list, IsWanted is_wanted, Visit visit) {
  std::array<std::uint32_t, kSiftedAtOnce> wanted;
  for (std::size_t begin = 0; begin < list.size(); begin += kSiftedAtOnce) {
    const std::size_t end = std::min(list.size(), begin + kSiftedAtOnce);
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i) {
      wanted[count] = list[i];
      count += is_wanted(list[i]) ? 1 : 0;
    }
    for (std::size_t i = 0; i < count; ++i) visit(wanted[i]);
  }
}

}  // namespace hydrotin
