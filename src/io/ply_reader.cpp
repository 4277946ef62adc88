#include "ply_reader.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "hydrotin/error.h"
#include "text_scan.h"

namespace hydrotin {
namespace {

enum class Scalar : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class Format : std::uint8_t { ascii, little, big };

struct Property {
  std::string name;
  Scalar type = Scalar::float64;
  bool is_list = false;
  Scalar count_type = Scalar::uint8;
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Format format = Format::ascii;
  std::vector<Element> elements;
  MeshVertex offset{0, 0, 0};
  std::size_t num_lines = 0, num_bytes = 0;
};

std::size_t size_of(Scalar type) {
  static constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

bool is_integer(Scalar type) {
  return type != Scalar::float32 && type != Scalar::float64;
}

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& place, const std::string& what) {
  throw Error(ErrorKind::input, path.string() + ":" + place + ": " + what);
}

Scalar scalar_of(const std::filesystem::path& path, std::size_t line, std::string_view name) {
  static constexpr std::pair<std::string_view, Scalar> kNames[] = {
      {"char", Scalar::int8},      {"int8", Scalar::int8},       {"uchar", Scalar::uint8},
      {"uint8", Scalar::uint8},    {"short", Scalar::int16},     {"int16", Scalar::int16},
      {"ushort", Scalar::uint16},  {"uint16", Scalar::uint16},   {"int", Scalar::int32},
      {"int32", Scalar::int32},    {"uint", Scalar::uint32},     {"uint32", Scalar::uint32},
      {"float", Scalar::float32},  {"float32", Scalar::float32}, {"double", Scalar::float64},
      {"float64", Scalar::float64}};
  for (const auto& [text, type] : kNames)
    if (text == name) return type;
  fail(path, std::to_string(line), in_quotes(name) + " is no type of PLY");
}

void read_property(const std::filesystem::path& path, std::size_t line, std::string_view rest, Header& header) {
  if (header.elements.empty()) fail(path, std::to_string(line), "a property before the first element");
  Property property;
  std::string_view type = next_word(rest);
  if (type == "list") {
    property.is_list = true;
    property.count_type = scalar_of(path, line, next_word(rest));
    if (!is_integer(property.count_type)) fail(path, std::to_string(line), "the length of a list must be an integer");
    type = next_word(rest);
  }
  property.type = scalar_of(path, line, type);
  property.name = next_word(rest);
  if (property.name.empty()) fail(path, std::to_string(line), "a property without a name");
  header.elements.back().properties.push_back(std::move(property));
}

Format format_of(const std::filesystem::path& path, std::size_t line, std::string_view rest) {
  const std::string_view name = next_word(rest);
  if (next_word(rest) != "1.0") fail(path, std::to_string(line), "only version 1.0 of PLY is known");
  if (name == "ascii") return Format::ascii;
  if (name == "binary_little_endian") return Format::little;
  if (name == "binary_big_endian") return Format::big;
  fail(path, std::to_string(line), in_quotes(name) + " is no format of PLY");
}

void read_offset(std::string_view rest, Header& header) {
  if (next_word(rest) != "offset") return;
  MeshVertex offset;
  for (double& part : offset) {
    const auto value = parse_real(next_word(rest));
    if (!value) return;  // some other program's comment
    part = *value;
  }
  header.offset = offset;
}

Header read_header(const std::filesystem::path& path, std::string_view content) {
  Header header;
  bool has_format = false;
  LineScanner lines(content);
  for (;;) {
    const auto full = lines.next();
    const std::size_t line = lines.line_number();
    if (!full) fail(path, std::to_string(line), "the file ends within its header");
    std::string_view rest = *full;
    const std::string_view keyword = next_word(rest);
    if (line == 1 || keyword == "obj_info" || keyword.empty()) continue;
    if (keyword == "end_header") break;
    if (keyword == "comment") {
      read_offset(rest, header);
    } else if (keyword == "format") {
      header.format = format_of(path, line, rest);
      has_format = true;
    } else if (keyword == "element") {
      Element element{std::string(next_word(rest)), 0, {}};
      const auto count = parse_integer(next_word(rest));
      if (element.name.empty() || !count || *count < 0)
        fail(path, std::to_string(line), "an element needs a name and a count");
      element.count = static_cast<std::size_t>(*count);
      header.elements.push_back(std::move(element));
    } else if (keyword == "property") {
      read_property(path, line, rest, header);
    } else {
      fail(path, std::to_string(line), in_quotes(keyword) + " is no keyword of a PLY header");
    }
  }
  if (!has_format) fail(path, "1", "the header names no format");
  header.num_lines = lines.line_number();
  header.num_bytes = content.size() - lines.rest().size();
  return header;
}

/// The body of the file as a stream of numbers.
class Body {
 public:
  Body(const std::filesystem::path& path, std::string_view rest, const Header& header)
      : path_(path),
        rest_(rest),
        format_(header.format),
        line_(header.num_lines + 1),
        size_(rest.size()),
        header_(header.num_bytes) {}

  double next(Scalar type) { return format_ == Format::ascii ? next_text(type) : next_binary(type); }

  /// Bytes left: no list or element may claim more than these can hold.
  [[nodiscard]] std::size_t bytes_left() const { return rest_.size(); }
  [[nodiscard]] std::size_t least_bytes(Scalar type) const { return format_ == Format::ascii ? 1 : size_of(type); }
  [[nodiscard]] std::string place() const {
    return format_ == Format::ascii ? std::to_string(line_) : "byte " + std::to_string(header_ + size_ - rest_.size());
  }
  [[noreturn]] void fail_here(const std::string& what) const { fail(path_, place(), what); }

 private:
  double next_text(Scalar type) {
    for (;;) {
      const std::size_t begin = rest_.find_first_not_of(" \t\r");
      if (begin == std::string_view::npos) fail_here("the file ends early: fewer numbers than its header announces");
      rest_.remove_prefix(begin);
      if (rest_.front() != '\n') break;
      rest_.remove_prefix(1);
      ++line_;
    }
    const std::string_view word = rest_.substr(0, rest_.find_first_of(" \t\r\n"));
    const auto value = parse_real(word);
    if (!value) fail_here(in_quotes(word) + " is not a finite number");
    if (is_integer(type) && *value != std::floor(*value)) fail_here(in_quotes(word) + " is not an integer");
    rest_.remove_prefix(word.size());
    return *value;
  }

  template <class T>
  double take() {
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, rest_.data(), sizeof bytes);
    if ((format_ == Format::big) == (std::endian::native == std::endian::little))
      std::reverse(bytes, bytes + sizeof bytes);
    T value;
    std::memcpy(&value, bytes, sizeof value);
    if (!std::isfinite(static_cast<double>(value))) fail_here("a number that is not finite");
    rest_.remove_prefix(sizeof bytes);
    return static_cast<double>(value);
  }

  double next_binary(Scalar type) {
    if (rest_.size() < size_of(type)) fail_here("the file ends early: fewer bytes than its header announces");
    switch (type) {
      case Scalar::int8:
        return take<std::int8_t>();
      case Scalar::uint8:
        return take<std::uint8_t>();
      case Scalar::int16:
        return take<std::int16_t>();
      case Scalar::uint16:
        return take<std::uint16_t>();
      case Scalar::int32:
        return take<std::int32_t>();
      case Scalar::uint32:
        return take<std::uint32_t>();
      case Scalar::float32:
        return take<float>();
      case Scalar::float64:
        break;
    }
    return take<double>();
  }

  const std::filesystem::path& path_;
  std::string_view rest_;
  Format format_;
  std::size_t line_, size_, header_;
};

/// Checks that the element can be in the file at all, before anything is allocated for it.
void require_room(const Body& body, const Element& element) {
  std::size_t bytes = 0;
  for (const auto& property : element.properties)
    bytes += body.least_bytes(property.is_list ? property.count_type : property.type);
  if (element.properties.empty() && element.count > 0)
    body.fail_here("the element " + element.name + " has no property");
  if (bytes > 0 && element.count > body.bytes_left() / bytes)
    body.fail_here("the header announces " + std::to_string(element.count) + " of " + in_quotes(element.name) +
                   ", more than the file holds");
}

std::size_t list_length(Body& body, const Property& property) {
  const double length = body.next(property.count_type);
  if (length < 0 ||
      length * static_cast<double>(body.least_bytes(property.type)) > static_cast<double>(body.bytes_left()))
    body.fail_here("a list longer than the file");
  return static_cast<std::size_t>(length);
}

void pass_over(Body& body, const Property& property) {
  const std::size_t count = property.is_list ? list_length(body, property) : 1;
  for (std::size_t i = 0; i < count; ++i) body.next(property.type);
}

void read_vertices(Body& body, const Element& element, const MeshVertex& offset, Mesh& mesh) {
  std::array<std::size_t, 3> where{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto found = std::find_if(element.properties.begin(), element.properties.end(), [&](const Property& p) {
      return !p.is_list && p.name.size() == 1 && p.name[0] == "xyz"[axis];
    });
    if (found == element.properties.end()) body.fail_here(std::string("vertices have no property ") + "xyz"[axis]);
    where[axis] = static_cast<std::size_t>(found - element.properties.begin());
  }
  if (element.count >= UINT32_MAX) body.fail_here("more vertices than 32-bit indices reach");
  mesh.vertex.reserve(element.count);
  for (std::size_t i = 0; i < element.count; ++i) {
    MeshVertex vertex{};
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const auto axis = static_cast<std::size_t>(std::find(where.begin(), where.end(), p) - where.begin());
      if (axis < 3) {
        vertex[axis] = body.next(element.properties[p].type) + offset[axis];
      } else {
        pass_over(body, element.properties[p]);
      }
    }
    mesh.vertex.push_back(vertex);
  }
}

void read_corners(Body& body, const Property& property, std::size_t num_vertices, Mesh& mesh) {
  if (const std::size_t corners = list_length(body, property); corners != 3)
    body.fail_here("a face with " + std::to_string(corners) + " corners (triangulate the mesh first)");
  MeshTriangle triangle;
  for (std::uint32_t& corner : triangle) {
    const double index = body.next(property.type);
    if (index < 0 || index >= static_cast<double>(num_vertices))
      body.fail_here("vertex " + std::to_string(static_cast<long long>(index)) + " does not exist: there are " +
                     std::to_string(num_vertices));
    corner = static_cast<std::uint32_t>(index);
  }
  if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0])
    body.fail_here("a face names a vertex twice");
  mesh.triangle.push_back(triangle);
}

void read_faces(Body& body, const Element& element, std::size_t num_vertices, Mesh& mesh) {
  const auto corners = std::find_if(element.properties.begin(), element.properties.end(), [](const Property& p) {
    return p.is_list && is_integer(p.type) && (p.name == "vertex_indices" || p.name == "vertex_index");
  });
  if (corners == element.properties.end()) body.fail_here("faces have no list of integers vertex_indices");
  mesh.triangle.reserve(element.count);
  for (std::size_t i = 0; i < element.count; ++i)
    for (const auto& property : element.properties) {
      if (&property == &*corners) {
        read_corners(body, property, num_vertices, mesh);
      } else {
        pass_over(body, property);
      }
    }
}

}  // namespace

Mesh read_ply(const std::filesystem::path& path, std::string_view content) {
  const Header header = read_header(path, content);
  const auto vertices = std::find_if(header.elements.begin(), header.elements.end(),
                                     [](const Element& element) { return element.name == "vertex"; });
  const std::size_t num_vertices = vertices == header.elements.end() ? 0 : vertices->count;
  Mesh mesh;
  Body body(path, content.substr(header.num_bytes), header);
  for (const Element& element : header.elements) {
    require_room(body, element);
    if (element.name == "vertex" && mesh.vertex.empty()) {
      read_vertices(body, element, header.offset, mesh);
    } else if (element.name == "face" && mesh.triangle.empty()) {
      read_faces(body, element, num_vertices, mesh);
    } else {
      for (std::size_t i = 0; i < element.count; ++i)
        for (const auto& property : element.properties) pass_over(body, property);
    }
  }
  return mesh;
}

}  // namespace hydrotin
