#pragma once

#include <array>
#include <cstdint>

/// Tables 7.2, 7.3 and 7.4 of the thesis as printed: six rivers of British Columbia.

namespace hydrotin::thesis {

inline constexpr std::array<const char*, 5> kVariants{"VF", "VFR 10%", "VFRS 10%", "VFR 1deg", "VFRS 1deg"};

/// A negative number: not printed.
struct RiverVariant {
  double total;
  int moved;
  double average;
  int minima, flat, leaks;
};

struct RiverOfThesis {
  const char* name;
  int triangles, edges;
  double length_km;
  int wrong_flow, not_valley;
  int minima, flat, leaks;  ///< of the original terrain
  std::array<RiverVariant, 5> variant;
};

inline constexpr std::array<RiverOfThesis, 6> kRivers{{
    {"Goat",
     37713,
     140,
     13.49,
     32,
     47,
     142,
     36,
     32,
     {{{169, 75, 2.26, 130, 87, 7},
       {203, 125, 1.62, 112, 0, 10},
       {219, 131, 1.67, 110, 0, 7},
       {13065, 313, 41.74, 178, 0, 61},
       {44225, 1582, 27.96, 121, 0, 12}}}},
    {"Khutze",
     216648,
     407,
     34.16,
     71,
     121,
     642,
     116,
     94,
     {{{272, 181, 1.50, 622, 216, 15},
       {324, 320, 1.01, 547, 0, 11},
       {338, 334, 1.01, 547, 0, 11},
       {87649, 933, 93.94, 775, 0, 212},
       {862231, 12938, 66.64, 607, 0, 32}}}},
    {"Kiltuish",
     146091,
     281,
     22.42,
     54,
     78,
     298,
     50,
     55,
     {{{212, 105, 2.02, 289, 113, 3},
       {240, 178, 1.35, 242, 0, 4},
       {266, 197, 1.35, 238, 0, 2},
       {7474, 400, 18.68, 313, 0, 65},
       {25612, 1315, 19.48, 251, 0, 8}}}},
    {"Kowesas",
     244598,
     321,
     38.07,
     56,
     108,
     465,
     77,
     80,
     {{{246, 146, 1.69, 456, 151, 23},
       {281, 247, 1.14, 408, 0, 20},
       {297, 264, 1.12, 407, 0, 19},
       {159201, 761, 209.20, 615, 0, 221},
       {2720426, 23912, 113.77, 477, 0, 39}}}},
    {"Paril",
     20960,
     89,
     8.85,
     12,
     24,
     86,
     18,
     19,
     {{{70, 34, 2.06, 87, 38, 6},
       {91, 58, 1.57, 71, 0, 4},
       {98, 64, 1.53, 70, 0, 3},
       {947, 115, 8.24, 82, 0, 13},
       {2917, 343, 8.50, 75, 0, 5}}}},
    {"Triumph",
     20382,
     104,
     11.37,
     28,
     15,
     76,
     25,
     24,
     {{{76, 38, 1.99, 74, 45, 4},
       {90, 70, 1.28, 57, 0, 4},
       {92, 75, 1.23, 57, 0, 4},
       {1083, 106, 10.21, 61, 0, 5},
       {1137, 119, 9.56, 57, 0, 2}}}},
}};

}  // namespace hydrotin::thesis
