#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

/// How the independent parts of a computation are carried out: one after the other, or several at a time. Algorithms
/// cut their work into parts by its size alone, so that their results are the same for every executor.

namespace hydrotin {

/// Calls work(i) for every i in [0, count), in any order and perhaps concurrently; returns when all calls have.
using Executor = std::function<void(std::uint32_t count, const std::function<void(std::uint32_t)>& work)>;

inline void serially(std::uint32_t count, const std::function<void(std::uint32_t)>& work) {
  for (std::uint32_t i = 0; i < count; ++i) work(i);
}

/// Calls work(begin, end) for consecutive ranges that make up [0, size), all but the last of `length` each.
template <class Work>
void for_ranges(const Executor& executor, std::uint32_t size, std::uint32_t length, const Work& work) {
  const std::uint32_t count = size / length + (size % length != 0);
  executor(count, [&](std::uint32_t i) {
    const std::uint32_t begin = i * length;
    work(begin, begin + std::min(length, size - begin));
  });
}

/// Things that are expensive to make and used by one thread at a time: as many as threads ask for at once.
template <class Thing>
class Pool {
 public:
  using Make = std::function<std::unique_ptr<Thing>()>;
  explicit Pool(Make make) : make_(std::move(make)) {}

  /// Lends one for as long as the loan lives.
  class Loan {
   public:
    Loan(Pool& pool, std::unique_ptr<Thing> thing) : pool_(pool), thing_(std::move(thing)) {}
    ~Loan() { pool_.put_back(std::move(thing_)); }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    Thing& operator*() const { return *thing_; }
    Thing* operator->() const { return thing_.get(); }

   private:
    Pool& pool_;
    std::unique_ptr<Thing> thing_;
  };

  [[nodiscard]] Loan lend() {
    {
      const std::scoped_lock lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<Thing> thing = std::move(idle_.back());
        idle_.pop_back();
        return {*this, std::move(thing)};
      }
    }
    return {*this, make_()};
  }

 private:
  void put_back(std::unique_ptr<Thing> thing) {
    const std::scoped_lock lock(mutex_);
    idle_.push_back(std::move(thing));
  }

  Make make_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Thing>> idle_;
};

}  // namespace hydrotin
