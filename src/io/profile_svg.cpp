#include "hydrotin/profile_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "hydrotin/error.h"
#include "hydrotin/finished_file.h"

namespace hydrotin {
namespace {

constexpr double kWidth = 960, kHeight = 420, kLeft = 70, kRight = 20, kTop = 40, kBottom = 50;

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

/// 1, 2 or 5 times a power of ten, so that about six of them make the range.
double tick_of(double range) {
  const double power = std::pow(10, std::floor(std::log10(std::max(range, 1e-9) / 6)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (range / (power * factor) <= 8) return power * factor;
  return power * 10;
}

class Profile {
 public:
  Profile(std::span<const double> along, std::span<const double> before, std::span<const double> after)
      : along_(along), before_(before), after_(after), low_(before[0]), high_(before[0]) {
    for (std::size_t i = 0; i < along.size(); ++i)
      for (const double h : {before[i], after[i]}) {
        low_ = std::min(low_, h);
        high_ = std::max(high_, h);
      }
    const double room = std::max(high_ - low_, 1.0) * 0.05;
    low_ -= room;
    high_ += room;
  }

  [[nodiscard]] std::string svg(const std::string& name) const {
    std::string out = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
        "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
        kWidth, kHeight);
    out += fmt::format("<text x=\"{}\" y=\"22\" font-size=\"15\">{}</text>\n", kLeft, escaped(name));
    add_grid(out);
    add_line(out, before_, "#c0392b");
    add_line(out, after_, "#1f5fa8");
    out += fmt::format(
        "<text x=\"{0}\" y=\"22\" text-anchor=\"end\"><tspan fill=\"#c0392b\">before</tspan> "
        "<tspan fill=\"#1f5fa8\">after</tspan></text>\n</svg>\n",
        kWidth - kRight);
    return out;
  }

 private:
  [[nodiscard]] double x(double way) const {
    return kLeft + (kWidth - kLeft - kRight) * way / std::max(along_.back(), 1e-9);
  }
  [[nodiscard]] double y(double h) const { return kTop + (kHeight - kTop - kBottom) * (high_ - h) / (high_ - low_); }

  void add_grid(std::string& out) const {
    const double step = tick_of(high_ - low_), way_step = tick_of(along_.back());
    for (double h = std::ceil(low_ / step) * step; h <= high_; h += step)
      out += fmt::format(
          "<line x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"#ddd\"/><text x=\"{3}\" y=\"{4:.1f}\" "
          "text-anchor=\"end\">{5:g}</text>\n",
          kLeft, kWidth - kRight, y(h), kLeft - 6, y(h) + 4, std::abs(h) < step / 2 ? 0.0 : h);
    for (double way = 0; way <= along_.back(); way += way_step)
      out += fmt::format(
          "<line y1=\"{0}\" y2=\"{1}\" x1=\"{2:.1f}\" x2=\"{2:.1f}\" stroke=\"#eee\"/><text x=\"{2:.1f}\" y=\"{3}\" "
          "text-anchor=\"middle\">{4:g}</text>\n",
          kTop, kHeight - kBottom, x(way), kHeight - kBottom + 18, way);
    out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">way from the source</text>\n",
                       (kLeft + kWidth - kRight) / 2, kHeight - 10);
  }

  void add_line(std::string& out, std::span<const double> heights, const char* colour) const {
    out += fmt::format("<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"1.3\" points=\"", colour);
    for (std::size_t i = 0; i < heights.size(); ++i) out += fmt::format("{:.2f},{:.2f} ", x(along_[i]), y(heights[i]));
    out += "\"/>\n";
  }

  std::span<const double> along_, before_, after_;
  double low_ = 0, high_ = 0;
};

}  // namespace

std::string profile_file_name(std::size_t number, const std::string& name) {
  std::string plain;
  for (const char c : name) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (is_plain)
      plain += c;
    else if (!plain.empty() && plain.back() != '-')
      plain += '-';
  }
  while (!plain.empty() && plain.back() == '-') plain.pop_back();
  return fmt::format("{:02}-{}.svg", number + 1, plain.empty() ? "river" : plain.substr(0, 60));
}

void write_profile_svg(const std::filesystem::path& path, const std::string& name, std::span<const double> along,
                       std::span<const double> before, std::span<const double> after) {
  FinishedFile file(path);
  std::ofstream stream(file.temporary(), std::ios::binary);
  stream << Profile(along, before, after).svg(name);
  stream.close();
  if (!stream) throw Error(ErrorKind::storage, path.string() + ": cannot be written (check the disk's free space)");
  file.publish();
}

}  // namespace hydrotin
