#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

/// Problems found while checking: sentences, at most twenty of a kind, the others counted.

namespace hydrotin {

class Problems {
 public:
  static constexpr std::uint64_t kMostOfAKind = 20;

  void add(const std::string& kind, std::string text) {
    if (++count_[kind] <= kMostOfAKind) listed_.emplace_back(kind, std::move(text));
  }
  void add(const Problems& other) {
    std::map<std::string, std::uint64_t> unlisted = other.count_;
    for (const auto& [kind, text] : other.listed_) {
      add(kind, text);
      --unlisted[kind];
    }
    for (const auto& [kind, count] : unlisted)
      if (count > 0) count_[kind] += count;
  }
  [[nodiscard]] bool empty() const { return count_.empty(); }
  [[nodiscard]] std::uint64_t count(const std::string& kind) const {
    const auto found = count_.find(kind);
    return found == count_.end() ? 0 : found->second;
  }
  /// In the order found; then a sentence for each kind of which some are not listed.
  [[nodiscard]] std::vector<std::string> sentences() const {
    std::vector<std::string> out;
    std::map<std::string, std::uint64_t> unlisted = count_;
    for (const auto& [kind, text] : listed_) {
      out.push_back(text);
      --unlisted[kind];
    }
    for (const auto& [kind, count] : unlisted)
      if (count > 0) out.push_back("and " + std::to_string(count) + " more problems of the kind: " + kind);
    return out;
  }

 private:
  std::map<std::string, std::uint64_t> count_;  // zero counts are never kept
  std::vector<std::pair<std::string, std::string>> listed_;
};

}  // namespace hydrotin
