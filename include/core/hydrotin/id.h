#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>

/// Strong indices: as cheap as the integer, but a TriangleId never indexes vertices.

namespace hydrotin {

template <class Tag, class Rep = std::uint32_t>
struct Id {
  Rep value = static_cast<Rep>(-1);  ///< default: none

  [[nodiscard]] constexpr bool is_none() const { return value == static_cast<Rep>(-1); }
  friend constexpr auto operator<=>(Id, Id) = default;
};

using VertexId = Id<struct VertexTag>;      ///< local to one triangulation
using HalfedgeId = Id<struct HalfedgeTag>;  ///< local to one triangulation: 3 * triangle + corner
using TriangleId = Id<struct TriangleTag>;  ///< local to one triangulation

/// (tile, index in the tile's canonical points): the same in every file of one run, another in another tiling.
struct PointId {
  std::uint64_t value = static_cast<std::uint64_t>(-1);

  PointId() = default;
  constexpr explicit PointId(std::uint64_t bits) : value(bits) {}
  constexpr PointId(std::uint32_t tile, std::uint32_t index) : value((std::uint64_t{tile} << 32) | index) {}
  [[nodiscard]] constexpr std::uint32_t tile() const { return static_cast<std::uint32_t>(value >> 32); }
  [[nodiscard]] constexpr std::uint32_t index() const { return static_cast<std::uint32_t>(value); }
  friend constexpr auto operator<=>(PointId, PointId) = default;
};

/// A span indexed by one kind of id only; compiles to the same code as the raw span.
template <class I, class T>
class IdSpan {
 public:
  constexpr IdSpan() = default;
  template <class Range>
  requires std::convertible_to<Range&&, std::span<T>>
  constexpr IdSpan(Range&& range) : data_(std::forward<Range>(range)) {}  // NOLINT: a view is its range
  [[nodiscard]] constexpr T& operator[](I id) const { return data_[id.value]; }
  [[nodiscard]] constexpr std::size_t size() const { return data_.size(); }
  [[nodiscard]] constexpr bool empty() const { return data_.empty(); }
  [[nodiscard]] constexpr std::span<T> raw() const { return data_; }

 private:
  std::span<T> data_;
};

}  // namespace hydrotin
