#include "hydrotin/pit_layers.h"

#include <cstdio>

#include "hydrotin/lifting.h"

namespace hydrotin {
namespace {

struct PitColumn {
  const char* name;
  FieldType type;
};
constexpr PitColumn kPitColumns[] = {
    {"id", FieldType::integer},       {"parent", FieldType::integer},  {"z_before", FieldType::real},
    {"z_level", FieldType::real},     {"depth", FieldType::real},      {"spill_x", FieldType::real},
    {"spill_y", FieldType::real},     {"area", FieldType::real},       {"volume", FieldType::real},
    {"vertices", FieldType::integer}, {"plateau", FieldType::integer}, {"displacement", FieldType::real},
    {"kept", FieldType::integer}};

// Values of the columns. Lengths in units of the CRS; parent -1: it overflows for good.
void pit_values(const Lattice& l, std::span<const PitBasin> pits, std::span<const std::uint8_t> is_kept, std::size_t i,
                std::vector<FieldValue>& values) {
  const PitBasin& b = pits[i];
  const double area = l.scale_xy * l.scale_xy;
  values = {static_cast<std::int64_t>(i),
            b.parent == kNoPit ? std::int64_t{-1} : std::int64_t{b.parent},
            l.z(b.pit.height),
            l.z(b.spill_level),
            static_cast<double>(b.depth()) * l.scale_z,
            l.x(b.spill_position.x),
            l.y(b.spill_position.y),
            static_cast<double>(b.doubled_area) / 2 * area,
            b.volume * area * l.scale_z,
            static_cast<std::int64_t>(b.num_vertices),
            static_cast<std::int64_t>(b.pit.num_vertices),
            static_cast<double>(b.displacement) * l.scale_z,
            std::int64_t{is_kept[i]}};
}

std::vector<VectorField> lifted_fields() {
  return {{"level", FieldType::real},       {"lowest", FieldType::real},       {"max_depth", FieldType::real},
          {"vertices", FieldType::integer}, {"displacement", FieldType::real}, {"volume", FieldType::real}};
}

std::vector<VectorField> breach_fields() {
  return {{"pit_height", FieldType::real}, {"length", FieldType::real},       {"max_depth", FieldType::real},
          {"cost", FieldType::real},       {"displacement", FieldType::real}, {"volume", FieldType::real},
          {"lowered", FieldType::integer}, {"from_pit", FieldType::integer}};
}

}  // namespace

void write_pit_layer(const Lattice& lattice, std::span<const PitBasin> pits, std::span<const std::uint8_t> is_kept,
                     GeoPackageWriter& out) {
  std::vector<VectorField> fields;
  for (const PitColumn& column : kPitColumns) fields.push_back({column.name, column.type});
  const int layer = out.add_layer("pits", VectorGeometry::point, true, fields);
  std::vector<FieldValue> values;
  for (std::size_t i = 0; i < pits.size(); ++i) {
    pit_values(lattice, pits, is_kept, i, values);
    const Pit& pit = pits[i].pit;
    out.add_point(layer, {lattice.x(pit.representative.x), lattice.y(pit.representative.y), lattice.z(pit.height)},
                  values);
  }
}

std::string pits_csv(const Lattice& lattice, std::span<const PitBasin> pits, std::span<const std::uint8_t> is_kept) {
  std::string text = "x,y";
  for (const PitColumn& column : kPitColumns) text += std::string(",") + column.name;
  text += '\n';
  std::vector<FieldValue> values;
  char cell[48];
  const auto put = [&](const char* format, auto value) {
    std::snprintf(cell, sizeof cell, format, value);
    text += cell;
  };
  for (std::size_t i = 0; i < pits.size(); ++i) {
    const LatticePoint at = pits[i].pit.representative;
    put("%.10g", lattice.x(at.x));
    put(",%.10g", lattice.y(at.y));
    pit_values(lattice, pits, is_kept, i, values);
    for (const FieldValue& value : values) {
      if (const auto* integer = std::get_if<std::int64_t>(&value))
        put(",%lld", static_cast<long long>(*integer));
      else
        put(",%.10g", std::get<double>(value));
    }
    text += '\n';
  }
  return text;
}

LiftedLayer::LiftedLayer(const Lattice& lattice, GeoPackageWriter& out)
    : lattice_(lattice), out_(&out), layer_(out.add_layer("lifted", VectorGeometry::polygon, false, lifted_fields())) {}

void LiftedLayer::begin(const Region& region) {
  region_ = region;
  rings_.clear();
}

void LiftedLayer::add_ring(std::span<const std::int32_t> xy) {
  auto& ring = rings_.emplace_back();
  for (std::size_t p = 0; p < xy.size(); p += 2) ring.push_back({lattice_.x(xy[p]), lattice_.y(xy[p + 1]), 0});
}

void LiftedLayer::end() {
  const Lattice& l = lattice_;
  const Region& r = region_;
  const std::vector<FieldValue> values{l.z(r.level),
                                       l.z(r.lowest),
                                       (static_cast<double>(r.level) - r.lowest) * l.scale_z,
                                       static_cast<std::int64_t>(r.vertices),
                                       static_cast<double>(r.displacement) * l.scale_z,
                                       r.volume * (l.scale_xy * l.scale_xy) * l.scale_z};
  out_->add_polygon(layer_, rings_, values);
}

BreachLayer::BreachLayer(const Lattice& lattice, ChangeMeasure measure, GeoPackageWriter& out)
    : lattice_(lattice),
      measure_(measure),
      out_(&out),
      layer_(out.add_layer("breaches", VectorGeometry::line, true, breach_fields())) {}

void BreachLayer::add(const Line& breach, std::span<const std::int32_t> xyz) {
  const Lattice& l = lattice_;
  line_.clear();
  for (std::size_t p = 0; p < xyz.size(); p += 3) line_.push_back({l.x(xyz[p]), l.y(xyz[p + 1]), l.z(xyz[p + 2])});
  const bool from_pit = breach.pit_height != kNoLevel;
  const double displacement = static_cast<double>(breach.displacement) * l.scale_z, depth = breach.depth * l.scale_z;
  const double volume = breach.volume * l.scale_xy * l.scale_xy * l.scale_z;
  const double cost = measure_ == ChangeMeasure::total   ? displacement
                      : measure_ == ChangeMeasure::max   ? depth
                      : measure_ == ChangeMeasure::count ? static_cast<double>(breach.lowered)
                                                         : volume;
  const std::vector<FieldValue> values{from_pit ? l.z(breach.pit_height) : line_.front().z,
                                       breach.length * l.scale_xy,
                                       depth,
                                       cost,
                                       displacement,
                                       volume,
                                       static_cast<std::int64_t>(breach.lowered),
                                       std::int64_t{from_pit}};
  out_->add_line(layer_, line_, values);
}

std::string name_of(ChangeMeasure measure) {
  constexpr const char* kNames[] = {"total", "max", "count", "volume"};
  return kNames[static_cast<std::size_t>(measure)];
}

double unit_of(ChangeMeasure measure, const Lattice& l) {
  switch (measure) {
    case ChangeMeasure::total:
    case ChangeMeasure::max:
      return l.scale_z;
    case ChangeMeasure::count:
      return 1;
    case ChangeMeasure::volume:
      return l.scale_xy * l.scale_xy * l.scale_z / 6;
  }
  return 1;
}

}  // namespace hydrotin
