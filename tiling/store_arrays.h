#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "store.h"

/// Arrays of a file of the store, read with doubt: what other arrays say of their sizes and values has to hold.
///
/// Errors  Error(storage) naming the file.

namespace hydrotin::store {

[[noreturn]] inline void contradicts(const std::string& path,
                                     const std::string& what = "its arrays contradict each other") {
  throw Error(ErrorKind::storage, path + ": " + what + "; delete the scratch folder and run again");
}

/// `size` elements.
template <class T>
std::vector<T> read_sized(const Reader& in, const std::string& name, std::uint64_t size) {
  if (in.size(name) != size) contradicts(in.path());
  return in.read<T>(name);
}

/// Each value is less than `end`.
template <class T>
void check_below(const Reader& in, const std::vector<T>& values, std::uint64_t end) {
  if (std::any_of(values.begin(), values.end(), [&](T value) { return value >= end; })) contradicts(in.path());
}

/// Lists of lists as CSR: NAME_begin and NAME. of(entry, flat) appends one list.
template <class T, class List, class Of>
void write_lists(Writer& out, const std::string& name, const List& lists, Of of, const std::string& meaning) {
  std::vector<std::uint64_t> begin{0};
  std::vector<T> flat;
  for (const auto& entry : lists) {
    of(entry, flat);
    begin.push_back(flat.size());
  }
  out.append(name + "_begin", begin, "offsets into " + name + ", one more than lists");
  out.append(name, flat, meaning);
}

/// `count` lists.
template <class T>
std::vector<std::vector<T>> read_lists(const Reader& in, const std::string& name, std::uint64_t count) {
  const auto begin = read_sized<std::uint64_t>(in, name + "_begin", count + 1);
  const auto flat = in.read<T>(name);
  if (begin.back() != flat.size() || !std::is_sorted(begin.begin(), begin.end())) contradicts(in.path());
  std::vector<std::vector<T>> out;
  for (std::uint64_t i = 0; i < count; ++i)
    out.emplace_back(flat.begin() + static_cast<std::ptrdiff_t>(begin[i]),
                     flat.begin() + static_cast<std::ptrdiff_t>(begin[i + 1]));
  return out;
}

/// Calls read(begin, count, numbers) for stretches of ascending numbers without gaps wider than `gap`: numbers lie in
/// begin .. begin + count - 1.
template <class Read>
void for_stretches(std::span<const std::uint32_t> number, std::uint32_t gap, Read read) {
  for (std::size_t first = 0; first < number.size();) {
    std::size_t last = first + 1;
    while (last < number.size() && number[last] - number[last - 1] <= gap) ++last;
    read(std::uint64_t{number[first]}, std::uint64_t{number[last - 1]} + 1 - number[first],
         number.subspan(first, last - first));
    first = last;
  }
}

}  // namespace hydrotin::store
