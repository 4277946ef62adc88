#pragma once

/// An integer of 128 bits: products of two 64-bit numbers, sums of many of them.

namespace hydrotin {

__extension__ using Wide = __int128;

}  // namespace hydrotin
