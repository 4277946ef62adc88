#pragma once

#include <stdexcept>
#include <string>

/// The one exception of the project.
///
/// Thrown only by code that touches the outside world (files, configs, memory budgets), caught once, in `main`. What an
/// algorithm may legitimately answer is a value, and what a caller got wrong is an assertion.

namespace hydrotin {

/// Who must act; its value is the exit code of the program.
enum class ErrorKind : int {
  config = 2,    ///< usage or config
  input = 3,     ///< a file we were given
  storage = 4,   ///< a file we write or wrote
  resource = 5,  ///< memory, disk or time
  check = 6,     ///< a finished data set failed verification
};

/// One clear sentence: file, place, cause, remedy.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& text) : std::runtime_error(text), kind_(kind) {}
  [[nodiscard]] ErrorKind kind() const noexcept { return kind_; }

 private:
  ErrorKind kind_;
};

}  // namespace hydrotin
