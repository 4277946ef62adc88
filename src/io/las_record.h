#pragma once

#include <cstddef>
#include <cstdint>

#include "hydrotin/las.h"
#include "las_bytes.h"

// From point records to flat arrays.

namespace hydrotin {

inline void resize(PointBatch& batch, std::size_t count, PointFields fields) {
  for (auto* coordinate : {&batch.x, &batch.y, &batch.z}) coordinate->resize(count);
  batch.classification.resize(fields.classification ? count : 0);
  batch.flags.resize(fields.flags ? count : 0);
  batch.return_number.resize(fields.returns ? count : 0);
  batch.number_of_returns.resize(fields.returns ? count : 0);
}

// Writes records to entries first .. first + count of the batch, which are there.
inline void unpack_records(const std::uint8_t* record, std::size_t count, std::size_t record_length, bool format_14,
                           PointFields fields, PointBatch& batch, std::size_t first) {
  for (std::size_t i = first; i < first + count; ++i, record += record_length) {
    batch.x[i] = load<std::int32_t>(record);
    batch.y[i] = load<std::int32_t>(record + 4);
    batch.z[i] = load<std::int32_t>(record + 8);
    const std::uint8_t returns = record[14], b15 = record[15];
    if (format_14) {
      if (fields.classification) batch.classification[i] = record[16];
      if (fields.flags) batch.flags[i] = b15 & 15U;
      if (fields.returns) {
        batch.return_number[i] = returns & 15U;
        batch.number_of_returns[i] = returns >> 4U;
      }
    } else {
      if (fields.classification) batch.classification[i] = b15 & 31U;
      if (fields.flags) batch.flags[i] = b15 >> 5U;  // synthetic, key-point, withheld: the order of PointFlag
      if (fields.returns) {
        batch.return_number[i] = returns & 7U;
        batch.number_of_returns[i] = (returns >> 3U) & 7U;
      }
    }
  }
}

}  // namespace hydrotin
